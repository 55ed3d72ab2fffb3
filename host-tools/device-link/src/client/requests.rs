//! The requests, a method each.

use super::Client;
use crate::error::LinkError;
use crate::words;
use protocol::{Codes, Health, Identity, MOST_VALUES, Mode, Playback, Record, References, Reply, Request};
use std::time::{Duration, Instant};

/// A device that has been told to restart still needs this long to send its reply.
const LEAVES: Duration = Duration::from_millis(100);
/// Longest wait for a device to be back.
const RESTART: Duration = Duration::from_secs(10);

/// What the user has consented to before flash is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct WriteConsent {
    /// The device is estimating, and writing may cost it ticks.
    pub while_estimating: bool,
    /// The new table changes what the DAC is connected to: the amplifier, or a display.
    pub rewired: bool,
}

impl Client {
    /// Who is it?
    ///
    /// # Errors
    /// No proper reply, here and below.
    pub fn identify(&mut self) -> Result<Identity, LinkError> {
        match self.request(Request::Identify)? {
            Reply::Identity(identity) => Ok(words::of_identity(identity)),
            _ => Err(self.confused()),
        }
    }

    /// Asks for counters, faults, mode and cycles: what the device says of how it is.
    pub fn health(&mut self) -> Result<Health, LinkError> {
        match self.request(Request::Health)? {
            Reply::Health(mut health) => {
                health.last_words = health.last_words.as_ref().map(words::printable);
                Ok(health)
            }
            _ => Err(self.confused()),
        }
    }

    /// The record of the table in use.
    pub fn pull(&mut self) -> Result<Record, LinkError> {
        match self.request(Request::Pull)? {
            Reply::Table(record) => Ok(record),
            _ => Err(self.confused()),
        }
    }

    /// Has a table's record stored; the device uses it from its next start on.
    pub fn push(&mut self, record: Record, consent: WriteConsent) -> Result<(), LinkError> {
        let WriteConsent { while_estimating, rewired } = consent;
        self.done(Request::Push { record, while_estimating, rewired })
    }

    /// Empties the parameter store.
    pub fn erase(&mut self, consent: WriteConsent) -> Result<(), LinkError> {
        let WriteConsent { while_estimating, rewired } = consent;
        self.done(Request::Erase { while_estimating, rewired })
    }

    /// Clears counts, faults seen, and last words.
    pub fn forget(&mut self) -> Result<(), LinkError> {
        self.done(Request::Forget)
    }

    /// Calls the displacement of now `at_um`, µm, until the estimate starts anew.
    pub fn set_zero(&mut self, at_um: f32) -> Result<(), LinkError> {
        self.done(Request::SetZero { at_um })
    }

    /// Adds `by_um`, µm, to the displacement from now on, until the estimate starts anew.
    pub fn shift_bias(&mut self, by_um: f32) -> Result<(), LinkError> {
        self.done(Request::ShiftBias { by_um })
    }

    /// Turns the stream of samples on or off. What was streamed before is gone.
    pub fn stream(&mut self, on: bool) -> Result<(), LinkError> {
        let done = self.done(Request::Stream(on));
        self.samples.clear();
        done
    }

    /// Changes what the tick does; this ends the stream, and the device counts samples from 0 again.
    pub fn set_mode(&mut self, mode: Mode) -> Result<(), LinkError> {
        let done = self.done(Request::SetMode(mode));
        self.samples.clear();
        done
    }

    /// Hands codes over for the next ticks; returns how many there was room for.
    pub fn feed(&mut self, codes: Codes) -> Result<usize, LinkError> {
        match self.request(Request::Feed(codes))? {
            Reply::Fed(taken) => Ok(taken.into()),
            _ => Err(self.confused()),
        }
    }

    /// Hands wanted displacements (µm), or voltages (V) in [`Mode::Excite`], over for the next ticks. With `go` the
    /// device follows them from now on and holds the last one: for a second without `hold`; with it for ever in
    /// [`Mode::Follow`], and in [`Mode::Excite`] while frames come and five seconds longer. `first` is the number of
    /// the first, counted from 0 when the mode was set. Returns the number of the next one, for which there was no room
    /// yet, and how many ticks had found none when the one before it was taken.
    pub fn refer(&mut self, first: u32, references: References, go: bool, hold: bool) -> Result<(u32, u32), LinkError> {
        match self.request(Request::Refer { first, references, go, hold })? {
            Reply::Referred { next, starved } => Ok((next, starved)),
            _ => Err(self.confused()),
        }
    }

    /// Loads the points of a waveform, µm relative to the model's zero, in place of what has been loaded before.
    pub fn load(&mut self, points: &[f32]) -> Result<(), LinkError> {
        let mut first = 0;
        for chunk in points.chunks(MOST_VALUES) {
            let request = Request::Load { first, points: chunk.iter().copied().collect() };
            match self.request(request)? {
                Reply::Loaded(count) if usize::from(count) == usize::from(first) + chunk.len() => first = count,
                // The device was restarted meanwhile, or answers something else.
                _ => return Err(self.confused()),
            }
        }
        Ok(())
    }

    /// Plays what has been loaded; this ends the stream, and the device counts samples from 0 again.
    pub fn play(&mut self, how: Playback) -> Result<(), LinkError> {
        let done = self.done(Request::Play(how));
        self.samples.clear();
        done
    }

    /// Restarts the device and waits until it is back.
    pub fn restart(&mut self) -> Result<Identity, LinkError> {
        let Reply::Resetting { in_ms } = self.request(Request::Reset)? else { return Err(self.confused()) };
        let deadline = Instant::now() + RESTART + Duration::from_millis(in_ms.into());
        std::thread::sleep(LEAVES);
        self.forget_stale()?;
        loop {
            match self.identify() {
                Err(LinkError::Silent { .. }) if Instant::now() < deadline => {}
                answer => return answer,
            }
        }
    }

    fn done(&mut self, request: Request) -> Result<(), LinkError> {
        match self.request(request)? {
            Reply::Done => Ok(()),
            _ => Err(self.confused()),
        }
    }
}
