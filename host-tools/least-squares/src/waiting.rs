//! Rows that wait to be added many at a time, which takes half as long.

use super::Normal;

/// Rows that are added to the normal equations at once.
const TOGETHER: usize = 64;

/// Rows of one weight on their way into the normal equations of one problem, with their targets. What waits counts from
/// [`finish`](Self::finish) on at the latest; the result is that of [`Normal::add`] to the bit.
#[derive(Clone, PartialEq, Debug)]
pub struct Waiting {
    weight: f64,
    rows: Vec<f64>,
    targets: Vec<f64>,
}

impl Waiting {
    /// No rows; `weight`, at least 0, is to multiply their squared errors.
    pub fn of_weight(weight: f64) -> Self {
        Self { weight, rows: Vec::new(), targets: Vec::new() }
    }

    /// Adds a row in time.
    ///
    /// # Panics
    ///
    /// When a row has not as many elements as there are columns.
    pub fn add(&mut self, normal: &mut Normal, row: &[f64], target: f64) {
        self.rows.extend_from_slice(row);
        self.targets.push(target);
        if self.targets.len() == TOGETHER {
            self.finish(normal);
        }
    }

    /// Adds what still waits.
    ///
    /// # Panics
    ///
    /// As [`add`](Self::add).
    pub fn finish(&mut self, normal: &mut Normal) {
        normal.add_all(&self.rows, &self.targets, self.weight);
        self.rows.clear();
        self.targets.clear();
    }
}
