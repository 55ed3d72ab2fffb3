//! What a file holds, before it is a log.

use super::channels::Channels;
use super::error::Place;

/// The numbers of one file, finite and in s, V and µm, before they are checked.
#[derive(Debug)]
pub(super) struct Recording {
    pub channels: Channels,
    pub origin: Origin,
    pub time: Option<Vec<f64>>,
    pub voltage: Vec<f64>,
    pub displacement: Option<Vec<f64>>,
}

impl Recording {
    pub fn rows(&self) -> usize {
        self.displacement.as_ref().map_or(self.voltage.len(), Vec::len)
    }
}

/// Where the first row of a recording stands.
#[derive(Debug, Clone, Copy)]
pub(super) enum Origin {
    /// At this line of a text file.
    Line(usize),
    /// At the start of an array.
    Sample,
}

impl Origin {
    /// The place of row `index`, counted from 0.
    pub fn place(self, index: usize) -> Place {
        match self {
            Self::Line(first) => Place::Line(first + index),
            Self::Sample => Place::Sample(index + 1),
        }
    }
}
