//! Where the output rests, and the way there.

use super::Telemetry;
use crate::ramp::{Ramp, Stride};
use crate::shaping::DacParts;
use crate::startup::Startup;
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::DacCode;

impl Telemetry {
    /// The DAC's safe code.
    pub fn safe(&self) -> DacCode {
        DacCode(self.safe.load(Relaxed))
    }

    /// Whether the output is put on its pin at all: where nobody knows what is wired to it, it is not.
    pub fn connected(&self) -> bool {
        self.connected.load(Relaxed)
    }

    /// What the DAC is to be given for it, at the supply of now.
    pub fn safe_given(&self) -> DacParts {
        self.given.of(self.safe())
    }

    /// The ramp from what the DAC has been given to its safe output, a step a tick.
    pub fn ramp(&self, from: DacParts) -> Ramp {
        Ramp::new(from, self.safe_given(), self.stride_given())
    }

    /// Most that what the DAC is given may change in a tick, at the supply of now, in parts of a code.
    #[inline]
    pub fn stride_given(&self) -> Stride {
        match self.stride() {
            Stride::JUMP => Stride::JUMP,
            stride => self.given.stride(stride),
        }
    }

    /// Whether the DAC drives the amplifier, so that its code may not jump.
    pub fn drives(&self) -> bool {
        self.drives.load(Relaxed)
    }

    /// Ticks from the DAC's last code to the safe one.
    pub fn ticks_to_safe(&self) -> u32 {
        self.stride().ticks(self.dac.load(Relaxed), self.safe.load(Relaxed))
    }

    /// Most codes by which the safe code may be approached in a tick.
    fn stride(&self) -> Stride {
        Stride::new(self.stride.load(Relaxed))
    }

    /// Before the first tick: what the output rests at, and the way there.
    pub(crate) fn begin_at_rest(&self, startup: &Startup) {
        self.connected.store(startup.connected, Relaxed);
        self.drives.store(startup.dac.drive().is_some(), Relaxed);
        self.dac.store(startup.safe.0, Relaxed);
        self.safe.store(startup.safe.0, Relaxed);
        self.stride.store(startup.stride.get(), Relaxed);
    }

    #[inline]
    pub(crate) fn set_dac(&self, code: DacCode) {
        self.dac.store(code.0, Relaxed);
    }
}
