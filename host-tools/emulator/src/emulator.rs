//! An emulated device: what it is made of, and the handle to it while it runs.

use crate::board::Board;
use crate::plant::{Plant, triangle};
use crate::serial_line::SerialLine;
use async_io::Async;
use embassy_futures::select::select;
use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embedded_storage_async::nor_flash::NorFlash;
use parameter_store::{ParameterStore, RamFlash, StoreError};
use protocol::Uid;
use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::thread::JoinHandle;

/// Bytes of the two parameter pages of a device that is given no other flash.
pub const PAGES: usize = 4096;
/// The unique number of a device that is given no other.
pub const UID: Uid = Uid(*b"emulated\0\0\0\0");

/// The unique number of one of several devices.
pub fn numbered(number: u32) -> Uid {
    let mut uid = UID;
    uid.0[8..].copy_from_slice(&number.to_be_bytes());
    uid
}

/// Why a device could not be emulated.
#[derive(Debug, thiserror::Error)]
pub enum EmulatorError {
    /// There is no socket for its serial line.
    #[error("no socket can be opened for the emulated device")]
    Socket(#[from] io::Error),
    /// Its flash is none that can hold the parameter pages.
    #[error("the emulated device's flash cannot hold its tables: {0}")]
    Flash(#[from] StoreError),
}

/// What a device is made of, before it is switched on: plant, flash and pace.
pub struct Emulator<P, F> {
    plant: P,
    flash: F,
    uid: Uid,
    has_setpoint: bool,
    speed: f64,
    port: u16,
}

impl Emulator<(), ()> {
    /// A device that reads a triangle ([`triangle`]), with erased flash in memory, in real time, at a port that the
    /// operating system chooses.
    pub fn new() -> Emulator<impl Plant, RamFlash<Vec<u8>>> {
        Emulator {
            plant: triangle(),
            flash: RamFlash::new(vec![0xFF; PAGES]),
            uid: UID,
            has_setpoint: false,
            speed: 1.0,
            port: 0,
        }
    }
}

impl<P: Plant, F: NorFlash + Send + 'static> Emulator<P, F> {
    /// Connects the converters to something else.
    pub fn plant<Q: Plant>(self, plant: Q) -> Emulator<Q, F> {
        let Self { flash, uid, has_setpoint, speed, port, .. } = self;
        Emulator { plant, flash, uid, has_setpoint, speed, port }
    }

    /// Gives it another flash; all of it is parameter pages. What is stored there is the table that the
    /// device starts with.
    pub fn flash<G: NorFlash + Send + 'static>(self, flash: G) -> Emulator<P, G> {
        let Self { plant, uid, has_setpoint, speed, port, .. } = self;
        Emulator { plant, flash, uid, has_setpoint, speed, port }
    }

    /// Lets so many seconds pass on the device in a second, fewer where this machine is too busy, and at most one while
    /// its drive waits for a reference. Beyond some twenty the link cannot carry every sample away, as on a board whose
    /// line is too slow.
    pub fn speed(self, speed: f64) -> Self {
        Self { speed, ..self }
    }

    /// Gives its chip another unique number: it is then another board.
    pub fn uid(self, uid: Uid) -> Self {
        Self { uid, ..self }
    }

    /// Gives it a channel for a controller's set-point, which the plant's conversions then have.
    pub fn setpoint(self) -> Self {
        Self { has_setpoint: true, ..self }
    }

    /// Listens at this port of the local machine; 0 is any that is free.
    pub fn port(self, port: u16) -> Self {
        Self { port, ..self }
    }

    /// Switches the device on, in a thread of its own.
    ///
    /// # Errors
    /// There is no socket for it, or the flash does not consist of two pages.
    pub fn start(mut self) -> Result<EmulatedDevice, EmulatorError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, self.port))?;
        let address = listener.local_addr()?;
        let listener = Async::new(listener)?;
        // More than a u32 of bytes is no flash of two pages either.
        let pages = 0..u32::try_from(self.flash.capacity()).unwrap_or(u32::MAX);
        ParameterStore::new(&mut self.flash, pages.clone())?;
        let stop = Arc::new(Signal::<CriticalSectionRawMutex, ()>::new());
        let stopped = stop.clone();
        let Self { plant, flash, uid, has_setpoint, speed, .. } = self;
        let thread = std::thread::Builder::new().name("emulated device".to_owned()).spawn(move || {
            let line = SerialLine::new(listener);
            let board = Board { plant, flash, pages, uid, has_setpoint, speed, line: &line };
            async_io::block_on(select(stopped.wait(), board.run()));
        })?;
        Ok(EmulatedDevice { address, stop, thread: Some(thread) })
    }
}

/// A device that runs; dropped, it is switched off.
pub struct EmulatedDevice {
    address: SocketAddr,
    stop: Arc<Signal<CriticalSectionRawMutex, ()>>,
    thread: Option<JoinHandle<()>>,
}

impl EmulatedDevice {
    /// The socket that is the device's serial line; one host at a time is served.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Switches the device off and waits until it is.
    pub fn shutdown(self) {}

    /// Waits for as long as the device runs: for ever, unless its plant or flash panics.
    pub fn join(mut self) {
        self.wait();
    }

    fn wait(&mut self) {
        // A panic there has been printed.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

impl Drop for EmulatedDevice {
    fn drop(&mut self) {
        self.stop.signal(());
        self.wait();
    }
}
