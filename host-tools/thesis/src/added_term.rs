//! Extremum terms added to an identified model, behind a first-order lag: `w·(x(n − 1) − mean of x)`, their weights by
//! least squares on what the model leaves of the modelling logs.

use estimator_core::model::{Lag, Relaxed};
use estimator_core::{Admitted, Estimator, Tracker};
use least_squares::{Normal, Sign};
use recordings::session::Session;

/// First-order lags that a term may be behind, s.
pub const LAGS: [f64; 6] = [0.0, 1e-3, 3e-3, 0.01, 0.03, 0.1];

/// A model's run over a session.
pub struct Observed {
    /// Measured less estimated at the measured instants after the first, µm.
    residual: Vec<f64>,
    /// V_ext (V) and y_ext (µm) of the tick before each of these instants, behind each of [`LAGS`].
    terms: [[Vec<f64>; 2]; LAGS.len()],
}

impl Observed {
    /// Runs a table over a session.
    pub fn new(table: &Admitted, session: &Session) -> Self {
        let mut estimator = Estimator::<f64>::new(table);
        let mut displacement = session.displacement.first().copied().unwrap_or(0.0);
        estimator.start_at(displacement);
        let mut tracker = Tracker::new(f64::from(table.retreat_v()));
        let mut behind = LAGS.map(|lag| (Lag::build(lag, session.tick_s), [Relaxed::at(0.0); 2]));
        let (mut residual, mut terms) = (Vec::new(), LAGS.map(|_| [Vec::new(), Vec::new()]));
        let mut measured = session.instants.iter().zip(&session.displacement).skip(1).peekable();
        for (tick, &voltage) in (1..).zip(&session.voltage) {
            tracker.update(voltage, displacement);
            displacement = estimator.tick_volts(voltage + f64::from(table.voltage_zero_v)).displacement;
            let last = tracker.last();
            for (lag, states) in &mut behind {
                lag.step(&mut states[0], last.voltage);
                lag.step(&mut states[1], last.displacement);
            }
            if let Some((_, value)) = measured.next_if(|(instant, _)| **instant == tick) {
                residual.push(value - displacement);
                for (columns, (_, states)) in terms.iter_mut().zip(&behind) {
                    columns.iter_mut().zip(states).for_each(|(column, state)| column.push(state.value));
                }
            }
        }
        Self { residual, terms }
    }
}

/// Terms with their weights and the means that are taken off them.
pub struct Term<'a> {
    which: &'a [usize],
    /// Index into [`LAGS`].
    pub lag: usize,
    weights: Vec<f64>,
    means: Vec<f64>,
}

impl<'a> Term<'a> {
    /// By least squares, behind the lag that leaves least; `None` where no lag has a solution.
    pub fn fit(which: &'a [usize], training: &[Observed]) -> Option<Self> {
        let fits = (0..LAGS.len()).filter_map(|lag| Self::behind(which, lag, training));
        fits.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(term, _)| term)
    }

    /// Behind one lag, and the sum of squares that it leaves.
    fn behind(which: &'a [usize], lag: usize, training: &[Observed]) -> Option<(Self, f64)> {
        let mut normal = Normal::new(which.len() + 1);
        let mut means = vec![0.0; which.len()];
        for observed in training {
            let weight = 1.0 / observed.residual.len().max(1) as f64;
            for (index, &residual) in observed.residual.iter().enumerate() {
                let mut row: Vec<f64> = columns(which, lag, observed, index).collect();
                for (mean, x) in means.iter_mut().zip(&row) {
                    *mean += x * weight / training.len() as f64;
                }
                // The constant is not used: what is taken off the columns is their mean.
                row.push(1.0);
                normal.add(&row, residual, weight);
            }
        }
        let mut weights = normal.solve(&vec![Sign::Free; which.len() + 1])?;
        let left = normal.residual_sum(&weights);
        weights.truncate(which.len());
        Some((Self { which, lag, weights, means }, left))
    }

    /// Mean absolute error with the term, each session weighing the same, µm.
    pub fn error(&self, sessions: &[Observed]) -> f64 {
        mean_error(sessions, |observed, index| {
            let columns = columns(self.which, self.lag, observed, index);
            columns.zip(&self.means).zip(&self.weights).map(|((x, mean), weight)| weight * (x - mean)).sum()
        })
    }
}

/// The terms' values at an instant.
fn columns<'a>(which: &'a [usize], lag: usize, observed: &'a Observed, index: usize) -> impl Iterator<Item = f64> + 'a {
    which.iter().map(move |&term| observed.terms[lag][term][index])
}

/// Mean absolute residual less a correction, each session weighing the same, µm.
pub fn mean_error(sessions: &[Observed], correction: impl Fn(&Observed, usize) -> f64) -> f64 {
    let of = |observed: &Observed| {
        let errors =
            observed.residual.iter().enumerate().map(|(index, residual)| residual - correction(observed, index));
        errors.map(f64::abs).sum::<f64>() / observed.residual.len().max(1) as f64
    };
    sessions.iter().map(of).sum::<f64>() / sessions.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;
    use estimator_core::Model;
    use identification::cost::Feedback;

    /// A residual that is 0.1 of V_ext behind 10 ms and a constant: the weight and the lag are found, and
    /// the constant stays.
    #[test]
    fn a_term_that_is_there_is_found_with_its_weight_and_lag() {
        let mut bench = small();
        bench.identify(Feedback::Simulation, &[Model::PrandtlIshlinskii], &mut |_, _| ());
        let table = bench.candidate(Feedback::Simulation, Model::PrandtlIshlinskii).unwrap().table;
        let mut training: Vec<Observed> =
            bench.problem().training().map(|session| Observed::new(&table, session)).collect();
        for observed in &mut training {
            observed.residual = observed.terms[3][0].iter().map(|x| 0.1 * x + 0.5).collect();
        }
        let term = Term::fit(&[0], &training).unwrap();
        assert!(LAGS[term.lag] == 0.01 && (term.weights[0] - 0.1).abs() < 1e-6, "{} {:?}", term.lag, term.weights);
        let constant = 0.5 + 0.1 * term.means[0];
        assert!((term.error(&training) - constant.abs()).abs() < 1e-6);
    }
}
