//! A socket as the device's serial line: one host at a time, and bytes that nobody takes are lost.

use async_io::Async;
use embassy_time::{Duration, Instant, Timer};
use embedded_io_async::{ErrorType, Read, Write};
use protocol::BAUD;
use std::cell::RefCell;
use std::convert::Infallible;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::rc::Rc;

/// Pause before the next host is waited for, where the operating system had none to give.
const PAUSE: Duration = Duration::from_millis(10);

/// The line, on which a host may be.
pub struct SerialLine {
    listener: Async<TcpListener>,
    host: RefCell<Option<Rc<Async<TcpStream>>>>,
}

impl SerialLine {
    /// A line on which nobody is yet.
    pub fn new(listener: Async<TcpListener>) -> Self {
        Self { listener, host: RefCell::new(None) }
    }

    /// The host on the line, if there is one.
    fn host(&self) -> Option<Rc<Async<TcpStream>>> {
        self.host.borrow().clone()
    }

    fn hang_up(&self) {
        self.host.replace(None);
    }

    async fn wait_for_host(&self) {
        match self.listener.accept().await {
            Ok((stream, _)) => {
                // Without it samples come in larger pieces; no more than that is lost.
                let _ = stream.get_ref().set_nodelay(true);
                self.host.replace(Some(Rc::new(stream)));
            }
            Err(_) => Timer::after(PAUSE).await,
        }
    }
}

/// What comes from the host, no faster than over the device's own line: the firmware relies on ticks
/// between two requests.
pub struct Receiver<'l> {
    line: &'l SerialLine,
    /// What a byte takes, µs.
    byte_us: f64,
    /// When the line has carried what was read.
    free: Instant,
}

impl<'l> Receiver<'l> {
    /// The line's end on a device for which `speed` seconds pass in a second.
    pub fn new(line: &'l SerialLine, speed: f64) -> Self {
        // Eight bits, a start and a stop bit.
        Self { line, byte_us: 10e6 / (f64::from(BAUD) * speed), free: Instant::now() }
    }
}

impl ErrorType for Receiver<'_> {
    type Error = Infallible;
}

impl Read for Receiver<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        Timer::at(self.free).await;
        loop {
            let Some(host) = self.line.host() else {
                self.line.wait_for_host().await;
                continue;
            };
            match host.read_with(|mut stream| stream.read(buffer)).await {
                Ok(0) | Err(_) => self.line.hang_up(),
                Ok(length) => {
                    self.free = Instant::now() + Duration::from_micros((self.byte_us * length as f64) as u64);
                    return Ok(length);
                }
            }
        }
    }
}

/// What goes to the host.
pub struct Transmitter<'l>(pub &'l SerialLine);

impl ErrorType for Transmitter<'_> {
    type Error = Infallible;
}

impl Write for Transmitter<'_> {
    /// Never waits: a serial line does not either.
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        let Some(host) = self.0.host() else { return Ok(bytes.len()) };
        match host.get_ref().write(bytes) {
            Ok(length) if length > 0 => Ok(length),
            // Full, or gone, which the receiver notices.
            _ => Ok(bytes.len()),
        }
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
