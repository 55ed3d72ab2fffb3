//! The DAC as the amplifier's input: wanted displacements in, codes out, by the model's inverse; or wanted voltages,
//! for a measurement. A displacement comes from the host, from a controller ([`crate::setpoint`]), or from memory
//! ([`crate::waveform`]). The inverse also follows what is wanted in volts, so that its voltage is always the one that
//! is put out.
//!
//! With a table that has a drive the DAC never shows a displacement. When nothing is wanted, or something is wrong, or
//! nobody speaks any more, the voltage goes back to its rest at the drive's slew rate. It never jumps, except in a
//! reset that nobody asked the firmware for.
//!
//! ```text
//! Waiting ── go ─► Ready ── first reference ─► Following ── timeout ─► Stopped
//!    │               └───────── fault ─────────────┴────── fault ─────► │
//!    └─ fault ─────────────────────────────────────────────────────────►┘
//! ```
//!
//! A restart leads from every state to `Waiting`. With a set-point a fault stops only what is followed: what waits goes
//! on waiting.

use crate::amplifier_check::AmplifierCheck;
use crate::ramp::Stride;
use crate::rate::TICK_HZ;
use crate::shaping::{Codes, DacParts};
use estimator_core::{AdcCode, Admitted, Commanded, DacCode, DriveCalibration, Inverse, Pace, Status};

/// Ticks without a reference after which the voltage goes back to rest, where the last reference is not to be
/// held: 1 s.
pub const REFERENCE_TIMEOUT_TICKS: u32 = TICK_HZ;

/// What a drive does with references, as others are told.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum Following {
    /// It has followed none since the mode began, and is at rest or on its way there.
    NotYet = 0,
    /// It follows them, and goes to rest [`REFERENCE_TIMEOUT_TICKS`] after the last one.
    UntilTimeout = 1,
    /// It follows them, and the last one until the mode ends.
    UntilModeEnds = 2,
    /// It follows none until a mode begins, and is at rest or on its way there.
    NoMore = 3,
}

impl Following {
    /// By its number; any other is [`Self::NotYet`].
    pub const fn of_number(number: u8) -> Self {
        match number {
            1 => Self::UntilTimeout,
            2 => Self::UntilModeEnds,
            3 => Self::NoMore,
            _ => Self::NotYet,
        }
    }
}

/// What the drive does with references.
#[derive(Clone, Copy)]
enum State {
    /// At rest; references are left in their queue.
    Waiting,
    /// At rest until the first reference comes.
    Ready { hold: bool },
    /// Follows the last reference that has come, µm or V.
    Following { reference: f32, hold: bool, ticks_without: u32 },
    /// On its way to rest or there. References that come are taken, if `takes`, and not followed.
    Stopped { takes: bool },
}

/// The drive of a table: the model's inverse, the DAC's scale, and what is followed.
pub struct Drive {
    inverse: Inverse<f32>,
    calibration: DriveCalibration,
    full_scale: u16,
    /// The same in parts of codes.
    finer: DriveCalibration,
    finer_full_scale: u16,
    state: State,
    amplifier: AmplifierCheck,
    /// What the model gives for the voltage that was commanded last, µm.
    displacement: f32,
    pace: Pace,
}

impl Drive {
    /// The drive of a table that has one, waiting, of a DAC that is given so many parts of a code.
    pub fn new(table: &Admitted, dac_parts: u16) -> Option<Self> {
        let calibration = table.drive?;
        // Cannot fail: the table was admitted with it.
        let inverse = table.inverse(&calibration.limits).ok()?;
        let amplifier = AmplifierCheck::new(table.adc, &calibration.limits);
        let full_scale = table.dac.full_scale;
        let (finer, finer_full_scale) = (calibration.finer(dac_parts), table.dac.finer(dac_parts).full_scale);
        let (state, displacement, pace) = (State::Waiting, 0.0, Pace::of(table)?);
        Some(Self { inverse, calibration, full_scale, finer, finer_full_scale, state, amplifier, displacement, pace })
    }

    /// The code of the rest voltage.
    pub fn rest(table: &Admitted) -> Option<DacCode> {
        table.drive.map(|drive| drive.code(drive.limits.rest_v, table.dac.full_scale))
    }

    /// The slew rate of a table that has a drive, and what a command's steps are longer for their rounding: of a slow
    /// drive a thirtieth, over much of its range always to the same side, so that the output would fall behind.
    pub fn stride(table: &Admitted) -> Option<Stride> {
        let DriveCalibration { gain_codes_per_v, limits, .. } = table.drive?;
        let [low, high] = [limits.range_v.min, limits.range_v.max].map(|volts| (volts - table.voltage_zero_v).abs());
        let most = limits.slew_v_per_s / TICK_HZ as f32 + f32::EPSILON * low.max(high);
        // What is less than one of its units is cut off.
        Some(Stride::of(gain_codes_per_v.abs() * most + 1.0 / 65_536.0))
    }

    /// Follows nothing and waits for [`go`](Self::go), even after a [`stop`](Self::stop). The voltage stays where it is
    /// until the next tick.
    pub fn restart(&mut self) {
        self.state = State::Waiting;
    }

    /// Takes references from now on. After the last one it holds that until the mode ends, which for a voltage is 5 s
    /// after the host's last word ([`crate::link::LEASE`]); or for [`REFERENCE_TIMEOUT_TICKS`] from then or from now,
    /// whichever is later: a hold, however long, may be gone on from.
    pub fn go(&mut self, hold: bool) {
        self.state = match self.state {
            State::Waiting | State::Ready { .. } => State::Ready { hold },
            State::Following { reference, .. } => State::Following { reference, hold, ticks_without: 0 },
            State::Stopped { .. } => State::Stopped { takes: true },
        };
    }

    /// Follows nothing until [`restart`](Self::restart), whatever comes.
    pub fn stop(&mut self) {
        self.state = State::Stopped { takes: self.takes_references() };
    }

    /// Whether references are to be taken from their queue.
    pub fn takes_references(&self) -> bool {
        !matches!(self.state, State::Waiting | State::Stopped { takes: false })
    }

    /// Whether it is at rest until the first reference comes.
    pub fn ready(&self) -> bool {
        matches!(self.state, State::Ready { .. })
    }

    /// Whether a reference is followed, of either kind.
    pub fn following(&self) -> bool {
        matches!(self.state, State::Following { .. })
    }

    /// What it does with references, for others to read.
    pub fn state(&self) -> Following {
        match self.state {
            State::Waiting | State::Ready { .. } => Following::NotYet,
            State::Following { hold: false, .. } => Following::UntilTimeout,
            State::Following { hold: true, .. } => Following::UntilModeEnds,
            State::Stopped { .. } => Following::NoMore,
        }
    }

    /// What the model gives for the voltage of the last tick, µm relative to its zero, and how long a way
    /// from there takes.
    pub fn stands(&self) -> (f32, Pace) {
        (self.displacement, self.pace)
    }

    /// Whether the rest voltage was commanded last.
    pub fn rests(&self) -> bool {
        self.inverse.rests()
    }

    /// One tick: the codes for the displacement that has come (µm), else for the last one, else on the way to rest; and
    /// whether it is out of reach.
    pub fn follow(&mut self, next: Option<f32>) -> (Codes, Status) {
        let Some(reference) = self.reference(next) else { return (self.release(), Status::empty()) };
        let commanded = tick_inverse(&mut self.inverse, reference);
        self.command(commanded)
    }

    /// As [`follow`](Self::follow), of the amplifier's voltage (V), which is out of reach where the range or the slew
    /// rate is in its way.
    pub fn excite(&mut self, next: Option<f32>) -> (Codes, Status) {
        let Some(voltage) = self.reference(next) else { return (self.release(), Status::empty()) };
        let commanded = self.inverse.steer(voltage);
        self.command(commanded)
    }

    /// The reference of this tick, if one is followed.
    fn reference(&mut self, next: Option<f32>) -> Option<f32> {
        self.state = match (self.state, next) {
            (State::Ready { hold } | State::Following { hold, .. }, Some(reference)) => {
                State::Following { reference, hold, ticks_without: 0 }
            }
            (State::Following { reference, hold, ticks_without }, None) => {
                let ticks_without = ticks_without.saturating_add(1);
                if ticks_without >= REFERENCE_TIMEOUT_TICKS && !hold {
                    State::Stopped { takes: true }
                } else {
                    State::Following { reference, hold, ticks_without }
                }
            }
            (state, _) => state,
        };
        match self.state {
            State::Following { reference, .. } => Some(reference),
            _ => None,
        }
    }

    fn command(&mut self, commanded: Commanded<f32>) -> (Codes, Status) {
        self.amplifier.commanded(commanded.voltage);
        self.displacement = commanded.displacement;
        let status = if commanded.reached { Status::empty() } else { Status::OUT_OF_REACH };
        let code = self.calibration.code(commanded.voltage, self.full_scale);
        (Codes { code, parts: DacParts(self.finer.code(commanded.voltage, self.finer_full_scale).0) }, status)
    }

    /// Whether the amplifier is not where it was commanded to.
    pub fn astray(&self, code: AdcCode) -> bool {
        self.amplifier.astray(code)
    }

    /// One tick towards the rest voltage.
    pub fn release(&mut self) -> Codes {
        let commanded = self.inverse.release();
        self.command(commanded).0
    }
}

/// The inverse's tick as a function of its own, so that its instructions can be counted in an image.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_inverse(inverse: &mut Inverse<f32>, reference: f32) -> Commanded<f32> {
    inverse.tick(reference)
}
