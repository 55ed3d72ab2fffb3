//! An identified model made into an admitted table, and run over every session.

use super::fit::Fit;
use super::problem::Problem;
use crate::validate::{Comparison, Figures, compare};
use estimator_core::Admitted;

/// An identified model with its table and its errors.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// How it was found.
    pub fit: Fit,
    /// The table it makes.
    pub table: Admitted,
    /// Its simulation errors on what it was fitted to, a log at a time.
    pub training: Vec<Comparison>,
    /// Its simulation errors on what was held out; empty where nothing was.
    pub held_out: Vec<Comparison>,
}

impl Candidate {
    /// Runs a table over the sessions of its problem.
    pub fn new(problem: &Problem, fit: Fit, table: Admitted) -> Self {
        Self {
            training: problem.training().map(|session| compare(&table, session)).collect(),
            held_out: problem.validation().map(|session| compare(&table, session)).collect(),
            fit,
            table,
        }
    }

    /// Reference errors over all training logs.
    pub fn training_figures(&self) -> Option<Figures> {
        Figures::all(self.training.iter().map(|comparison| &comparison.mil))
    }

    /// Reference errors over all that was held out.
    pub fn held_out_figures(&self) -> Option<Figures> {
        Figures::all(self.held_out.iter().map(|comparison| &comparison.mil))
    }
}
