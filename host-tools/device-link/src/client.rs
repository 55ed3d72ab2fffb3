//! The host's end of the link: requests and their replies, and the samples that arrive in between.
//!
//! A reply belongs to the request whose sequence number it carries. A request without a reply is sent again under the
//! same number where twice is as good as once. It is not for [`Request::Feed`], [`Request::SetZero`] (the displacement
//! has moved on), [`Request::ShiftBias`] (it adds) and [`Request::Play`] (what was short may be over by then): then
//! [`LinkError::Unknown`] has the caller find out.

mod requests;

pub use requests::WriteConsent;

use super::error::LinkError;
use super::port::{Address, Port};
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, FrameError, Identity, Refusal, Reply, Request, Samples, ToDevice, ToHost, encode};
use std::collections::VecDeque;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::ErrorKind;
use std::time::{Duration, Instant};

/// Longest wait for a reply.
const REPLY: Duration = Duration::from_millis(500);
/// The same where flash is written before the reply.
const WRITTEN: Duration = Duration::from_secs(2);
/// The same of references, which a device that drives must not be without: half of what its queue of them lasts.
const REFERRED: Duration = Duration::from_millis(60);
/// How often references are sent before the device is called silent, which takes as long as with other requests.
const REFERS: u32 = 25;
/// How often a request is sent before the device is called silent.
const TRIES: u32 = 3;
/// Pause before a busy device is asked again.
const BUSY: Duration = Duration::from_millis(50);
/// Longest time for which what had arrived before the port was opened is thrown away.
const STALE: Duration = Duration::from_millis(100);

/// A link to a device.
pub struct Client {
    address: Address,
    port: Box<dyn Port>,
    deframer: Deframer,
    /// A whole frame has been seen since the port was opened: what is damaged from now on was damaged under way.
    in_step: bool,
    damaged: u32,
    sequence: u16,
    replies: VecDeque<(u16, Reply)>,
    samples: VecDeque<Samples>,
}

impl Client {
    /// Opens the port and asks who is there. A stream that an earlier run left on is stopped.
    ///
    /// # Errors
    /// No port is the only board's, it cannot be opened, or nobody answers there in this version of the protocol.
    pub fn connect(address: &Address) -> Result<(Self, Identity), LinkError> {
        let address = address.resolved().map_err(LinkError::Port)?;
        let mut client = Self {
            port: address.open()?,
            address,
            deframer: Deframer::new(),
            in_step: false,
            damaged: 0,
            // Any: so that a late reply to an earlier run is none to this.
            sequence: RandomState::new().build_hasher().finish() as u16,
            replies: VecDeque::new(),
            samples: VecDeque::new(),
        };
        client.forget_stale()?;
        client.stream(false)?;
        let identity = client.identify()?;
        Ok((client, identity))
    }

    /// Where the device is.
    pub fn address(&self) -> &Address {
        &self.address
    }

    /// Frames that came damaged.
    pub fn damaged(&self) -> u32 {
        self.damaged
    }

    /// The next samples, if some come within `patience`.
    pub fn samples(&mut self, patience: Duration) -> Result<Option<Samples>, LinkError> {
        let deadline = Instant::now() + patience;
        while self.samples.is_empty() && Instant::now() < deadline {
            self.receive()?;
        }
        Ok(self.samples.pop_front())
    }

    /// Asks, and asks again where that does no harm.
    pub fn request(&mut self, request: Request) -> Result<Reply, LinkError> {
        let (tries, patience) = match request {
            Request::Feed(_) | Request::SetZero { .. } | Request::ShiftBias { .. } | Request::Play(_) => (1, REPLY),
            Request::Refer { .. } => (REFERS, REFERRED),
            Request::Push { .. } | Request::Erase { .. } => (TRIES, WRITTEN),
            _ => (TRIES, REPLY),
        };
        self.sequence = self.sequence.wrapping_add(1);
        self.replies.clear();
        let message = ToDevice { sequence: self.sequence, request };
        // The delimiter in front ends whatever of an earlier frame has been lost.
        let mut bytes = vec![0];
        let mut buffer = [0; MAX_FRAME];
        // Cannot fail: a test of the protocol encodes every message at its longest.
        bytes.extend(encode(&message, &mut buffer).expect("every message of the protocol fits a frame"));
        let port = self.address.clone();
        let mut failure = if tries > 1 { LinkError::Silent { port } } else { LinkError::Unknown { port } };
        for _ in 0..tries {
            self.port.write_all(&bytes).and_then(|()| self.port.flush()).map_err(|error| self.broken(error))?;
            match self.reply(patience)? {
                None => {}
                Some(Reply::Refused(refusal)) => {
                    let busy = refusal == Refusal::Busy;
                    failure = LinkError::Refused { port: self.address.clone(), refusal: Box::new(refusal) };
                    if !busy {
                        return Err(failure);
                    }
                    std::thread::sleep(BUSY);
                }
                Some(reply) => return Ok(reply),
            }
        }
        Err(failure)
    }

    fn reply(&mut self, patience: Duration) -> Result<Option<Reply>, LinkError> {
        let deadline = Instant::now() + patience;
        loop {
            while let Some((to, reply)) = self.replies.pop_front() {
                if to == self.sequence {
                    return Ok(Some(reply));
                }
            }
            if Instant::now() >= deadline {
                return Ok(None);
            }
            self.receive()?;
        }
    }

    /// Sorts what arrives within one read.
    fn receive(&mut self) -> Result<(), LinkError> {
        let mut bytes = [0; 4096];
        let length = self.read(&mut bytes)?;
        for &byte in &bytes[..length] {
            match self.deframer.push(byte) {
                None => continue,
                Some(Ok(ToHost::Reply { to, reply })) => self.replies.push_back((to, reply)),
                Some(Ok(ToHost::Samples(samples))) => self.samples.push_back(samples),
                Some(Err(FrameError::Version { found })) => {
                    return Err(LinkError::Version { port: self.address.clone(), found });
                }
                Some(Err(_)) => self.damaged += u32::from(self.in_step),
            }
            self.in_step = true;
        }
        Ok(())
    }

    /// Throws away what has already arrived.
    fn forget_stale(&mut self) -> Result<(), LinkError> {
        let deadline = Instant::now() + STALE;
        while Instant::now() < deadline && self.read(&mut [0; 4096])? > 0 {}
        self.deframer = Deframer::new();
        self.in_step = false;
        self.samples.clear();
        Ok(())
    }

    /// Reads what there is; nothing, if nothing comes in time.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, LinkError> {
        match self.port.read(bytes) {
            Ok(0) => Err(self.broken(ErrorKind::UnexpectedEof.into())),
            Ok(length) => Ok(length),
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => Ok(0),
                _ => Err(self.broken(error)),
            },
        }
    }

    fn broken(&self, error: std::io::Error) -> LinkError {
        LinkError::Broken { port: self.address.clone(), error }
    }

    fn confused(&self) -> LinkError {
        LinkError::Confused { port: self.address.clone() }
    }
}
