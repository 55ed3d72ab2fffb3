//! A job's logs, ready to be identified on.

use crate::candidate::TableContext;
use crate::doubt::Doubt;
use crate::job_error::JobError;
use crate::problem::Problem;
use log_survey::{Character, is_noise, range};
use recordings::LogUse;

/// What every model of a job is identified on and made into a table with.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The sessions, cut, divided and prepared.
    pub problem: Problem,
    /// What a table holds besides what is identified; zeros and delay, decided from the training logs alone (with the
    /// stretches of them that are held out), in its recipe.
    pub context: TableContext,
    /// What each log was used for.
    pub logs: Vec<LogUse>,
    /// Doubts of the logs: those that are no sensor's, and what in the others is no measurement.
    pub of_logs: Vec<Doubt>,
    /// A doubt of the delay that was looked for.
    pub of_delay: Option<Doubt>,
}

impl Prepared {
    /// Refuses logs in which there is no hysteresis to learn.
    ///
    /// # Errors
    /// The displacement of every training log is noise, or the voltage reverses in none, or by less than the deadband.
    pub fn teaches(&self) -> Result<(), JobError> {
        let Some(first) = self.problem.training().next() else { return Ok(()) };
        if self.problem.training().all(is_noise) {
            return Err(JobError::Noise { log: first.name.clone(), span_um: range(&first.displacement) });
        }
        let deadband_v = self.problem.deadband;
        let swings = deadband_v < self.problem.training_voltages().span();
        if !swings || Character::of(self.problem.training(), deadband_v).reversals == 0 {
            return Err(JobError::NoReversal { log: first.name.clone(), deadband_v });
        }
        Ok(())
    }
}
