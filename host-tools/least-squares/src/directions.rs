//! How the sum of squares changes along combinations of columns.

use super::Normal;
use nalgebra::{DMatrix, DVector};

impl Normal {
    /// What is left of each of `columns` when the others have explained what they can, by least squares without
    /// limits. Each column of the matrix holds the coefficients of one, over all columns. `None` where the others
    /// have no answer.
    ///
    /// # Panics
    ///
    /// When there is no such column.
    pub fn compensated(&self, columns: &[usize], others: &[usize]) -> Option<DMatrix<f64>> {
        // A column of zeros explains nothing.
        let others: Vec<usize> = others.iter().copied().filter(|&i| self.entry(i, i) > 0.0).collect();
        let scale: Vec<f64> = others.iter().map(|&i| 1.0 / self.entry(i, i).sqrt()).collect();
        let ridge = |i, j| if i == j { self.ridge } else { 0.0 };
        let scaled = DMatrix::from_fn(others.len(), others.len(), |i, j| {
            self.entry(others[i], others[j]) * scale[i] * scale[j] + ridge(i, j)
        });
        let between =
            DMatrix::from_fn(others.len(), columns.len(), |i, j| self.entry(others[i], columns[j]) * scale[i]);
        let explained = scaled.cholesky()?.solve(&between);
        let mut combinations = DMatrix::zeros(self.columns, columns.len());
        for (j, &column) in columns.iter().enumerate() {
            combinations[(column, j)] = 1.0;
            for (i, &other) in others.iter().enumerate() {
                combinations[(other, j)] -= explained[(i, j)] * scale[i];
            }
        }
        Some(combinations)
    }

    /// Slope and curvature of the [`residual_sum`](Self::residual_sum) at coefficients, one a column, along
    /// combinations of the columns.
    pub fn along(&self, at: &[f64], combinations: &DMatrix<f64>) -> (DVector<f64>, DMatrix<f64>) {
        let gram = DMatrix::from_fn(self.columns, self.columns, |i, j| self.entry(i, j));
        let left = &gram * DVector::from_column_slice(at) - DVector::from_column_slice(&self.moment);
        (2.0 * combinations.tr_mul(&left), 2.0 * combinations.tr_mul(&(&gram * combinations)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Sign;

    /// Rows of three columns and a target, none of which is a sum of the others.
    fn rows() -> impl Iterator<Item = ([f64; 3], f64)> {
        (0..40).map(|k| {
            let t = 0.1 * f64::from(k);
            ([1.0, t, (3.0 * t).sin()], (2.0 * t).cos() + t * t)
        })
    }

    fn normal() -> Normal {
        let mut normal = Normal::new(3).ridge(0.0);
        rows().for_each(|(row, target)| normal.add(&row, target, 0.5));
        normal
    }

    #[test]
    fn a_compensated_column_has_nothing_that_the_others_explain() {
        let combination = normal().compensated(&[2], &[0, 1]).unwrap();
        assert_eq!(combination[(2, 0)], 1.0);
        let made = |row: [f64; 3]| row.iter().zip(combination.column(0).iter()).map(|(a, x)| a * x).sum::<f64>();
        for other in 0..2 {
            let common: f64 = rows().map(|(row, _)| made(row) * row[other]).sum();
            assert!(common.abs() < 1e-9, "column {other}: {common}");
        }
    }

    #[test]
    fn a_column_of_zeros_explains_nothing() {
        let mut normal = Normal::new(2);
        normal.add(&[0.0, 2.0], 1.0, 1.0);
        assert_eq!(normal.compensated(&[1], &[0]).unwrap(), DMatrix::from_column_slice(2, 1, &[0.0, 1.0]));
    }

    #[test]
    fn slope_and_curvature_are_those_of_the_residual_sum() {
        let (normal, at) = (normal(), [0.3, -1.0, 2.0]);
        let directions = DMatrix::from_column_slice(3, 2, &[1.0, 0.5, 0.0, 0.0, -1.0, 2.0]);
        let (slope, curvature) = normal.along(&at, &directions);
        let moved = |by: [f64; 2]| {
            let to: Vec<f64> =
                (0..3).map(|i| at[i] + directions[(i, 0)] * by[0] + directions[(i, 1)] * by[1]).collect();
            normal.residual_sum(&to)
        };
        let expected = |[a, b]: [f64; 2]| {
            let by = DVector::from_column_slice(&[a, b]);
            moved([0.0, 0.0]) + slope.dot(&by) + 0.5 * by.dot(&(&curvature * &by))
        };
        for by in [[0.1, 0.0], [0.0, 0.2], [-0.3, 0.4]] {
            assert!((moved(by) - expected(by)).abs() < 1e-9 * moved(by), "{by:?}: {} {}", moved(by), expected(by));
        }
        // Solved for, the sum has no slope left.
        let solved = normal.solve(&[Sign::Free; 3]).unwrap();
        assert!(normal.along(&solved, &directions).0.norm() < 1e-9);
    }
}
