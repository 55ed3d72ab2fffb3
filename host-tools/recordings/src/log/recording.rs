//! What a file holds, before it is a log.

use measurement_files::{Place, Quantity, SampleTime};

use super::channels::Channels;
use super::error::PlacedFault;
use super::fault::Fault;
use super::holes::{MOST_HOLES, bridge, put_back, put_stamps_back};
use std::ops::Range;

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
    /// The rows in which a value was none, and lies on the straight line between its neighbours.
    pub holes: Vec<Range<usize>>,
    /// Those of them that the file does not have.
    pub put_back: Vec<Range<usize>>,
}

impl Recording {
    pub fn rows(&self) -> usize {
        self.displacement.as_ref().map_or(self.voltage.len(), Vec::len)
    }

    /// Puts values on straight lines where there were none, and samples where `gaps` says that so many are missing
    /// before a row, and notes the rows.
    ///
    /// # Errors
    /// There is no number in too many rows of the file to be holes of it.
    pub fn bridge(&mut self, gaps: &[(usize, usize)]) -> Result<(), PlacedFault> {
        self.check_holes()?;
        let mut before = 0;
        for &(row, count) in gaps {
            self.put_back.push(row + before..row + before + count);
            before += count;
        }
        let mut measured: Vec<_> = std::iter::once(&mut self.voltage).chain(&mut self.displacement).collect();
        if !gaps.is_empty() {
            self.time.iter_mut().for_each(|time| *time = put_stamps_back(time, gaps));
            measured.iter_mut().for_each(|values| **values = put_back(values, gaps));
        }
        self.holes = bridge(measured.into_iter().map(Vec::as_mut_slice));
        Ok(())
    }

    fn check_holes(&self) -> Result<(), PlacedFault> {
        for (quantity, values) in
            [(Quantity::Voltage, Some(&self.voltage)), (Quantity::Displacement, self.displacement.as_ref())]
        {
            let Some(values) = values else { continue };
            let missing = values.iter().filter(|value| value.is_nan()).count();
            if let Some(first) = values.iter().position(|value| value.is_nan())
                && missing as f64 > MOST_HOLES * values.len() as f64
            {
                return Err(Fault::Holes { quantity, missing, rows: values.len() }.at(self.place(first)));
            }
        }
        Ok(())
    }

    /// The place in the file of row `index`, counted from 0; of one that was put back, that of the row behind.
    pub fn place(&self, index: usize) -> Place {
        let not_there = |rows: &Range<usize>| rows.end.min(index).saturating_sub(rows.start);
        let there = index - self.put_back.iter().map(not_there).sum::<usize>();
        measurement_files::place(self.first_row, there)
    }
}
