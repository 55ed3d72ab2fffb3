//! What a search minimises.

use super::choice::{Choice, choice};
use super::number::fraction;
use clap::Args;
use identification::cost::{Cost, Feedback, Norm};

/// What is minimised.
#[derive(Args, Clone, Copy, Debug)]
#[command(next_help_heading = "What is minimised, and under which conditions")]
pub struct CostArgs {
    /// Whose error is minimised: one-step prediction's, that of simulation, which is what the estimator does, or,
    /// between the two, that of a simulation which each measurement draws towards itself.
    #[arg(long, hide_short_help = true, value_name = "COST", value_parser = choice(FEEDBACK), default_value = "simulation")]
    pub cost: Feedback,
    /// What the search minimises: mean absolute error or root mean square. What a model is linear in (the weights of
    /// the models beyond the Voigt family) is solved for by least squares in either.
    #[arg(long, hide_short_help = true, value_parser = choice(NORMS), default_value = "l1")]
    pub norm: Norm,
    /// Share of the measurement in `--cost multi-step`, 0 (simulation) to 1 (one-step prediction): errors are forgotten
    /// over some 1/w measured steps. 0.01 where it is not given.
    #[arg(long, hide_short_help = true, value_name = "W", value_parser = fraction, allow_negative_numbers = true)]
    pub feedback_weight: Option<f64>,
}

const FEEDBACK: [Choice<Feedback>; 3] = [
    (
        Feedback::Osp,
        "osp",
        "One-step prediction, Eq. (4.3): each step starts from the measured displacement. In a log slower than the tick \
         one step is one interval of the log",
    ),
    (
        Feedback::Simulation,
        "simulation",
        "Simulation, Eq. (4.4): the model's own displacement, from the first measured sample on",
    ),
    (Feedback::MultiStep, "multi-step", "Simulation that each measurement draws towards itself by a weight"),
];

const NORMS: [Choice<Norm>; 2] =
    [(Norm::L1, "l1", "Mean absolute error, Eq. (4.1)"), (Norm::L2, "l2", "Root mean square error")];

impl From<CostArgs> for Cost {
    fn from(CostArgs { cost, norm, feedback_weight }: CostArgs) -> Self {
        Self { feedback: cost, norm, feedback_weight }
    }
}
