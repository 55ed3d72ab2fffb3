//! The way from rest to where a trajectory begins: half a cosine, so slow that no limit is in the way.
//!
//! Without it the inverse goes there as fast as it may, and a displacement that lags behind its voltage overshoots.

use crate::{Trajectory, near, plan, reach};
use estimator_core::{Admitted, DriveLimits, Estimator, NoInverse};
use std::f64::consts::PI;

/// How often the length is doubled before it is taken as it is.
const DOUBLINGS: u32 = 6;
/// Longest way, ticks.
const MOST_TICKS: f64 = 1e6;

/// What is wanted from rest on before a trajectory begins, a value a tick; nothing where it begins at rest, or
/// out of reach.
///
/// # Errors
/// The limits break a rule, or the model has no inverse.
pub fn approach(table: &Admitted, limits: &DriveLimits, trajectory: &Trajectory) -> Result<Vec<f64>, NoInverse> {
    let rest = Estimator::<f64>::new(table).of_held_voltage().tick_volts(limits.rest_v.into()).displacement;
    let (begin, near) = (trajectory.at(0.0), near(table));
    let travel = begin - rest;
    let [low, high] = reach(table, limits);
    if travel.abs() < near || !(low.min(high)..=high.max(low)).contains(&begin) {
        return Ok(Vec::new());
    }
    // As fast as the voltage may go all the way, were displacement and voltage proportional; at most π/2 of
    // its mean speed.
    let whole_s = f64::from(limits.range_v.span()) / f64::from(limits.slew_v_per_s);
    let tick_s: f64 = table.sample_period();
    let mut ticks = (PI / 2.0 * whole_s * travel.abs() / (high - low).abs() / tick_s).max(2.0).ceil();
    let mut attempt = 0;
    loop {
        let count = ticks.min(MOST_TICKS) as usize;
        let eased = |tick: usize| 0.5 - 0.5 * (PI * tick as f64 / count as f64).cos();
        let lead: Vec<f64> = (0..count).map(|tick| rest + travel * eased(tick)).collect();
        // It stays there for a moment, as a trajectory may begin at rest: then nothing overshoots.
        let stays = std::iter::repeat_n(begin, count);
        let tried = plan(table, limits, &Trajectory(lead.iter().copied().chain(stays).collect()))?;
        let beyond = tried.displacement.iter().map(|y| (y - begin) * travel.signum()).fold(f64::MIN, f64::max);
        if (tried.out_of_reach == 0 && beyond < near) || attempt == DOUBLINGS || ticks >= MOST_TICKS {
            return Ok(lead);
        }
        ticks *= 2.0;
        attempt += 1;
    }
}
