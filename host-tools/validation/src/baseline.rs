//! The errors of the straight line that every model is to better.

use crate::figures::Figures;
use crate::straight_line::StraightLine;
use recordings::session::Session;
use serde::Serialize;

/// Errors of the straight line through training sessions.
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
    /// Of sessions that it is fitted to and others that were held out; `None` where the training voltage does not move.
    pub fn of<'a>(
        training: impl Iterator<Item = &'a Session> + Clone,
        held_out: impl Iterator<Item = &'a Session>,
    ) -> Option<Self> {
        let line = StraightLine::fit(training.clone())?;
        let over = |sessions: &mut dyn Iterator<Item = &'a Session>| {
            let errors: Vec<Figures> = sessions.map(|session| line.errors(session)).collect();
            Figures::all(errors.iter())
        };
        Some(Self {
            gain_um_per_v: line.gain_um_per_v,
            offset_um: line.offset_um(),
            training: over(&mut training.clone())?,
            held_out: over(&mut { held_out }),
        })
    }
}
