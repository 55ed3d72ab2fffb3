//! What a file holds, before it is a log.

use measurement_files::{Place, Quantity, SampleTime};

use super::channels::Channels;
use super::error::PlacedFault;
use super::fault::Fault;
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
}

/// The part of a log's rows that may be holes.
const FEW: f64 = 0.1;

impl Recording {
    pub fn rows(&self) -> usize {
        self.displacement.as_ref().map_or(self.voltage.len(), Vec::len)
    }

    /// Puts values on the straight line between their neighbours where there were none (NaN), and notes the rows.
    ///
    /// # Errors
    /// They are too many to be holes.
    pub fn bridge(&mut self) -> Result<(), PlacedFault> {
        let mut empty = vec![false; self.rows()];
        for (quantity, values) in
            [(Quantity::Voltage, Some(&mut self.voltage)), (Quantity::Displacement, self.displacement.as_mut())]
        {
            let Some(values) = values else { continue };
            let missing: Vec<usize> = (0..values.len()).filter(|&row| values[row].is_nan()).collect();
            if let Some(&first) = missing.first()
                && missing.len() as f64 > FEW * values.len() as f64
            {
                let (missing, rows) = (missing.len(), values.len());
                return Err(
                    Fault::Holes { quantity, missing, rows }.at(measurement_files::place(self.first_row, first))
                );
            }
            missing.iter().for_each(|&row| empty[row] = true);
            straighten(values, &missing);
        }
        let mut row = 0;
        for run in empty.chunk_by(|a, b| a == b) {
            if run[0] {
                self.holes.push(row..row + run.len());
            }
            row += run.len();
        }
        Ok(())
    }

    /// The place of row `index`, counted from 0.
    pub fn place(&self, index: usize) -> Place {
        measurement_files::place(self.first_row, index)
    }
}

/// Puts the rows `missing`, which increase, on the straight line between those beside them; at an end, on the one there is.
fn straighten(values: &mut [f64], missing: &[usize]) {
    for run in missing.chunk_by(|a, b| a + 1 == *b) {
        let (first, end) = (run[0], run[0] + run.len());
        let before = first.checked_sub(1).map(|row| values[row]);
        let (from, to) = match (before, values.get(end).copied()) {
            (Some(from), Some(to)) => (from, to),
            (Some(only), None) | (None, Some(only)) => (only, only),
            (None, None) => return,
        };
        let step = (to - from) / (run.len() + 1) as f64;
        values[first..end].iter_mut().zip(1..).for_each(|(value, nth)| *value = from + f64::from(nth) * step);
    }
}
