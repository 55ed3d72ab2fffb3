//! Learning a subject with models, and judging what came of it.

use super::bootstrap::blocks;
use super::subject::{Subject, Trial};
use crate::error::ThesisError;
use estimator_core::Model;
use identification::validate::{
    Comparison, Coverage, Estimates, Instant, Scope, Told, ToldFigures, compare_within, errors_within, estimates,
};
use identification::{Candidate, Identification, Prepared, StraightLine, prepared};
use log_survey::noise_of;
use prediction_interval::{DEVICES, calibrate};
use recordings::session::Session;

/// A search of fewer candidates a number has its interval from fewer devices: one for each so many.
const OF_A_DEVICE: u32 = 20;
/// The model that a user gets, whose estimate has an interval beside it.
const BESIDE: Model = Model::GeneralisedPrandtlIshlinskii;

/// A model on a recording.
pub struct Judged {
    /// As the tables call what the device belongs to.
    pub subject: &'static str,
    /// What tells the device from others.
    pub device: String,
    /// As the tables call the recording.
    pub condition: &'static str,
    /// Which model; `None` is the straight line.
    pub model: Option<Model>,
    /// Noise floor of the sensor, µm rms.
    pub noise_floor_um: Option<f64>,
    /// Its errors; `None` where no admissible candidate was found.
    pub errors: Option<Errors>,
}

/// Errors on a recording.
pub struct Errors {
    /// By what was told.
    pub told: ToldFigures,
    /// How the interval of the estimate did, of a model that has one.
    pub interval: Option<Coverage>,
    /// The same once it was told one cycle.
    pub interval_one_cycle: Option<Coverage>,
    /// MAE of blocks of what is scored, without the mean error, µm.
    pub blocks: Vec<f64>,
}

/// Learns each of these models and the straight line, and judges each on every trial.
///
/// # Errors
/// A recording cannot be prepared or scored. A model that finds nothing is judged with no errors.
pub fn learn(subject: &Subject, models: &[Model]) -> Result<Vec<Judged>, ThesisError> {
    let Prepared { problem, context, .. } = subject.job.prepare()?;
    let identification =
        Identification { problem: &problem, cost: subject.job.cost, options: &subject.job.search, budget: None };
    let fits = identification.brief(models, &mut |_, _| ());
    let line = StraightLine::fit(problem.training());
    let mut judged = Vec::new();
    let trials: Vec<(&Trial, Session)> = subject
        .trials
        .iter()
        .map(|trial| {
            let cut = context.recipe.cut(&trial.log);
            Ok((trial, prepared(&context.recipe, &cut)?))
        })
        .collect::<Result<_, ThesisError>>()?;
    let of = |trial: &Trial, model, errors| Judged {
        subject: subject.name,
        device: subject.device.clone(),
        condition: trial.condition,
        model,
        noise_floor_um: trial.log.displacement.as_deref().and_then(noise_of),
        errors,
    };
    for fit in fits {
        let model = fit.model;
        let candidate = Candidate::new(&problem, fit, &context).and_then(|candidate| match model {
            BESIDE => {
                let search = &subject.job.search;
                let devices = DEVICES.min(search.evaluations / OF_A_DEVICE).max(1);
                let as_learnt = prediction_interval::Judged { problem: &problem, candidate: &candidate };
                let interval = calibrate(&problem, &candidate, as_learnt, &context, search, devices, || ());
                candidate.with_interval(interval.map(|of| of.parameters))
            }
            _ => Ok(candidate),
        });
        let candidate = candidate.ok();
        for (trial, session) in &trials {
            let errors = candidate.as_ref().map(|candidate| -> Result<Errors, ThesisError> {
                let Comparison { told, interval, interval_one_cycle, .. } =
                    compare_within(&candidate.table, session, &trial.scope)?;
                let estimates = estimates(&candidate.table, session, &context.recipe, &trial.scope, Told::Offset)?;
                Ok(Errors { told, interval, interval_one_cycle, blocks: blocks(&scored(&estimates)) })
            });
            judged.push(of(trial, Some(model), errors.transpose()?));
        }
    }
    for (trial, session) in &trials {
        let errors = line.map(|line| of_line(line, session, &trial.scope)).transpose()?;
        judged.push(of(trial, None, errors));
    }
    Ok(judged)
}

/// Estimate − sensor where it counts, µm.
fn scored(estimates: &Estimates) -> Vec<f64> {
    let counts = estimates.instants.iter().filter(|instant| instant.scored);
    counts.filter_map(Instant::error).collect()
}

/// The straight line, which knows the voltage of the tick before as every model does.
fn of_line(line: StraightLine, session: &Session, scope: &Scope) -> Result<Errors, ThesisError> {
    let at = |instant: u32| line.displacement(session.voltage[instant as usize]);
    let estimated: Vec<f64> = session.instants.iter().skip(1).map(|&instant| at(instant - 1)).collect();
    let told = ToldFigures::of_estimates(session, scope, at(0), &estimated)?;
    let errors = errors_within(session, scope, &estimated)?;
    let mean = errors.iter().sum::<f64>() / errors.len().max(1) as f64;
    let blocks = blocks(&errors.iter().map(|error| error - mean).collect::<Vec<_>>());
    Ok(Errors { told, interval: None, interval_one_cycle: None, blocks })
}
