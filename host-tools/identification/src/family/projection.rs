//! The least squares inside the search.

use crate::problem::Problem;
use estimator_core::Real;
use estimator_core::model::{Lagged, Linear};
use least_squares::{Normal, Sign, Waiting};
use log_survey::settled::settled;
use recordings::session::Session;

/// What is solved for besides the model.
pub struct Projection<'a, M, L = f64> {
    /// The training sessions.
    pub problem: &'a Problem,
    /// With any weights, behind the lag that it will stand behind; its last column is the constant one.
    pub model: &'a Lagged<f64, M, L>,
    /// For each column but the last the unknown it belongs to; columns of one unknown are added up.
    pub unknowns: &'a [usize],
    /// The signs of the unknowns.
    pub signs: &'a [Sign],
}

/// A ridge that is nothing but for columns that are alike.
const RIDGE: f64 = 1e-6;

impl<M: Linear<f64>, L: Real> Projection<'_, M, L> {
    /// The unknowns with which the sum comes nearest to the sensor, `target` of it, in the sum of squares, and the
    /// constant. Each session weighs the same and has a constant of its own, for drift and for where it started, of
    /// which the mean is returned; what a session's unknown start has left its mark on is left out.
    pub fn solve(&self, target: impl Fn(f64) -> f64) -> Option<(Vec<f64>, f64)> {
        let sessions = self.problem.training().count();
        let count = self.signs.len();
        let mut normal = Normal::new(count + sessions);
        for (number, session) in self.problem.training().enumerate() {
            self.add(&mut normal, session, count + number, &target);
        }
        let mut signs = self.signs.to_vec();
        signs.resize(count + sessions, Sign::Free);
        let mut found = normal.ridge(RIDGE).solve(&signs)?;
        let constants = found.split_off(count);
        Some((found, constants.iter().sum::<f64>() / constants.len().max(1) as f64))
    }

    fn add(&self, normal: &mut Normal, session: &Session, constant: usize, target: &impl Fn(f64) -> f64) {
        let Some(&first) = session.voltage.first() else { return };
        let from = settled(session);
        let weight = 1.0 / (session.instants.len() - from).max(1) as f64;
        let (model, look_ahead) = (self.model.model(), self.model.look_ahead());
        let (mut input, mut state) = (self.model.at_rest(first), model.begin(first, None));
        let mut row = vec![0.0; normal.columns()];
        let mut before = row.clone();
        let (mut tick, mut waiting) = (0, Waiting::of_weight(weight));
        for (index, (&instant, &measured)) in session.instants.iter().zip(&session.displacement).enumerate() {
            while tick < instant as usize {
                if look_ahead.is_some() && tick + 1 == instant as usize {
                    self.fill(&state, &mut before);
                }
                let voltage = self.model.input(&mut input, session.voltage[tick]);
                model.advance(&mut state, voltage);
                tick += 1;
            }
            if index < from.max(1) {
                continue;
            }
            self.fill(&state, &mut row);
            for (now, &before) in row.iter_mut().zip(&before) {
                *now = look_ahead.of(*now, before);
            }
            row.iter_mut().skip(constant).take(1).for_each(|one| *one = 1.0);
            waiting.add(normal, &row, target(measured));
        }
        waiting.finish(normal);
    }

    /// The unknowns' columns; the constants are left 0.
    fn fill(&self, state: &M::State, row: &mut [f64]) {
        row.fill(0.0);
        let mut unknowns = self.unknowns.iter();
        self.model.model().columns(state, |column| {
            // The constant column has no unknown.
            if let Some(sum) = unknowns.next().and_then(|&unknown| row.get_mut(unknown)) {
                *sum += column;
            }
        });
    }
}
