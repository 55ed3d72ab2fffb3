//! What the tick has the DAC put out: what the estimate shows or the drive commands, or the safe output; and what the
//! DAC is given for it.

use super::Tick;
use crate::decimation::Streamed;
use crate::drive::{Drive, Following};
use crate::setpoint::SetpointCode;
use crate::shaping::{Codes, DacParts};
use crate::startup::DacUse;
use crate::telemetry::add;
use estimator_core::{DacCode, Status};
use protocol::Mode;

/// What the DAC is to have.
pub(super) struct Wanted {
    pub codes: Codes,
    /// It is the safe one, or on the way there.
    pub safe: bool,
    /// What following a reference adds to the tick's status.
    pub status: Status,
}

impl Tick<'_> {
    /// What the DAC is given, and whether that is too little.
    pub(super) fn give(&self, Codes { code, parts }: Codes) -> (DacParts, bool) {
        self.telemetry.set_dac(code);
        self.telemetry.given.tick(&self.telemetry.supply, parts)
    }

    /// The output of a tick with this estimate (µm, and its code), whose set-point has the code `setpoint`; where not
    /// `sound`, the safe one.
    pub(super) fn output(
        &mut self,
        (displacement, code): (f32, DacCode),
        setpoint: Option<SetpointCode>,
        sound: bool,
    ) -> Wanted {
        let status = Status::empty();
        match &mut self.dac {
            DacUse::Drives { drive, setpoint: wants } if self.mode.drives() => {
                // What waits at rest for a set-point goes on waiting.
                if !sound && (setpoint.is_none() || drive.following()) {
                    drive.stop();
                }
                let next = match (setpoint, wants) {
                    (Some(code), Some(wants)) => wants.wanted(code, sound, drive.rests()),
                    _ if self.mode == Mode::Waveform => {
                        let wanted = if drive.state() == Following::NoMore { None } else { self.player.tick() };
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
                self.telemetry.set_following(drive.state());
                Wanted { codes, safe: !drive.following(), status }
            }
            DacUse::Drives { drive, .. } => Wanted { codes: drive.release(), safe: true, status },
            DacUse::Shows(calibration) if sound => {
                let parts = DacParts(calibration.code(displacement).0);
                Wanted { codes: Codes { code, parts }, safe: false, status }
            }
            DacUse::Shows(_) | DacUse::Rests => Wanted { codes: self.safe, safe: true, status },
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
    pub(super) fn safe_output(&mut self) -> Codes {
        self.dac.drive_mut().map_or(self.safe, Drive::release)
    }
}
