//! A waveform that the device plays by itself: displacements that are loaded into its memory once, and how
//! they are played.
//!
//! ```text
//! line     point 0 ─► point 1 ─► … ─► the last      straight between, as many ticks from each to the next
//!             ▲──────────────────────────┘          straight in as many ticks, where that is slow; else slowly, and not straight
//! ```

use core::num::NonZeroU16;
use estimator_core::sealed::checksum_of_words;
use serde::{Deserialize, Serialize};

/// Most points that a device keeps. They are gone with a reset.
pub const MOST_POINTS: usize = 4096;

/// How a waveform is played.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Playback {
    /// Its points: as many as have been loaded.
    pub points: NonZeroU16,
    /// What [`checksum`] gives for them.
    pub crc: u32,
    /// Ticks from a point to the next.
    pub every: NonZeroU16,
    /// Lines to be played before the voltage goes back to rest; 0 for ever.
    pub lines: u32,
    /// Each line waits for a rising edge at the trigger input.
    pub on_trigger: bool,
}

/// The CRC-32 (ISO-HDLC) of points, µm, as little-endian `f32`.
pub fn checksum(points: impl Iterator<Item = f32>) -> u32 {
    checksum_of_words(points.map(f32::to_bits))
}
