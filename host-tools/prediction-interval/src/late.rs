//! What the logs leave open of how late the actuator is.
//!
//! Voltages of a single frequency do not tell a lag from the width of a loop: a model that is later, with narrower
//! loops, fits them as well, and is off at other frequencies. So the model is learnt again with later and later
//! actuators, until the logs speak against that.

use crate::again::again;
use estimator_core::{Parameters, Range};
use identification::{Candidate, Problem, SearchOptions, TableContext};

/// A cost so many times the least speaks against a lag. By noise alone a tenth more would, as a cost is a deviation of
/// a log worth 20 independent periods; but what a model is off by is no noise, and goes with the lag: of simulated
/// devices learnt from one sine, the lag that they had cost up to four tenths more.
const AGAINST: f64 = 1.5;
/// From one lag that is tried to the next, and from what was found to the nearest end of what is open at least.
const STEP: f64 = 2.0;
/// Nothing is tried beyond this, s.
const LATEST_S: f64 = 0.1;
/// No amplifier is faster than this, s.
const LEAST_S: f64 = 1e-4;
/// How near the lag that is asked for the search ends, of that, unless the logs hold it elsewhere.
const KEPT: f64 = 0.2;

/// The lags and delays together that the logs do not speak against, s.
pub fn open(problem: &Problem, candidate: &Candidate, context: &TableContext, search: &SearchOptions) -> Range<f64> {
    let found = candidate.late_s().max(LEAST_S);
    let around = Range { min: (found / STEP).max(LEAST_S), max: STEP * found };
    let has_prior = matches!(candidate.table.parameters, Parameters::GeneralisedPrandtlIshlinskii(_));
    // What was said is known; without a prior, none can be asked for.
    if problem.lag_s.is_some() || !has_prior {
        return around;
    }
    let (mut said, mut from) = (problem.clone(), candidate.clone());
    // Within a tick a delay and a lag are the same to the logs.
    let mut latest = around.max.max(STEP * problem.extent().tick);
    let mut before = (found, 0.0);
    while latest <= LATEST_S {
        said.lag_s = Some(latest);
        let Ok(later) = again(&said, &from, context, search) else { break };
        let kept = (later.late_s() - latest).abs() < KEPT * latest;
        let against = libm::log(later.fit.cost / candidate.fit.cost) / libm::log(AGAINST);
        if !kept || against > 1.0 {
            let part = if kept { (1.0 - before.1) / (against - before.1) } else { 0.0 };
            return Range { max: (before.0 * libm::pow(latest / before.0, part)).max(around.max), ..around };
        }
        (from, before) = (later, (latest, against));
        latest *= STEP;
    }
    Range { max: before.0.max(around.max), ..around }
}
