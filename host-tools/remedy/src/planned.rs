//! Why voltages for a wanted trajectory cannot be planned, or fall short of it.

use crate::paste::with;
use calibration::drive::identified_on;
use estimator_core::{DriveLimits, Table};
use std::path::Path;

/// Nobody has said how fast the voltage may change on the way along a trajectory.
pub fn no_slew(trajectory: &Path) -> String {
    format!(
        "how fast may the voltage change? The table has no drive that says so; amplifier, actuator and mechanics do, in V/s:{}",
        with(trajectory, &[("--slew", "<V/s>")])
    )
}

/// What was asked for, where that cannot be planned.
pub fn no_plan(table: &Table, limits: &DriveLimits) -> String {
    let (model, range) = (identified_on(table), limits.range_v);
    format!(
        "no voltages within {} … {} V (--range), from {} V (--rest), at {} V/s (--slew) by a model identified on {} … {} V",
        range.min, range.max, limits.rest_v, limits.slew_v_per_s, model.min, model.max
    )
}

/// On how many ticks of all a limit was in the way.
pub fn at_a_limit(ticks: usize, of: usize, limits: &DriveLimits) -> String {
    let DriveLimits { range_v, slew_v_per_s, .. } = limits;
    format!(
        "On {ticks} of {of} ticks the voltage or its slew rate stood at a limit ({} … {} V, {slew_v_per_s} V/s)",
        range_v.min, range_v.max
    )
}

/// By how much, µm, a plan falls short of the trajectory from a time on, s.
pub fn falls_short(from_s: f64, most_um: f64) -> String {
    format!(
        "FAILED: from {from_s:.3} s on it falls short by up to {most_um:.4} µm, for the voltage or its slew rate stands at a limit: ask for \
         less or more slowly, widen --range or --slew where the amplifier stands it, or say what is allowed by --max-error"
    )
}
