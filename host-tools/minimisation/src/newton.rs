//! Newton's steps within the cube on a quadratic model of the cost, damped as Levenberg and Marquardt do.
//!
//! ```text
//! c(x + d) ≈ c(x) + s·d + d·(C·d)/2      s slope, C curvature, positive semidefinite
//! (C + λ·diag C)·d = −s                  within the cube: a coordinate that would leave it stays at its face, the others are solved again
//! ```
//!
//! It finds the minimum next to where it begins. Of a sum of squares whose curvature is that of Gauss and Newton it
//! takes few steps.

use super::state::{Minimum, Quadratic, Quadratics, Search};
use nalgebra::{DMatrix, DVector};

/// The first damping λ.
const DAMPING: f64 = 1e-3;
/// What it is multiplied by after a step that helps.
const EASED: f64 = 0.2;
/// And after one that does not.
const RAISED: f64 = 8.0;
/// No step helps where one that is damped so much does not.
const MOST: f64 = 1e4;
/// Every coordinate is damped by at least this part of the largest curvature, even one that has none.
const FLAT: f64 = 1e-6;
/// No coordinate goes further in a step, of the cube's edge: the model is one of the neighbourhood.
const REACH: f64 = 0.25;
/// A decrease that is worth a step, as a fraction of the cost.
const WORTHWHILE: f64 = 1e-4;

/// Steps from the best point until none is worth while, or the budget is spent. A quadratic model counts for as many
/// evaluations as there are coordinates. False where it has not begun: without a model at the first point, with an
/// infinite cost there, or too little left of the budget.
pub fn descend(search: &mut Search<'_>, quadratic: Quadratics<'_>) -> bool {
    let mut damping = DAMPING;
    let mut any = false;
    while search.best.cost.is_finite() && search.left() > search.dimension {
        let Minimum { at, cost, .. } = search.best.clone();
        let Some(model) = quadratic(&at) else { return any };
        any = true;
        search.note(search.dimension, &[]);
        while search.best.cost == cost {
            match step(&model, &at, damping) {
                _ if search.left() == 0 || damping > MOST => return true,
                Some(step) if step.gain > WORTHWHILE * cost => drop(search.evaluate(vec![step.to])),
                Some(step) if !step.cut_short => return true,
                // What is cut short may lead uphill though the way is down, and a model may have no answer: shorter.
                _ => {}
            }
            damping *= if search.best.cost < cost { EASED } else { RAISED };
        }
        if search.best.cost > (1.0 - WORTHWHILE) * cost {
            return true;
        }
    }
    any
}

/// A damped step.
struct Step {
    /// The point that the step leads to.
    to: Vec<f64>,
    /// What the model says that it gains.
    gain: f64,
    /// A coordinate would have gone further.
    cut_short: bool,
}

/// The step from a point of the cube; `None` where the model has none.
fn step(model: &Quadratic, at: &[f64], damping: f64) -> Option<Step> {
    let diagonal = model.curvature.diagonal();
    let least = FLAT * diagonal.max();
    let damped = &model.curvature + DMatrix::from_diagonal(&diagonal.map(|own| damping * own + least));
    let limited = |i: usize, x: f64| x.clamp((at[i] - REACH).max(0.0) - at[i], (at[i] + REACH).min(1.0) - at[i]);
    let mut step = DVector::zeros(at.len());
    let mut free: Vec<usize> = (0..at.len()).collect();
    let mut cut_short = false;
    // Each turn but the last takes at least one coordinate out.
    while !free.is_empty() {
        let slope = (&model.slope + &damped * &step).select_rows(&free);
        let solved = damped.select_rows(&free).select_columns(&free).cholesky()?.solve(&-slope);
        let (outside, inside): (Vec<_>, Vec<_>) =
            free.iter().copied().zip(solved.iter().copied()).partition(|&(i, x)| limited(i, x) != x);
        cut_short |= !outside.is_empty();
        let (settled, rest) = if outside.is_empty() { (inside, Vec::new()) } else { (outside, inside) };
        settled.into_iter().for_each(|(i, x)| step[i] = limited(i, x));
        free = rest.into_iter().map(|(i, _)| i).collect();
    }
    let gain = -(model.slope.dot(&step) + 0.5 * step.dot(&(&model.curvature * &step)));
    let to = at.iter().zip(&step).map(|(x, by)| (x + by).clamp(0.0, 1.0)).collect();
    Some(Step { to, gain, cut_short })
}

#[cfg(test)]
mod tests {
    use crate::{Budget, Minimum, Objective, Optimiser, Quadratic, each, minimise};
    use nalgebra::{DMatrix, DVector};

    /// Errors whose squares are minimised, bent so that one step does not suffice; least at (0.7, 0.2) and, in the
    /// third, beyond the cube.
    fn errors(at: &[f64]) -> [f64; 3] {
        let (x, y, z) = (at[0] - 0.7, at[1] - 0.2, at[2] - 1.3);
        [x + 10.0 * y + 3.0 * x * x, y - 0.5 * x, 0.1 * z]
    }

    fn cost(at: &[f64]) -> f64 {
        0.5 * errors(at).iter().map(|error| error * error).sum::<f64>()
    }

    /// By Gauss and Newton.
    fn quadratic(at: &[f64]) -> Option<Quadratic> {
        let x = at[0] - 0.7;
        let jacobian = DMatrix::from_row_slice(3, 3, &[1.0 + 6.0 * x, 10.0, 0.0, -0.5, 1.0, 0.0, 0.0, 0.0, 0.1]);
        let errors = DVector::from_column_slice(&errors(at));
        Some(Quadratic { slope: jacobian.tr_mul(&errors), curvature: jacobian.tr_mul(&jacobian) })
    }

    fn minimised(quadratic: &(dyn Fn(&[f64]) -> Option<Quadratic> + Sync), evaluations: usize) -> Minimum {
        let costs = each(cost);
        let objective = Objective { costs: &costs, quadratic };
        minimise(Optimiser::Local, 3, Budget { evaluations, seed: 1 }, &[vec![0.1; 3]], objective, &mut |_, _| ())
    }

    #[test]
    fn few_steps_lead_to_a_minimum_at_a_face_of_the_cube() {
        let Minimum { at, .. } = minimised(&quadratic, 80);
        assert!((at[0] - 0.7).abs() < 1e-2 && (at[1] - 0.2).abs() < 1e-2 && at[2] == 1.0, "{at:?}");
    }

    /// A valley across both coordinates: a step that is cut short in both leads uphill.
    #[test]
    fn a_step_that_is_cut_short_and_leads_uphill_is_damped() {
        let curvature = DMatrix::from_row_slice(2, 2, &[1.0, 4.9, 4.9, 25.0]);
        let slope = |at: &[f64]| &curvature * DVector::from_column_slice(&[at[0] - 1.7, at[1] - 0.2]);
        let cost = |at: &[f64]| 1.0 + 0.5 * DVector::from_column_slice(&[at[0] - 1.7, at[1] - 0.2]).dot(&slope(at));
        let quadratic = |at: &[f64]| Some(Quadratic { slope: slope(at), curvature: curvature.clone() });
        let costs = each(cost);
        let objective = Objective { costs: &costs, quadratic: &quadratic };
        let budget = Budget { evaluations: 60, seed: 1 };
        let found = minimise(Optimiser::Local, 2, budget, &[vec![0.3, 0.9]], objective, &mut |_, _| ());
        // At the face x = 1: y where the slope along it is 0.
        assert!((found.at[0] - 1.0).abs() < 1e-3 && (found.at[1] - 0.3372).abs() < 2e-2, "{found:?}");
    }

    #[test]
    fn a_budget_ends_them_and_a_cost_without_a_model_is_descended_by_a_simplex() {
        for evaluations in [0, 1, 3, 4, 5, 9] {
            assert!(minimised(&quadratic, evaluations).evaluations <= evaluations);
        }
        let Minimum { at, .. } = minimised(&|_| None, 600);
        assert!((at[0] - 0.7).abs() < 1e-2 && (at[1] - 0.2).abs() < 1e-2, "{at:?}");
    }

    #[test]
    fn a_model_that_is_wrong_or_no_number_ends_the_descent_where_it_began_or_better() {
        let uphill = |at: &[f64]| quadratic(at).map(|model| Quadratic { slope: -model.slope, ..model });
        let nan = |at: &[f64]| quadratic(at).map(|model| Quadratic { curvature: f64::NAN * model.curvature, ..model });
        for wrong in [&uphill as &(dyn Fn(&[f64]) -> Option<Quadratic> + Sync), &nan] {
            assert!(minimised(wrong, 200).cost <= cost(&[0.1; 3]));
        }
    }
}
