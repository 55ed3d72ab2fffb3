//! What a tick gives, as it is streamed.

use crate::BAUD;
use crate::faults::Faults;
use core::num::NonZeroU8;
use estimator_core::Status;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// Most samples in one frame.
pub const MAX_BATCH: usize = 32;

/// What one tick read, estimated and put out.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct Sample {
    /// The code that was estimated from ([`estimator_core::AdcCode`]), of which the table's calibration makes volts:
    /// what the converter read, corrected for the supply where the board measures it; the last believed one where the
    /// voltage has just leapt as the amplifier cannot.
    pub code: u16,
    /// What the converter read at the displacement sensor, on the same scale, likewise corrected; `None` where the
    /// board has no such channel, and where the code was fed ([`crate::Mode::Pil`]).
    pub sensor: Option<u16>,
    /// Displacement at the next tick, µm relative to the zero; 0 where nothing was estimated.
    pub displacement: f32,
    /// Half the width of its 95 % interval ([`estimator_core::interval`]), µm; `None` where there is none.
    pub half_width: Option<f32>,
    /// The DAC's code ([`estimator_core::DacCode`]), to be put out at the next tick: what it was given, but for what
    /// makes up for the supply where the board measures it.
    pub dac: u16,
    /// What the estimator has to say of this tick's estimate; the drive's bits are among it.
    pub status: Status,
    /// Faults that lasted at this tick.
    pub faults: Faults,
}

/// Samples of ticks that follow one another, or of every n-th where the line does not carry them all.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Samples {
    /// Number of the first sample's tick, counted from 0 when the mode was entered. A gap to the last frame's
    /// end is loss.
    pub first: u32,
    /// Ticks from a sample to the next. Where that is more than 1, those between are not streamed: what their status
    /// and faults reported, but for [`Faults::SAFE_OUTPUT`], is in the next sample's.
    pub every: NonZeroU8,
    /// One of every so many ticks, the earliest first.
    pub samples: Vec<Sample, MAX_BATCH>,
}

impl Samples {
    /// The number of the tick at which the next frame begins, where nothing is lost.
    pub fn end(&self) -> u32 {
        // No more samples than a frame takes.
        self.first.wrapping_add(u32::from(self.every.get()) * self.samples.len() as u32)
    }

    /// The samples with the numbers of their ticks.
    pub fn numbered(&self) -> impl Iterator<Item = (u32, &Sample)> {
        let every = u32::from(self.every.get());
        (0..).map(move |k: u32| self.first.wrapping_add(every.wrapping_mul(k))).zip(&self.samples)
    }
}

/// What a sample takes of the line at most, bytes: its longest, and its part of a frame of eight.
const SAMPLE_BYTES: u32 = 24;
/// What the stream may take of the line, %: the rest is for replies.
const STREAM_PERCENT: u32 = 80;

/// How many ticks a device that ticks so many times a second streams one of. It is a power of 2, so that the ticks'
/// numbers may run over.
pub const fn stream_every(tick_hz: u32) -> NonZeroU8 {
    let mut every = NonZeroU8::MIN;
    // A byte on the line is ten bits.
    while 100 * 10 * SAMPLE_BYTES * (tick_hz / every.get() as u32) > STREAM_PERCENT * BAUD {
        every = every.saturating_mul(TWO);
    }
    every
}

const TWO: NonZeroU8 = NonZeroU8::MIN.saturating_add(1);
