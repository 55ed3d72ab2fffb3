//! How late the displacement is behind the voltage, and whether the logs tell a delay from a lag.

use super::candidate::{Extra, Family};
use crate::cost::Feedback;
use crate::family::Family as _;
use crate::problem::Problem;
use crate::search::{Budget, Objective, Optimiser, Quadratic, each, minimise};
use play_columns::Course;

/// Candidates for each number that is searched.
const CANDIDATES: usize = 20;
/// A delay that makes the errors smaller by no more than this part of them than a lag alone is not told from it.
const TOLD: f64 = 0.03;

/// How late a displacement is, by the generalised model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Late {
    /// The delay, ticks.
    pub delay_ticks: f64,
    /// The first-order lag behind it, ticks.
    pub lag_ticks: f64,
    /// It is a delay: a lag alone makes the errors larger.
    pub delayed: bool,
}

impl Late {
    /// Of a problem's training; `None` where there is no solution.
    pub fn of(problem: &Problem, seed: u32) -> Option<Self> {
        let family = Family::new(Extra::Nothing, Course::of_all(problem.training(), problem.deadband).into(), problem);
        let (free, cost) = least(&family, problem, &[], seed)?;
        let (_, without_delay) = least(&family, problem, &[0.0], seed)?;
        let [delay_ticks, lag_ticks] = [free[0], free[1]];
        Some(Self { delay_ticks, lag_ticks, delayed: without_delay > (1.0 + TOLD) * cost })
    }
}

/// The values that cost least, and the cost, where the first coordinates are these.
fn least(family: &Family, problem: &Problem, first: &[f64], seed: u32) -> Option<(Vec<f64>, f64)> {
    let (genes, given) = (family.genes(), first.len());
    let whole = |at: &[f64]| [first, at].concat();
    let values = |at: &[f64]| -> Vec<f64> { genes.iter().zip(whole(at)).map(|(gene, x)| gene.value(x)).collect() };
    let cost = |at: &[f64]| {
        let candidate = family.candidate(&values(at), problem, Feedback::Simulation.into());
        candidate.map_or(f64::INFINITY, |(_, cost)| cost)
    };
    let quadratic = |at: &[f64]| {
        let Quadratic { slope, curvature } = family.quadratic(&whole(at), problem)?;
        Some(Quadratic {
            slope: slope.remove_rows(0, given),
            curvature: curvature.remove_rows(0, given).remove_columns(0, given),
        })
    };
    let starts: Vec<Vec<f64>> = family.starts().into_iter().map(|start| start[given..].to_vec()).collect();
    let searched = genes.len() - given;
    let budget = Budget { evaluations: CANDIDATES * searched, seed: seed.into() };
    let costs = each(cost);
    let objective = Objective { costs: &costs, quadratic: &quadratic };
    let found = minimise(Optimiser::Local, searched, budget, &starts, objective, &mut |_, _| ());
    found.cost.is_finite().then(|| (values(&found.at), found.cost))
}
