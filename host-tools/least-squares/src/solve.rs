//! Active sets: a coefficient limited to x ≥ 0 is either passive, solved for, or held at 0.
//!
//! Every step lowers the cost, so that it ends; a limit on the number of steps guards against rounding, and x is
//! admissible after each.

use super::{Normal, Sign};
use nalgebra::{DMatrix, DVector};

/// Steps for each column.
const STEPS: usize = 10;
/// A slope below this fraction of the target's norm is none.
const FLAT: f64 = 1e-15;

impl Normal {
    /// The coefficients of the least squares; `sign` has one entry a column. `None` when it has not, or when the sums
    /// are not finite.
    pub fn solve(&self, sign: &[Sign]) -> Option<Vec<f64>> {
        let n = self.columns;
        let norms: Vec<f64> = (0..n).map(|i| self.entry(i, i).sqrt()).collect();
        if sign.len() != n || !self.square.is_finite() || !norms.iter().all(|norm| norm.is_finite()) {
            return None;
        }
        // A column of zeros has no scale and is left out.
        let scale: Vec<f64> = norms.iter().map(|norm| 1.0 / norm).collect();
        let used: Vec<usize> = (0..n).filter(|&i| scale[i].is_finite()).collect();
        let ridge = |i, j| if i == j { self.ridge } else { 0.0 };
        let scaled = Scaled {
            gram: DMatrix::from_fn(used.len(), used.len(), |i, j| {
                self.entry(used[i], used[j]) * scale[used[i]] * scale[used[j]] + ridge(i, j)
            }),
            moment: DVector::from_fn(used.len(), |i, _| self.moment[used[i]] * scale[used[i]]),
            limited: used.iter().map(|&i| sign[i] == Sign::NonNegative).collect(),
            flat: FLAT * self.square.sqrt(),
        };
        let found = scaled.solve()?;
        let mut solution = vec![0.0; n];
        for (&i, x) in used.iter().zip(&found) {
            solution[i] = x * scale[i];
        }
        solution.iter().all(|x| x.is_finite()).then_some(solution)
    }
}

/// The problem with columns of unit norm, all of them non-zero, and the ridge.
struct Scaled {
    gram: DMatrix<f64>,
    moment: DVector<f64>,
    limited: Vec<bool>,
    flat: f64,
}

impl Scaled {
    fn solve(&self) -> Option<DVector<f64>> {
        let n = self.moment.len();
        let mut passive: Vec<bool> = self.limited.iter().map(|limited| !limited).collect();
        let mut x = self.free(&passive)?;
        // Columns that rounding alone made look worth while, since x last changed.
        let mut refused = vec![false; n];
        for _ in 0..STEPS * n {
            let slope = &self.moment - &self.gram * &x;
            let candidates = (0..n).filter(|&i| !passive[i] && !refused[i] && slope[i] > self.flat);
            let Some(enter) = candidates.max_by(|&a, &b| slope[a].total_cmp(&slope[b])) else { break };
            passive[enter] = true;
            let target = self.free(&passive)?;
            if target[enter] <= 0.0 {
                passive[enter] = false;
                refused[enter] = true;
                continue;
            }
            refused.fill(false);
            self.approach(&mut x, target, &mut passive)?;
        }
        Some(x)
    }

    /// Moves x to where the passive coefficients are solved; those that meet 0 on the way stay there.
    fn approach(&self, x: &mut DVector<f64>, mut target: DVector<f64>, passive: &mut [bool]) -> Option<()> {
        let n = x.len();
        // Each turn but the last takes at least one out of the passive set.
        loop {
            let meets: Vec<usize> = (0..n).filter(|&i| self.limited[i] && passive[i] && target[i] <= 0.0).collect();
            if meets.is_empty() {
                *x = target;
                return Some(());
            }
            let share = |i: usize| if x[i] > target[i] { x[i] / (x[i] - target[i]) } else { 0.0 };
            let step = meets.iter().map(|&i| share(i)).fold(1.0, f64::min);
            let out: Vec<usize> = meets.into_iter().filter(|&i| share(i) <= step).collect();
            *x += (&target - &*x) * step;
            for i in out {
                passive[i] = false;
            }
            for i in (0..n).filter(|&i| self.limited[i]) {
                x[i] = if passive[i] { x[i].max(0.0) } else { 0.0 };
            }
            target = self.free(passive)?;
        }
    }

    /// The least squares over the passive coefficients, the others 0. `None` when they have none.
    fn free(&self, passive: &[bool]) -> Option<DVector<f64>> {
        let chosen: Vec<usize> = (0..passive.len()).filter(|&i| passive[i]).collect();
        let mut x = DVector::zeros(passive.len());
        if chosen.is_empty() {
            return Some(x);
        }
        let gram = self.gram.select_rows(&chosen).select_columns(&chosen);
        let found = gram.cholesky()?.solve(&self.moment.select_rows(&chosen));
        for (&i, &value) in chosen.iter().zip(&found) {
            x[i] = value;
        }
        Some(x)
    }
}
