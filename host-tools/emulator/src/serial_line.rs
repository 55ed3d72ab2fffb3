//! A socket as the device's serial line: one host at a time, and bytes that nobody takes are lost.

use async_io::Async;
use embedded_io_async::{ErrorType, Read, Write};
use std::cell::RefCell;
use std::convert::Infallible;
use std::io::{Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::rc::Rc;
use std::time::Duration;

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
            Err(_) => {
                async_io::Timer::after(PAUSE).await;
            }
        }
    }
}

/// What comes from the host.
pub struct Receiver<'l>(pub &'l SerialLine);

impl ErrorType for Receiver<'_> {
    type Error = Infallible;
}

impl Read for Receiver<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, Infallible> {
        loop {
            let Some(host) = self.0.host() else {
                self.0.wait_for_host().await;
                continue;
            };
            match host.read_with(|mut stream| stream.read(buffer)).await {
                Ok(0) | Err(_) => self.0.hang_up(),
                Ok(length) => return Ok(length),
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
