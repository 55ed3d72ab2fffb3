//! Linear least squares on accumulated normal equations: minimises Σ wᵢ·(aᵢ·x − bᵢ)² over x, some of its components
//! limited to x ≥ 0, without keeping the rows aᵢ; memory is n² whatever the length of a log.
//!
//! Solved by Lawson and Hanson's active sets on the normal equations (Bro and de Jong, fast non-negative least squares,
//! 1997), with the free columns always in the passive set. Columns are scaled to unit norm first, and a ridge on the
//! scaled ones, 10⁻⁹ unless set, keeps collinear columns solvable: it shares a coefficient among them. A column of
//! zeros gets the coefficient 0.
//!
//! Normal equations square the condition: coefficients of columns that differ by less than some 10⁻⁴ of their norm are
//! the ridge's choice, the residual is not affected. Other norms than L2 by reweighting the rows.

mod directions;
mod solve;
mod waiting;

pub use waiting::Waiting;

use pulp::{Arch, NullaryFnOnce};

/// Rows that are added together.
const TOGETHER: usize = 4;
/// Sums that are made side by side: a vector of the wider instructions.
const LANES: usize = 4;

/// What a coefficient may be.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Sign {
    /// Either sign is allowed.
    Free,
    /// 0 or more.
    NonNegative,
}

/// Normal equations of a least-squares problem of n columns.
#[derive(Clone, PartialEq, Debug)]
pub struct Normal {
    columns: usize,
    /// AᵀWA, row by row; only its upper triangle is kept.
    gram: Vec<f64>,
    /// The weighted moment AᵀWb.
    moment: Vec<f64>,
    /// The weighted square bᵀWb.
    square: f64,
    ridge: f64,
}

impl Normal {
    /// The equations of no row yet.
    pub fn new(columns: usize) -> Self {
        Self { columns, gram: vec![0.0; columns * columns], moment: vec![0.0; columns], square: 0.0, ridge: 1e-9 }
    }

    /// Sets the ridge: `relative` times the squared norm of each column is added to the normal equations when they are
    /// solved. At 0, collinear columns may have no solution.
    #[must_use]
    pub fn ridge(mut self, relative: f64) -> Self {
        self.ridge = relative;
        self
    }

    /// Adds a row with its target; `weight`, at least 0, multiplies its squared error.
    ///
    /// # Panics
    ///
    /// When the row has another number of columns.
    pub fn add(&mut self, row: &[f64], target: f64, weight: f64) {
        self.add_together(&[row], &[target], weight);
    }

    /// Adds rows of one weight, which stand one behind the other, with a target each. To the bit what
    /// [`add`](Self::add) of one after the other makes of them, in half its time: the sums are loaded and stored once
    /// for several rows.
    ///
    /// # Panics
    ///
    /// When they are not as many rows of the columns as there are targets.
    pub(crate) fn add_all(&mut self, rows: &[f64], targets: &[f64], weight: f64) {
        assert_eq!(rows.len(), targets.len() * self.columns, "rows and targets");
        // Wider instructions where the machine has them; each sum is made of the same additions.
        Arch::new().dispatch(Rows { normal: self, rows, targets, weight });
    }

    #[inline(always)]
    fn add_rows(&mut self, rows: &[f64], targets: &[f64], weight: f64) {
        let mut rows = rows.chunks_exact(self.columns.max(1));
        let (together, rest) = targets.as_chunks::<TOGETHER>();
        for targets in together {
            self.add_together(&targets.map(|_| rows.next().unwrap_or_default()), targets, weight);
        }
        for (row, &target) in rows.zip(rest) {
            self.add_together(&[row], &[target], weight);
        }
    }

    #[inline(always)]
    fn add_together<const N: usize>(&mut self, rows: &[&[f64]; N], targets: &[f64; N], weight: f64) {
        assert!(rows.iter().all(|row| row.len() == self.columns), "columns of a row");
        for i in 0..self.columns {
            let weighted = rows.map(|row| weight * row[i]);
            // The constant of another part of the rows.
            if weighted == [0.0; N] {
                continue;
            }
            let upper = &mut self.gram[i * self.columns + i..(i + 1) * self.columns];
            let others = rows.map(|row| &row[i..][..upper.len()]);
            let (sums, last_sums) = upper.as_chunks_mut::<LANES>();
            for (k, sums) in sums.iter_mut().enumerate() {
                for (weighted, other) in weighted.iter().zip(others) {
                    let other = &other[k * LANES..][..LANES];
                    *sums = std::array::from_fn(|lane| sums[lane] + weighted * other[lane]);
                }
            }
            for (sum, j) in last_sums.iter_mut().zip(sums.len() * LANES..) {
                for (weighted, other) in weighted.iter().zip(others) {
                    *sum += weighted * other[j];
                }
            }
            for (weighted, target) in weighted.iter().zip(targets) {
                self.moment[i] += weighted * target;
            }
        }
        for target in targets {
            self.square += weight * target * target;
        }
    }

    /// Adds the rows of another problem, whose column j is this one's `columns[j]`, ascending; `weight`, at least 0,
    /// multiplies their squared errors. The ridge is this one's.
    ///
    /// # Panics
    ///
    /// When there is no such column.
    pub fn merge(&mut self, other: &Self, columns: &[usize], weight: f64) {
        assert_eq!(other.columns, columns.len(), "columns of the other problem");
        for (i, &row) in columns.iter().enumerate() {
            for (j, &column) in columns.iter().enumerate().skip(i) {
                self.gram[row * self.columns + column] += weight * other.entry(i, j);
            }
            self.moment[row] += weight * other.moment[i];
        }
        self.square += weight * other.square;
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Σ wᵢ·(aᵢ·x − bᵢ)² of coefficients, without the ridge; a missing coefficient is 0. It is the difference of sums
    /// as large as Σ wᵢ·bᵢ² and has their rounding error; never below 0.
    pub fn residual_sum(&self, weights: &[f64]) -> f64 {
        let mut sum = self.square;
        for (i, (&x, moment)) in weights.iter().zip(&self.moment).enumerate() {
            let mut product = 0.5 * self.entry(i, i) * x;
            for (j, &other) in weights.iter().enumerate().take(self.columns).skip(i + 1) {
                product += self.entry(i, j) * other;
            }
            sum += 2.0 * x * (product - moment);
        }
        // `f64::max` would turn NaN into 0.
        if sum < 0.0 { 0.0 } else { sum }
    }

    fn entry(&self, i: usize, j: usize) -> f64 {
        self.gram[i.min(j) * self.columns + i.max(j)]
    }
}

/// Rows on their way into normal equations.
struct Rows<'a> {
    normal: &'a mut Normal,
    rows: &'a [f64],
    targets: &'a [f64],
    weight: f64,
}

impl NullaryFnOnce for Rows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.normal.add_rows(self.rows, self.targets, self.weight);
    }
}
