//! What the tick starts with, as the boot has decided; and what the DAC is for.

use crate::correction::Correction;
use crate::drive::Drive;
use crate::facts::Facts;
use crate::leap::Leap;
use crate::ramp::Stride;
use crate::setpoint::Setpoint;
use estimator_core::{Admitted, DacCalibration, DacCode, Estimator};
use protocol::Faults;

/// What the DAC is for.
#[expect(clippy::large_enum_variant, reason = "there is one, and it lies in the board's memory for as long as it runs")]
pub enum DacUse {
    /// Nothing: it stays at its safe code. There is no table, or one by which it would drive the amplifier, and which
    /// is not to be trusted.
    Rests,
    /// It shows the displacement, by this calibration, in parts of a code.
    Shows(DacCalibration),
    /// It drives the amplifier.
    Drives {
        /// What follows the references.
        drive: Drive,
        /// A controller's wish, where the table says which displacements its codes stand for.
        setpoint: Option<Setpoint>,
    },
}

impl DacUse {
    /// The drive, where there is one.
    pub fn drive(&self) -> Option<&Drive> {
        match self {
            Self::Drives { drive, .. } => Some(drive),
            Self::Rests | Self::Shows(_) => None,
        }
    }

    /// The same, to be told something.
    pub fn drive_mut(&mut self) -> Option<&mut Drive> {
        match self {
            Self::Drives { drive, .. } => Some(drive),
            Self::Rests | Self::Shows(_) => None,
        }
    }
}

/// What the tick computes with, and where its output rests.
pub struct Startup {
    /// The estimator; without one the DAC stays at its safe code.
    pub estimator: Option<Estimator<f32>>,
    /// What makes up for a supply that is off, of what is read.
    pub correction: Correction,
    /// What finds voltages that the amplifier cannot have made, where the table says how fast it is.
    pub leap: Option<Leap>,
    /// What the DAC is for.
    pub dac: DacUse,
    /// The set-point is followed from the first tick on, as soon as everything is sound.
    pub linearises: bool,
    /// The DAC's safe code.
    pub safe: DacCode,
    /// `safe` is known to suit the wiring. Where it is not, the DAC stays off its pin.
    pub connected: bool,
    /// How fast the DAC may go to its safe code.
    pub stride: Stride,
    /// Faults known since boot, which last until the next reset; [`Faults::ZERO_LOST`] until a displacement is told.
    pub faults: Faults,
}

impl Startup {
    /// The start with a table, or without one. `doubts` say why the table may be
    /// another actuator's ([`crate::boot::Chosen`]).
    ///
    /// With doubts, or after several failures in a row, nothing is driven: the output holds the safe code of an earlier
    /// start, and stays off its pin if none is known. Without the crystal the ticks' rate is unknown, and nothing is
    /// estimated or driven.
    pub fn new(table: Option<&Admitted>, facts: &Facts, doubts: Faults) -> Self {
        let estimator = table.filter(|_| facts.clock_good).map(Estimator::new);
        let correction = Correction::new(facts.interface.adc_full_scale, table);
        let leap = table.and_then(|table| Leap::new(table));
        let degraded = facts.restarts.too_many();
        let trusted = table.filter(|_| !degraded && doubts.is_empty());
        // The safe output is the drive's rest; or it shows the model's zero, where an unpowered actuator is. Its
        // code is the table's that the output is wired for: where this table may be another's, an earlier
        // start's, or nobody's.
        let safe = trusted.map(|table| Drive::rest(table).unwrap_or_else(|| table.dac.code(0.0f32)));
        let safe = safe.or(facts.restarts.safe);
        let connected = safe.is_some();
        let safe = safe.unwrap_or(DacCode(facts.interface.dac_full_scale / 2));
        // Another actuator's table would have the drive rest at another code, and move there.
        let driving = trusted.filter(|_| facts.clock_good);
        let stride = driving.and_then(Drive::stride).unwrap_or(Stride::JUMP);
        let mut faults = doubts;
        faults.set(Faults::NO_TABLE, table.is_none());
        faults.set(Faults::CLOCK, !facts.clock_good);
        faults.set(Faults::ZERO_LOST, facts.restarts.told);
        let setpoint = driving.and_then(Setpoint::new);
        // A device that has just failed drives nothing by itself: what it did may be what made it fail.
        let calm = facts.restarts.count == 0 && !faults.intersects(Faults::UNSAFE);
        let linearises = calm && facts.has_setpoint && setpoint.as_ref().is_some_and(Setpoint::at_start);
        let dac = match (driving.and_then(|table| Drive::new(table, facts.dac_parts)), table) {
            (Some(drive), _) => DacUse::Drives { drive, setpoint },
            (None, Some(table)) if table.drive.is_none() => DacUse::Shows(table.dac.finer(facts.dac_parts)),
            (None, _) => DacUse::Rests,
        };
        Self { estimator, correction, leap, dac, linearises, safe, connected, stride, faults }
    }
}
