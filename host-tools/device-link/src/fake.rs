//! A device in a thread, behind a socket: it speaks the protocol with the firmware's manners, or with the bad ones asked
//! for. Its clock is the socket's reader, so that it runs faster than a board.

mod state;

use super::client::Client;
use super::port::Address;
use estimator_core::Admitted;
use protocol::Identity;
use state::{State, compiled, driving};
use std::net::{Ipv4Addr, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::thread::JoinHandle;
use std::time::Duration;

/// What goes wrong, counted in requests from 0, or in ticks.
#[derive(Clone, Debug, Default)]
pub struct Manners {
    /// Requests whose reply is lost.
    pub lose_replies: Vec<u32>,
    /// Requests whose reply is damaged under way.
    pub damage_replies: Vec<u32>,
    /// The same as the first, counting [`protocol::Request::Feed`] only.
    pub lose_replies_to_feed: Vec<u32>,
    /// From this tick on one frame of samples is lost.
    pub lose_samples_from: Option<u32>,
    /// From this tick on no samples come.
    pub falls_silent_at: Option<u32>,
    /// Once fed, it goes on giving samples for codes that it was not fed.
    pub gives_unasked: bool,
    /// The displacement of this tick has its last bit turned.
    pub wrong_at: Option<u32>,
    /// It streams when the host comes, and the host comes in the middle of a frame.
    pub streams: bool,
    /// It answers in version 3 of the protocol.
    pub newer: bool,
    /// It reads a newer format of records.
    pub newer_records: bool,
    /// So many ticks find no reference.
    pub starved: u32,
    /// From this tick on it stands at its safe value by a fault.
    pub faulty_from: Option<u32>,
    /// Its table says that the DAC drives the amplifier.
    pub drives: bool,
    /// Every write of flash fails.
    pub store_fails: bool,
}

/// The device.
pub struct Fake {
    address: Address,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
    drives: bool,
}

impl Fake {
    /// Starts one.
    pub fn start(manners: Manners) -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let address = Address::Tcp(listener.local_addr().unwrap().to_string());
        let stop = Arc::new(AtomicBool::new(false));
        listener.set_nonblocking(true).unwrap();
        let drives = manners.drives;
        let mut state = State::new(manners);
        let stopped = stop.clone();
        let thread = std::thread::spawn(move || {
            while !stopped.load(Relaxed) {
                match listener.accept() {
                    Ok((stream, _)) => state.serve(stream, &stopped),
                    Err(_) => std::thread::sleep(Duration::from_millis(5)),
                }
            }
        });
        Self { address, stop, thread: Some(thread), drives }
    }

    /// Where it listens.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// A client that is connected to it, and who it says it is.
    pub fn connect(&self) -> (Client, Identity) {
        Client::connect(&self.address).unwrap()
    }

    /// The table it was built with.
    pub fn table(&self) -> Admitted {
        if self.drives { driving() } else { compiled() }
    }
}

impl Drop for Fake {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
        // A panic there has been printed.
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
