//! What a table's estimates are off by on a session, and how many independent readings its errors are worth.

use estimator_core::{Admitted, Status};
use recordings::session::{Session, one_of_each};
use std::f64::consts::FRAC_PI_2;
use validation::Run;

/// Products of errors that are summed at a time, at most.
const PRODUCTS: usize = 100_000_000;
/// Every how many readings are looked at where that does not suffice.
const THINNED: usize = 10;

/// What the estimates are off by on a session, µm, without a constant of its own.
pub struct Judged {
    /// At the readings after the first, behind what is only run through.
    pub errors: Vec<f64>,
    /// So many of them belong to the start, until a swing has wiped out what nobody knows.
    pub start: usize,
}

impl Judged {
    /// Of a table, behind what is only run through.
    pub fn of(table: &Admitted, session: &Session) -> Self {
        let run = Run::of::<f64>(table, session, None, None);
        let not_settled = run.status.iter().take_while(|status| status.contains(Status::NOT_SETTLED)).count();
        let mut errors = run.errors(session);
        errors.drain(..session.lead_in.min(errors.len()));
        let start = not_settled.saturating_sub(session.lead_in);
        // A voltage that never swings far has no other part.
        let start = if start < errors.len() { start } else { 0 };
        let settled = &errors[start..];
        let constant = settled.iter().sum::<f64>() / settled.len().max(1) as f64;
        errors.iter_mut().for_each(|error| *error -= constant);
        Self { errors, start }
    }

    /// The start, and what follows.
    pub fn blocks(&self) -> [&[f64]; 2] {
        let (start, settled) = self.errors.split_at(self.start);
        [start, settled]
    }

    /// √(nₑ/(n·s²)) of every so many readings, by the noise of their block, which is at least `quietest` µm.
    pub fn weights(&self, every: usize, quietest: f64) -> Vec<f64> {
        let weight = |block: &[f64]| {
            let noise = mean_absolute(block).max(quietest);
            (effective(block) / block.len().max(1) as f64 * every as f64 / FRAC_PI_2).sqrt() / noise
        };
        let [start, settled] = self.blocks().map(weight);
        one_of_each(every, self.errors.len())
            .map(|reading| if reading < self.start { start } else { settled })
            .collect()
    }
}

/// Mean size of errors.
pub fn mean_absolute(errors: &[f64]) -> f64 {
    errors.iter().map(|error| error.abs()).sum::<f64>() / errors.len().max(1) as f64
}

/// nₑ of one block. Errors that are still alike after as many readings as can be correlated in a moment are looked at
/// every tenth reading.
pub fn effective(errors: &[f64]) -> f64 {
    let count = errors.len() as f64;
    let variance: f64 = errors.iter().map(|error| error * error).sum();
    if variance <= 0.0 {
        return count;
    }
    let lags = (PRODUCTS / errors.len()).clamp(1, errors.len());
    let mut sum = 0.0;
    for lag in 1..lags {
        let products = errors.iter().zip(&errors[lag..]).map(|(a, b)| a * b);
        let correlation = products.sum::<f64>() / variance;
        if correlation <= 0.0 {
            return count / (1.0 + 2.0 * sum);
        }
        sum += correlation;
    }
    if lags < errors.len() {
        effective(&errors.iter().copied().step_by(THINNED).collect::<Vec<f64>>())
    } else {
        count / (1.0 + 2.0 * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_that_repeat_each_other_count_once() {
        // Independent signs; then each ten times.
        let mut random = 1u32;
        let mut sign = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if random >> 31 == 0 { 1.0 } else { -1.0 }
        };
        let signs: Vec<f64> = (0..2000).map(|_| sign()).collect();
        let repeated: Vec<f64> = signs.iter().flat_map(|&sign| [sign; 10]).collect();
        assert!((1400.0..=2000.0).contains(&effective(&signs)), "{}", effective(&signs));
        assert!((1000.0..=2600.0).contains(&effective(&repeated)), "{}", effective(&repeated));
        assert!(effective(&[1.0; 50]) < 2.0);
        assert_eq!(effective(&[0.0; 5]), 5.0);
        // A drift over a million readings is one, and found in no time.
        let drift: Vec<f64> = (0..1_000_000).map(|n| f64::from(n) - 5e5).collect();
        assert!(effective(&drift) < 10.0);
    }
}
