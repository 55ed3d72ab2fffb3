//! What a file holds, before it is a log.

use measurement_files::{Place, SampleTime};

use super::channels::Channels;

/// Fewest rows that make a log.
pub const MINIMUM_ROWS: usize = 16;

/// The numbers of one file, finite and in s, V and µm, before they are checked.
#[derive(Debug)]
pub(super) struct Recording {
    pub channels: Channels,
    pub first_row: Place,
    /// What the file says about its sample time outside its columns.
    pub sample_time: Option<SampleTime>,
    pub time: Option<Vec<f64>>,
    pub voltage: Vec<f64>,
    pub displacement: Option<Vec<f64>>,
}

impl Recording {
    pub fn rows(&self) -> usize {
        self.displacement.as_ref().map_or(self.voltage.len(), Vec::len)
    }

    /// The place of row `index`, counted from 0.
    pub fn place(&self, index: usize) -> Place {
        measurement_files::place(self.first_row, index)
    }
}
