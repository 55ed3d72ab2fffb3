//! What came of an identification, for machines.

use identification::Outcome;
use serde::Serialize;
use serde_json::{Value, json};

/// What came of an identification, for machines.
///
/// # Errors
/// A doubt that cannot be written.
pub fn outcome_json(
    outcome: &Outcome,
    verdict: &[String],
    determination: Option<&impl Serialize>,
) -> serde_json::Result<Value> {
    let candidates: Vec<Value> = outcome
        .candidates
        .iter()
        .map(|candidate| {
            json!({
                "model": candidate.table.model(),
                "cost": candidate.fit.minimised.feedback,
                "norm": candidate.fit.minimised.norm,
                "feedback_weight": candidate.fit.minimised.feedback_weight,
                "cost_um": candidate.fit.cost,
                "evaluations": candidate.fit.evaluations,
                "parameters": candidate.table.parameters,
                "training": candidate.training_figures(),
                "held_out": candidate.held_out_figures(),
            })
        })
        .collect();
    let failed: Vec<Value> = outcome
        .failed
        .iter()
        .map(|(model, error)| json!({ "model": model, "reason": crate::sentence(error) }))
        .collect();
    let doubts = outcome.doubts.iter().map(findings::doubt_json).collect::<serde_json::Result<Vec<Value>>>()?;
    Ok(json!({
        "model": outcome.judged().table.model(),
        "reason": findings::reason(&outcome.reason),
        "cross_validation": outcome.reason.cross_validation(),
        "verdict": verdict,
        "determination": determination,
        "candidates": candidates,
        "parameters": outcome.learnt.candidate.table.parameters,
        "interval": outcome.learnt.candidate.table.interval,
        "straight_line": outcome.straight_line,
        "failed": failed,
        "doubts": doubts,
        "recipe": outcome.learnt.context.recipe,
        "logs": outcome.learnt.logs,
    }))
}
