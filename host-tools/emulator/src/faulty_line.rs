//! A line between a host and a device on which frames are lost, damaged, changed or delayed, as a test wants it.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// How often it is looked whether the line is still wanted.
const LOOK: Duration = Duration::from_millis(5);

/// Which way a frame goes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Direction {
    /// From the host.
    ToDevice,
    /// From the device.
    ToHost,
}

/// What happens to a frame under way. The frame's bytes, its delimiter at the end, may be changed, shortened, emptied,
/// or added to; a fault that sleeps delays what goes either way.
pub trait Fault: FnMut(Direction, &mut Vec<u8>) + Send + 'static {}

impl<F: FnMut(Direction, &mut Vec<u8>) + Send + 'static> Fault for F {}

/// The line; dropped, it is cut.
pub struct FaultyLine {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl FaultyLine {
    /// A line to the device at an address.
    ///
    /// # Errors
    /// No socket can be opened for it.
    pub fn to(device: SocketAddr, mut fault: impl Fault) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let thread = std::thread::spawn(move || {
            while !stopped.load(Relaxed) {
                match listener.accept() {
                    // A host that leaves, or a device that does, ends the connection and not the line.
                    Ok((host, _)) => drop(connect(host, device, &mut fault, &stopped)),
                    Err(_) => std::thread::sleep(LOOK),
                }
            }
        });
        Ok(Self { address, stop, thread: Some(thread) })
    }

    /// Where a host finds the device's line.
    pub fn address(&self) -> SocketAddr {
        self.address
    }
}

impl Drop for FaultyLine {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
        // A panic there has been printed.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Carries frames both ways until one side leaves.
fn connect(host: TcpStream, device: SocketAddr, fault: &mut impl Fault, stop: &AtomicBool) -> io::Result<()> {
    let device = TcpStream::connect(device)?;
    for stream in [&host, &device] {
        stream.set_nonblocking(false)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(LOOK))?;
    }
    let fault = Mutex::new(fault);
    let carry = |from: &TcpStream, to: &TcpStream, direction| {
        let apply = |frame: &mut Vec<u8>| (*fault.lock().unwrap_or_else(PoisonError::into_inner))(direction, frame);
        let done = forward(from, to, apply, stop);
        // The other way ends too.
        let _ = from.shutdown(Shutdown::Both);
        let _ = to.shutdown(Shutdown::Both);
        done
    };
    std::thread::scope(|scope| {
        let outbound = scope.spawn(|| carry(&host, &device, Direction::ToDevice));
        let inbound = carry(&device, &host, Direction::ToHost);
        // A panic there has been printed.
        outbound.join().unwrap_or(Ok(())).and(inbound)
    })
}

/// Carries frames one way until a side leaves or the line is no longer wanted.
fn forward(
    mut from: &TcpStream,
    mut to: &TcpStream,
    mut fault: impl FnMut(&mut Vec<u8>),
    stop: &AtomicBool,
) -> io::Result<()> {
    let (mut bytes, mut frame) = ([0; 4096], Vec::new());
    while !stop.load(Relaxed) {
        let length = match from.read(&mut bytes) {
            Ok(0) => return Ok(()),
            Ok(length) => length,
            Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => continue,
            Err(error) => return Err(error),
        };
        for &byte in &bytes[..length] {
            frame.push(byte);
            if byte == 0 {
                fault(&mut frame);
                to.write_all(&frame)?;
                frame.clear();
            }
        }
    }
    Ok(())
}
