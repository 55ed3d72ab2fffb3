//! A constant delay of the sensor, estimated from the training logs.
//!
//! It is the delay that the generalised Prandtl–Ishlinskii model finds, in whole ticks, where a lag alone does not do
//! as well. At a single frequency one does what the other does: then none is taken, and what the model's lag comes to
//! is said. A delay beyond what the model looks for is found by looking again from there.

use crate::doubt::Doubt;
use crate::family::{LONGEST_DELAY, Late};
use crate::problem::{Conditions, Problem};
use log_survey::{Flaw, measured};
use recordings::log::Log;
use recordings::prepare::{PrepareError, PrepareOptions, Recipe};

/// A sensor's delay as it was estimated.
#[derive(Clone, PartialEq, Debug)]
pub struct Delay {
    /// The delay in whole ticks.
    pub ticks: u32,
    /// What is doubtful of it.
    pub doubt: Option<Doubt>,
}

/// What is left of a tick that is no more than this counts as a whole one.
const ROUNDED: f64 = 0.25;
/// A displacement that is later than this, ticks, is late.
const LATE: f64 = 1.5;

/// The delay of training logs that were cut; `flaws` of each are left out.
///
/// # Errors
/// A log cannot be brought to the tick.
pub fn estimate(
    training: &[Log],
    flaws: &[Vec<Flaw>],
    recipe: &Recipe,
    prepare: &PrepareOptions,
    conditions: Conditions,
    seed: u32,
) -> Result<Delay, PrepareError> {
    let tick_ms = recipe.tick_s() * 1e3;
    // What is said of the lag is said beside the sensor's delay.
    let conditions = Conditions { lag_s: None, ..conditions };
    let largest = (prepare.max_delay / tick_ms).round() as u32;
    let mut ticks = 0;
    loop {
        let recipe = Recipe { delay_ticks: ticks, ..recipe.clone() };
        let sessions = training.iter().zip(flaws).map(|(log, flaws)| Ok(measured(&recipe, log, flaws)?.0));
        let problem = Problem::new(sessions.collect::<Result<_, _>>()?, Vec::new(), conditions);
        let Some(late) = Late::of(&problem, seed) else { return Ok(Delay { ticks, doubt: None }) };
        if !late.delayed {
            let late_ticks = late.delay_ticks + late.lag_ticks;
            let undetermined = || Doubt::DelayUndetermined { late_ms: late_ticks * tick_ms };
            return Ok(Delay { ticks, doubt: (ticks == 0 && late_ticks > LATE).then(undetermined) });
        }
        ticks += (late.delay_ticks + ROUNDED) as u32;
        if ticks > largest {
            let at_bound = Doubt::DelayAtBound { delay_ms: f64::from(largest) * tick_ms };
            return Ok(Delay { ticks: largest, doubt: Some(at_bound) });
        }
        if late.delay_ticks < LONGEST_DELAY - 1.0 {
            return Ok(Delay { ticks, doubt: None });
        }
    }
}
