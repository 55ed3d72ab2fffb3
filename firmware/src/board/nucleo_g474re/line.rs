//! The serial line: LPUART1, both ways by DMA, so that no byte waits for the core. However long the tick keeps
//! everything else waiting, what comes meanwhile is written to memory; a byte an interrupt, eight of them in the UART's
//! own FIFO, would be lost after 87 µs.
//!
//! The receiver's channel goes round in a ring and is never stopped. embassy-stm32's own receiver of this kind
//! (`RingBufferedUartRx`) stops its channel at every error of the line and goes on with what the channel has left,
//! which the hardware does not promise to do (RM0440, "Channel state and disabling a channel": suspend and resume). So
//! the ring is the driver's, and the UART's flags are this module's: a byte that came with an error is a byte like
//! others, which its frame's checksum refuses, and is counted.

use core::future::poll_fn;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use core::task::Poll;

use embassy_stm32::dma::{Channel, ReadableRingBuffer};
use embassy_stm32::interrupt::typelevel::{Handler, LPUART1 as Interrupt};
use embassy_stm32::mode::Async;
use embassy_stm32::pac;
use embassy_stm32::peripherals::{DMA1_CH1, DMA1_CH3, LPUART1};
use embassy_stm32::usart::{Config, RxDma, Uart, UartRx, UartTx};
use embassy_stm32::{Peri, bind_interrupts, dma, peripherals, usart};
use embassy_sync::waitqueue::AtomicWaker;
use embedded_io_async::{Error, ErrorKind, ErrorType, Read};
use protocol::BAUD;
use static_cell::ConstStaticCell;

bind_interrupts!(struct Irqs {
    DMA1_CHANNEL1 => dma::InterruptHandler<DMA1_CH1>;
    DMA1_CHANNEL3 => dma::InterruptHandler<DMA1_CH3>;
    LPUART1 => Pause, usart::InterruptHandler<LPUART1>;
});

/// Bytes that may wait to be read: what comes in 89 ms at the full rate, longer than any request keeps the link from
/// reading. The longest erases two pages, up to 25 ms each.
const WAITING: usize = 8192;

/// How often an error of the line was found: overrun, framing or noise.
static ERRORS: AtomicU32 = AtomicU32::new(0);
/// Who waits for bytes that no half of the ring is full of.
static PAUSED: AtomicWaker = AtomicWaker::new();

/// How many errors the line has had.
pub fn errors() -> u32 {
    ERRORS.load(Relaxed)
}

/// The sender pauses. What else the UART interrupts for, that all has been sent, is the driver's, whose
/// handler comes next.
pub struct Pause;

impl Handler<Interrupt> for Pause {
    unsafe fn on_interrupt() {
        if pac::LPUART1.isr().read().idle() {
            pac::LPUART1.icr().write(|w| w.set_idle(true));
            PAUSED.wake();
        }
    }
}

/// Counts and clears what is flagged. No error interrupts: the driver's handler would stop the receiver's channel.
fn count_errors() {
    let state = pac::LPUART1.isr().read();
    if state.ore() || state.fe() || state.ne() {
        ERRORS.store(ERRORS.load(Relaxed).wrapping_add(1), Relaxed);
        pac::LPUART1.icr().write(|w| {
            w.set_ore(state.ore());
            w.set_fe(state.fe());
            w.set_ne(state.ne());
        });
    }
}

/// The receiving end.
pub struct Receiver {
    ring: ReadableRingBuffer<'static, u8>,
    /// Dropped, it would switch the UART off with the transmitter.
    _uart: UartRx<'static, Async>,
}

/// More came than may wait: what waited is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lapped;

impl core::fmt::Display for Lapped {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "more than {WAITING} bytes came before they were read")
    }
}

impl core::error::Error for Lapped {}

impl Error for Lapped {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl ErrorType for Receiver {
    type Error = Lapped;
}

impl Read for Receiver {
    /// Waits until half of the ring is full, or the sender pauses; what has come by then, or at the call.
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Lapped> {
        poll_fn(|context| {
            self.ring.set_waker(context.waker());
            PAUSED.register(context.waker());
            // The driver's handler, which comes after `Pause`, takes a pause that begins between the two for its own,
            // and ends this interrupt.
            critical_section::with(|_| pac::LPUART1.cr1().modify(|w| w.set_idleie(true)));
            count_errors();
            match self.ring.read(buffer) {
                Ok((0, _)) if !buffer.is_empty() => Poll::Pending,
                Ok((length, _)) => Poll::Ready(Ok(length)),
                // The ring has begun anew with what comes next, and its channel has gone on.
                Err(_) => Poll::Ready(Err(Lapped)),
            }
        })
        .await
    }
}

/// Sets the line up, both ends; bytes are received from now on.
pub fn start(
    uart: Peri<'static, LPUART1>,
    rx: Peri<'static, peripherals::PA3>,
    tx: Peri<'static, peripherals::PA2>,
    sends: Peri<'static, DMA1_CH3>,
    receives: Peri<'static, DMA1_CH1>,
) -> (UartTx<'static, Async>, Receiver) {
    static RING: ConstStaticCell<[u8; WAITING]> = ConstStaticCell::new([0; WAITING]);
    let request = RxDma::<LPUART1>::request(&*receives);
    // SAFETY: the driver is given the channel, too, and never reads by it: its receiver is only kept.
    let ours = unsafe { receives.clone_unchecked() };
    let mut config = Config::default();
    config.baudrate = BAUD;
    // Cannot fail: the rate is a constant that LPUART1 reaches from 170 MHz.
    let uart = Uart::new(uart, rx, tx, sends, receives, Irqs, config).expect("LPUART1 reaches the rate");
    let (transmitter, receiver) = uart.split();
    let data = pac::LPUART1.rdr().as_ptr().cast::<u8>();
    // SAFETY: the data register is a byte wide without parity, and nobody else has the ring.
    let mut ring =
        unsafe { ReadableRingBuffer::new(Channel::new(ours, Irqs), request, data, RING.take(), Default::default()) };
    ring.start();
    pac::LPUART1.cr3().modify(|w| w.set_dmar(true));
    (transmitter, Receiver { ring, _uart: receiver })
}
