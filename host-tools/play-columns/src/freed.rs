//! The weights of the plays and the gains of the creep, freed from their laws as far as the logs say otherwise; then
//! the plays' [own](crate::own) envelopes.
//!
//! ```text
//! minimise Σ_b c_b⁻¹·mse_b(q, e, a, γ) + d·Σ_i ((a_i − a⁰_i)/s_i)² + Σ_k ((γ_{k+1} − γ_k)/(0.3·mean γ⁰))²/20
//! a⁰_i = exp(−r_i/(ρR))·Δr_i/R,   s_i = max(a⁰_i, 0.3·mean a⁰)        all at least 0; γ⁰ as searched
//! ```
//!
//! by Gauss and Newton, all together: q and e coefficients of the two functions, a weights, γ gains; c_b are the
//! noises of the blocks (see [`Blocks`](crate::Blocks)). The law says how an actuator answers amplitudes that were
//! not recorded; the draw d towards it is weak where several were, and strong where there was one. Gains that lie
//! evenly over log time follow a creep that does not, or a rate dependence, only where they are wrong at other
//! times. On eleven simulated devices of other classes, learnt from several amplitudes, frequencies and a hold, all
//! of it together leaves a sixth less error on other recordings than weights and functions by turns beside searched
//! gains; at best two thirds less, at worst a tenth more.

use crate::columns::Stages;
use crate::course::Course;
use crate::freeing::{Freed, Freeing};
use crate::priors::Scale;
use crate::{CREEPS, PLAYS};
use recordings::session::Session;

/// Most steps of Gauss and Newton with the creep's gains; without, one is as good as three.
const STEPS: usize = 6;
/// How often a step that makes it worse is halved.
const HALVED: usize = 3;
/// A step that gains less in the logarithm of the mean square error is the last.
const GAIN: f64 = 1e-3;

/// Frees the weights of the stages' plays, which are sought `from` these on, and the gains of their `creep` or not.
/// With the gains each play gets its own envelope. `floor` is the least slope of the reversible part, µm/V. `None`
/// where the least squares have no solution, or there are not [`PLAYS`] plays and [`CREEPS`] elements of creep.
pub fn freed(
    sessions: &[(&Session, &Course)],
    stages: &Stages<'_>,
    from: [f64; PLAYS],
    scale: Scale,
    floor: f64,
    creep: bool,
) -> Option<Freed> {
    let gains: Vec<f64> = stages.creep.iter().map(|(_, gain)| *gain).collect();
    let gains: [f64; CREEPS] = gains.try_into().ok().filter(|_| stages.plays.len() == PLAYS)?;
    let freeing = Freeing { sessions, stages, scale, floor, creep };
    let mut readings = freeing.read(gains);
    let mut best = freeing.at(&readings, from, gains)?;
    for _ in 0..if creep { STEPS } else { 1 } {
        let Some((weights, gains)) = freeing.step(&readings, &best) else { break };
        let mut part = 1.0;
        let mut better = None;
        for _ in 0..=HALVED {
            let between = |from: f64, to: f64| from + part * (to - from);
            let weights = std::array::from_fn(|i| between(best.weights[i], weights[i]));
            let gains: [f64; CREEPS] = std::array::from_fn(|k| between(best.gains[k], gains[k]));
            let others = (gains != best.gains).then(|| freeing.read(gains));
            let next = freeing.at(others.as_ref().unwrap_or(&readings), weights, gains);
            if let Some(next) = next.filter(|next| next.cost < best.cost) {
                better = Some((next, others));
                break;
            }
            part *= 0.5;
        }
        let Some((next, others)) = better else { break };
        let gained = best.cost - next.cost;
        best = next;
        readings = others.unwrap_or(readings);
        if gained < GAIN {
            break;
        }
    }
    if creep && let Some((own, solution)) = freeing.own(&readings, &best) {
        best = Freed { own: Some(own), solution, ..best };
    }
    Some(best)
}
