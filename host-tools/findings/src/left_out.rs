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
    let logs = job.training.iter().chain(&job.held_out);
    logs.zip(problem.training().chain(problem.validation())).filter_map(said).collect()
}
