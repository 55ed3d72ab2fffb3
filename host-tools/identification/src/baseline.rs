//! The errors of the straight line that every model is to better.

use crate::problem::Problem;
use crate::validate::{Figures, StraightLine};
use recordings::session::Session;
use serde::Serialize;

/// Errors of the straight line through a problem's training sessions.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Baseline {
    /// Slope of the line, µm/V.
    pub gain_um_per_v: f64,
    /// Displacement at 0 V, µm.
    pub offset_um: f64,
    /// Over all that it was fitted to.
    pub training: Figures,
    /// Over all that was held out; `None` where nothing was.
    pub held_out: Option<Figures>,
}

impl Baseline {
    /// Of a problem; `None` where its training voltage does not move.
    pub fn of(problem: &Problem) -> Option<Self> {
        let line = StraightLine::fit(problem.training())?;
        let over = |sessions: &mut dyn Iterator<Item = &Session>| {
            let errors: Vec<Figures> = sessions.map(|session| line.errors(session)).collect();
            Figures::all(errors.iter())
        };
        Some(Self {
            gain_um_per_v: line.gain_um_per_v,
            offset_um: line.offset_um(),
            training: over(&mut problem.training())?,
            held_out: over(&mut problem.validation()),
        })
    }
}
