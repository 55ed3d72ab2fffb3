//! How an interval did: how often it held the sensor, and how wide it was for that.

use serde::Serialize;

/// Of an interval over what is scored, relative to where the displacement was told.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Coverage {
    /// Instants at which the sensor lay within, %.
    pub covered_percent: f64,
    /// Half-width, µm: the mean.
    pub half_width_um: f64,
    /// The constant half-width that covers as many instants, µm; nobody knows it beforehand.
    pub best_constant_um: f64,
}

impl Coverage {
    /// Of errors and half-widths, µm; `None` of none.
    pub fn of(beside: &[(f64, f64)]) -> Option<Self> {
        let count = beside.len();
        let covered = beside.iter().filter(|(error, half)| error.abs() <= *half).count();
        let mut sizes: Vec<f64> = beside.iter().map(|(error, _)| error.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        Some(Self {
            covered_percent: 100.0 * covered as f64 / count as f64,
            half_width_um: beside.iter().map(|(_, half)| half).sum::<f64>() / count as f64,
            best_constant_um: *sizes.get(covered.saturating_sub(1)).or(sizes.last())?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_counts_what_lies_within() {
        let found = Coverage::of(&[(0.1, 0.2), (-0.3, 0.2), (0.2, 0.4), (-0.1, 0.4)]).unwrap();
        assert_eq!(found.covered_percent, 75.0);
        assert!((found.half_width_um - 0.3).abs() < 1e-12);
        assert_eq!(found.best_constant_um, 0.2, "three of the four errors are no larger");
        assert_eq!(Coverage::of(&[]), None);
    }
}
