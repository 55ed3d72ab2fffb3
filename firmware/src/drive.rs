//! The DAC as the amplifier's input: wanted displacements in, codes out, by the model's inverse.
//!
//! Where the table says that the DAC is wired so, it never shows a displacement. When nothing is wanted, or something is
//! wrong, or nobody speaks any more, the voltage goes back to its rest at the drive's slew rate; it never jumps, but for a
//! reset or a panic.

use crate::peripherals::TICK_HZ;
use estimator_core::{Admitted, DacCode, DriveCalibration, Inverse, Status};

/// Ticks without a reference after which the voltage goes back to rest, where it is not to stay: a second.
pub const HUNGER: u32 = TICK_HZ;

/// The drive and what it is after.
pub struct Drive {
    inverse: Inverse<f32>,
    calibration: DriveCalibration,
    full_scale: u16,
    reference: Option<f32>,
    going: bool,
    stay: bool,
    /// Ticks without a reference.
    hungry: u32,
    stopped: bool,
}

impl Drive {
    /// The drive of a table that has one.
    pub fn new(table: &Admitted) -> Option<Self> {
        let calibration = table.drive?;
        // Cannot fail: the table was admitted with it.
        let inverse = table.inverse(&calibration.limits).ok()?;
        Some(Self {
            inverse,
            calibration,
            full_scale: table.dac.full_scale,
            reference: None,
            going: false,
            stay: false,
            hungry: 0,
            stopped: false,
        })
    }

    /// The code of the rest voltage.
    pub fn rest(table: &Admitted) -> Option<DacCode> {
        table.drive.map(|drive| drive.code(drive.limits.rest_v, table.dac.full_scale))
    }

    /// Wants nothing any more, waits for [`go`](Self::go), and listens again after a [`stop`](Self::stop). The voltage stays where it is.
    pub fn restart(&mut self) {
        self.reference = None;
        self.going = false;
        self.hungry = 0;
        self.stopped = false;
    }

    /// Wants nothing any more, whatever comes, until [`restart`](Self::restart).
    pub fn stop(&mut self) {
        self.reference = None;
        self.stopped = true;
    }

    /// One tick after a reference: the new one (µm), else the last one; at rest before the first. With it, what there is to
    /// say.
    pub fn follow(&mut self, next: Option<f32>) -> (DacCode, Status) {
        if !self.stopped {
            self.hungry = if next.is_some() { 0 } else { self.hungry.saturating_add(1) };
            self.reference = next.or(self.reference);
            if self.hungry >= HUNGER && !self.stay && self.following() {
                self.stop();
            }
        }
        let Some(reference) = self.reference else { return (self.release(), Status::empty()) };
        let commanded = tick_inverse(&mut self.inverse, reference);
        let status = if commanded.reached { Status::empty() } else { Status::OUT_OF_REACH };
        (self.calibration.code(commanded.voltage, self.full_scale), status)
    }

    /// Takes references from now on; stays at the last one for good, or until none has come for [`HUNGER`].
    pub fn go(&mut self, stay: bool) {
        self.going = true;
        self.stay = stay;
    }

    /// Whether it takes references.
    pub fn going(&self) -> bool {
        self.going
    }

    /// Whether a reference is followed.
    pub fn following(&self) -> bool {
        self.reference.is_some()
    }

    /// One tick towards the rest voltage.
    pub fn release(&mut self) -> DacCode {
        self.calibration.code(self.inverse.release().voltage, self.full_scale)
    }
}

/// The inverse's tick as a function of its own, so that its instructions can be counted in an image.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_inverse(inverse: &mut Inverse<f32>, reference: f32) -> estimator_core::Commanded<f32> {
    inverse.tick(reference)
}
