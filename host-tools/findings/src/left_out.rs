//! How much of what was measured was left out of an identification.

use identification::{Job, Problem};
use recordings::log::Log;
use recordings::prepare::Recipe;
use recordings::session::Session;

/// How many samples at the tick were left out of which log, a sentence each; none without a repair.
pub fn left_out(job: &Job, recipe: &Recipe, problem: &Problem) -> Vec<String> {
    if !job.conditions.repair {
        return Vec::new();
    }
    let said = |(log, (readings, first)): (&Log, (usize, Option<f64>))| {
        // What was prepared once can be again.
        let prepared = recipe.session(&recipe.cut(log)).ok()?;
        let whole = prepared.instants.len();
        let first = prepared.displacement.first().copied() != first;
        let left_out = whole.saturating_sub(readings) + usize::from(first);
        (left_out > 0).then(|| format!("Of {}, {left_out} of {whole} samples were left out (--repair).", log.name))
    };
    // A log of which a part is held out stands behind those that are held out: as a whole where that is its end, which
    // is judged by running through all of it, and else as that part with the first reading.
    let held_out: Vec<&Session> = problem.validation().collect();
    let (of_held_out, wholes) = held_out.split_at(job.held_out.len().min(held_out.len()));
    let readings = |session: &Session| (session.instants.len(), session.displacement.first().copied());
    let mut training: Vec<_> = problem.training().map(readings).collect();
    if wholes.len() == job.training.len() {
        for ((count, _), part) in training.iter_mut().zip(wholes) {
            *count = if part.lead_in > 0 { part.instants.len() } else { *count + part.instants.len() - 1 };
        }
    }
    let logs = job.training.iter().chain(&job.held_out);
    logs.zip(training.into_iter().chain(of_held_out.iter().copied().map(readings))).filter_map(said).collect()
}
