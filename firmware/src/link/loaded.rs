//! What the device remembers of the waveform that it is handed.

use crate::waveform::Points;
use protocol::Playback;

/// What has been loaded, and how it was to be played last.
pub struct Loaded<'q> {
    /// The tick's memory of it.
    pub(super) points: &'q Points,
    pub(super) count: u16,
    pub(super) played: Option<Playback>,
}

impl<'q> Loaded<'q> {
    /// No points are there yet.
    pub fn new(points: &'q Points) -> Self {
        Self { points, count: 0, played: None }
    }
}
