//! CMSDK UART 0. Reception by interrupt into a pipe; transmission by polling, giving way between bytes.

use super::registers::{read, write};
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use embassy_futures::yield_now;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;
use embedded_io_async::{Error, ErrorKind, ErrorType, Read, Write};

const UART0: usize = 0x4000_4000;
/// Offsets of the registers from the base.
const DATA: usize = 0x0;
const STATE: usize = 0x4;
const CTRL: usize = 0x8;
const INTCLEAR: usize = 0xC;
const BAUDDIV: usize = 0x10;
/// Bits of STATE.
const TRANSMIT_FULL: u32 = 1;
const RECEIVE_FULL: u32 = 1 << 1;
/// Bits of CTRL: transmitter, receiver, and the receiver's interrupt; of INTCLEAR: the latter.
const BOTH_WAYS: u32 = 0b11;
const RECEIVE_INTERRUPT: u32 = 1 << 3;
const RECEIVED: u32 = 1 << 1;

static PIPE: Pipe<CriticalSectionRawMutex, 1024> = Pipe::new();
static OVERRUN: AtomicBool = AtomicBool::new(false);

/// The line cannot be faster than a sixteenth of the clock; QEMU does not mind.
pub fn start() {
    write(UART0 + BAUDDIV, 27);
    write(UART0 + CTRL, BOTH_WAYS | RECEIVE_INTERRUPT);
}

/// The receiver's interrupt.
pub fn received() {
    write(UART0 + INTCLEAR, RECEIVED);
    while read(UART0 + STATE) & RECEIVE_FULL != 0 {
        let byte = read(UART0 + DATA) as u8;
        if PIPE.try_write(&[byte]).is_err() {
            OVERRUN.store(true, Relaxed);
        }
    }
}

/// Bytes were lost: nobody read them in time.
#[derive(Clone, Copy, Debug)]
pub struct Overrun;

impl core::fmt::Display for Overrun {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("overrun")
    }
}

impl core::error::Error for Overrun {}

impl Error for Overrun {
    fn kind(&self) -> ErrorKind {
        ErrorKind::OutOfMemory
    }
}

/// The half that takes bytes from the host.
pub struct Receiver;

impl ErrorType for Receiver {
    type Error = Overrun;
}

impl Read for Receiver {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Overrun> {
        if OVERRUN.swap(false, Relaxed) {
            return Err(Overrun);
        }
        Ok(PIPE.read(buffer).await)
    }
}

/// The half that hands bytes to the host.
pub struct Transmitter;

impl ErrorType for Transmitter {
    type Error = Overrun;
}

impl Write for Transmitter {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Overrun> {
        for &byte in bytes {
            while read(UART0 + STATE) & TRANSMIT_FULL != 0 {
                yield_now().await;
            }
            write(UART0 + DATA, byte.into());
        }
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Overrun> {
        Ok(())
    }
}
