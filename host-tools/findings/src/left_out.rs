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
    let said = |(log, session): (&Log, &Session)| {
        // What was prepared once can be again.
        let prepared = recipe.session(&recipe.cut(log)).ok()?;
        let whole = prepared.instants.len();
        let first = prepared.displacement.first() != session.displacement.first();
        let left_out = whole.saturating_sub(session.instants.len()) + usize::from(first);
        (left_out > 0).then(|| format!("Of {}, {left_out} of {whole} samples were left out (--repair).", log.name))
    };
    // A log of which the end is held out is run through as a whole to judge that: so it stands behind those that
    // are held out.
    let held_out: Vec<&Session> = problem.validation().collect();
    let (of_held_out, wholes) = held_out.split_at(job.held_out.len().min(held_out.len()));
    let training: Vec<&Session> = match wholes.len() == job.training.len() {
        true => wholes.to_vec(),
        false => problem.training().collect(),
    };
    let logs = job.training.iter().chain(&job.held_out);
    logs.zip(training.into_iter().chain(of_held_out.iter().copied())).filter_map(said).collect()
}
