//! What the tick has the DAC put out: what the estimate shows or the drive commands, or the safe output; and what the
//! DAC is given for it.

use super::Tick;
use crate::decimation::Streamed;
use crate::drive::Drive;
use crate::setpoint::SetpointCode;
use crate::shaping::{Codes, DacParts};
use crate::telemetry::add;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::Status;
use protocol::Mode;

/// What the DAC is to have.
pub(crate) struct Output {
    pub codes: Codes,
    /// It is the safe one, or on the way there.
    pub safe: bool,
    /// What following a reference adds to the tick's status.
    pub status: Status,
}

impl Tick<'_> {
    /// What the DAC is given, and whether that is too little.
    pub(crate) fn give(&self, Codes { code, parts }: Codes) -> (DacParts, bool) {
        self.telemetry.set_dac(code);
        self.telemetry.given.tick(&self.telemetry.supply, parts)
    }

    /// The output of a tick whose estimate the DAC would show by `shown`, where it shows that, and whose set-point has
    /// the code `setpoint`; where not `sound`, the safe one.
    pub(crate) fn output(&mut self, shown: Option<Codes>, setpoint: Option<SetpointCode>, sound: bool) -> Output {
        let status = Status::empty();
        match &mut self.startup.drive {
            Some(drive) if self.mode.drives() => {
                // What waits at rest for a set-point goes on waiting.
                if !sound && (setpoint.is_none() || drive.following()) {
                    drive.stop();
                }
                let next = match (setpoint, &mut self.startup.setpoint) {
                    (Some(code), Some(wants)) => wants.wanted(code, sound, drive.rests()),
                    _ if self.mode == Mode::Waveform => {
                        let wanted = if drive.stopped() { None } else { self.player.tick() };
                        if wanted.is_none() {
                            self.player.stop();
                            drive.stop();
                        }
                        wanted
                    }
                    // The first one is for a tick that is streamed, so that the host knows which it was.
                    _ if drive.takes_references() && (!drive.ready() || Streamed::has(self.number)) => {
                        self.queues.references.take()
                    }
                    _ => None,
                };
                if next.is_none() && drive.following() {
                    add(&self.telemetry.starved, 1);
                }
                let (codes, status) = if self.mode == Mode::Excite { drive.excite(next) } else { drive.follow(next) };
                self.telemetry.holding.store(drive.holding(), Relaxed);
                self.telemetry.stopped.store(drive.stopped(), Relaxed);
                Output { codes, safe: !drive.following(), status }
            }
            Some(drive) => Output { codes: drive.release(), safe: true, status },
            None => match shown.filter(|_| sound) {
                Some(codes) => Output { codes, safe: false, status },
                None => Output { codes: self.startup.at_safe(), safe: true, status },
            },
        }
    }

    /// What the board does with its pins at the beginning of a tick. `Some(level)` while a waveform is played: set the
    /// sync pin, which is high from a line's first point until its second, then call [`trigger`](Self::trigger).
    /// `None`: leave both pins alone.
    #[inline]
    pub fn sync(&mut self) -> Option<bool> {
        self.player.sync()
    }

    /// Takes the level of the trigger input at the tick that begins. It is asked for by [`sync`](Self::sync).
    #[inline]
    pub fn trigger(&mut self, high: bool) {
        self.player.input(high);
    }

    /// The safe output, or one on the way to it.
    pub(crate) fn safe_output(&mut self) -> Codes {
        let safe = self.startup.at_safe();
        self.startup.drive.as_mut().map_or(safe, Drive::release)
    }
}
