//! What is meant where a request leaves something unsaid.

use estimator_core::Model;
use identification::ModelChoice;

/// The fraction of each log that is held out: half where nothing is stated, and nothing where whole logs
/// are held out.
pub fn hold_out(stated: Option<f64>, whole_logs: bool) -> f64 {
    stated.unwrap_or(if whole_logs { 0.0 } else { 0.5 })
}

/// The model to identify where the actuator's lag is stated: of those that could be chosen only one keeps to a lag, and
/// none must win because it does not.
pub fn model(asked: ModelChoice, lag_s: Option<f64>) -> ModelChoice {
    match (asked, lag_s) {
        (ModelChoice::Auto, Some(_)) => ModelChoice::Is(Model::GeneralisedPrandtlIshlinskii),
        (asked, _) => asked,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_is_held_out_unless_something_else_is_said() {
        assert_eq!([hold_out(None, false), hold_out(None, true), hold_out(Some(0.1), true)], [0.5, 0.0, 0.1]);
    }

    #[test]
    fn a_lag_leaves_one_model_to_choose_and_takes_nothing_from_who_names_one() {
        let keeps = ModelChoice::Is(Model::GeneralisedPrandtlIshlinskii);
        assert_eq!(model(ModelChoice::Auto, Some(1e-3)), keeps);
        assert_eq!(model(ModelChoice::Auto, None), ModelChoice::Auto);
        assert_eq!(model(ModelChoice::Is(Model::BoucWen), Some(1e-3)), ModelChoice::Is(Model::BoucWen));
    }
}
