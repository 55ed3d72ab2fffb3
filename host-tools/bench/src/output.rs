//! What the DAC puts out at rest by one table and by another.
//!
//! A device that takes another table goes to rest by the one in use, restarts, and puts out the rest of the new one
//! at once. Where the two rests are not the same code, or the codes do not stand for the same volts, that is a jump
//! at the amplifier.

use estimator_core::{Admitted, DacCode};
use std::fmt;

/// What the DAC's codes stand for, and the one at rest.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Output {
    /// Voltage at rest, V.
    pub rest_v: f32,
    /// The DAC's code of that voltage.
    pub rest: DacCode,
    /// Volts at code 0 and at the largest code.
    pub span_v: (f32, f32),
}

/// The DAC puts out something else at rest by another table than by the one in use.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
#[error(
    "the DAC's output would jump as the device restarts: by the table in use it is {in_use}; by the other, {other}"
)]
pub struct Jump {
    /// By the table in use.
    pub in_use: Output,
    /// By the one that would take its place.
    pub other: Output,
}

impl Output {
    /// Of a table; `None` where its DAC does not drive an amplifier.
    pub fn of(table: &Admitted) -> Option<Self> {
        let (drive, full_scale) = (table.drive?, table.dac.full_scale);
        let rest_v = drive.limits.rest_v;
        let rest = drive.code(rest_v, full_scale);
        Some(Self { rest_v, rest, span_v: (drive.voltage(DacCode(0)), drive.voltage(DacCode(full_scale))) })
    }

    /// Refuses a table in whose place another one would let the amplifier's voltage jump. Where either drives nothing
    /// the firmware itself asks whether the board is rewired.
    ///
    /// # Errors
    /// The two differ.
    pub fn same(in_use: &Admitted, other: &Admitted) -> Result<(), Jump> {
        match (Self::of(in_use), Self::of(other)) {
            (Some(in_use), Some(other)) if in_use != other => Err(Jump { in_use, other }),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Output {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { rest_v, rest, span_v } = self;
        write!(f, "{rest_v} V at rest, code {} of a DAC of {:.3} … {:.3} V", rest.0, span_v.0, span_v.1)
    }
}
