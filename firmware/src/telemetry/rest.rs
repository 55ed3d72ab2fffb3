//! Where the output rests, and the way there.

use super::Telemetry;
use crate::ramp::{Ramp, Stride};
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

    /// What the DAC is to be given for it, at the supply of now, in the board's parts of a code.
    pub fn safe_given(&self) -> DacCode {
        self.given.of(self.safe())
    }

    /// The way from what the DAC has been given to what it is given for its safe code, in the board's parts of a code.
    pub fn ramp(&self, from: DacCode) -> Ramp {
        Ramp::new(from, self.safe_given(), self.stride_given())
    }

    /// Most that what the DAC is given may change in a tick, at the supply of now, in the board's parts of a code.
    #[inline]
    pub fn stride_given(&self) -> Stride {
        match self.stride() {
            Stride::JUMP => Stride::JUMP,
            stride => self.given.stride(stride),
        }
    }

    /// Whether the DAC drives something, so that its code may not jump.
    pub fn drives(&self) -> bool {
        self.stride() != Stride::JUMP
    }

    /// Ticks from the DAC's last code to the safe one.
    pub fn ticks_to_safe(&self) -> u32 {
        Ramp::new(DacCode(self.dac.load(Relaxed)), self.safe(), self.stride()).ticks()
    }

    fn stride(&self) -> Stride {
        Stride(self.stride.load(Relaxed))
    }

    pub(crate) fn set_safe(&self, safe: DacCode, stride: Stride, connected: bool) {
        self.connected.store(connected, Relaxed);
        self.dac.store(safe.0, Relaxed);
        self.safe.store(safe.0, Relaxed);
        self.stride.store(stride.0, Relaxed);
    }

    #[inline]
    pub(crate) fn set_dac(&self, code: DacCode) {
        self.dac.store(code.0, Relaxed);
    }
}
