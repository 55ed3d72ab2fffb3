//! What a tick gives, as it is streamed.

use crate::faults::Faults;
use estimator_core::Status;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Most samples in one frame.
pub const MAX_BATCH: usize = 32;

/// What one tick read, estimated and put out.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct Sample {
    /// What the converter read ([`estimator_core::AdcCode`]), corrected for the supply where the board measures it;
    /// the table's calibration makes volts of it.
    pub code: u16,
    /// What the converter read at the displacement sensor, on the same scale, likewise corrected; `None` where the board has
    /// no such channel, and where the code was fed ([`crate::Mode::Pil`]).
    pub sensor: Option<u16>,
    /// Displacement at the next tick, µm relative to the zero; 0 where nothing was estimated.
    pub displacement: f32,
    /// Half the width of its 95 % interval ([`estimator_core::interval`]), µm; `None` where there is none.
    pub half_width: Option<f32>,
    /// The DAC's code ([`estimator_core::DacCode`]), to be put out at the next tick: what it was given, but for what makes up
    /// for the supply where the board measures it.
    pub dac: u16,
    /// What the estimator reported.
    pub status: Status,
    /// What the device reports.
    pub faults: Faults,
}

/// Samples of consecutive ticks.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Samples {
    /// Number of the first sample's tick, counted from 0 when the mode was entered. A gap to the last frame's end is loss.
    pub first: u32,
    /// The samples, one a tick.
    pub samples: Vec<Sample, MAX_BATCH>,
}
