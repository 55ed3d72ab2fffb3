//! Where the actuator was before a log's first sample.
//!
//! A log begins where somebody pressed a button. Most begin at rest at their first voltage. One that was begun as the
//! amplifier was switched on jumps there from 0 V, and its first readings lie where the voltage has never been: hysteresis
//! and creep have to start from 0 V, or the largest signal of the log is lost.

use crate::flaw::{Flaw, leave_out, mended};
use recordings::log::Log;
use recordings::prepare::{PrepareError, Recipe};
use recordings::session::Session;

/// Voltages this near count as the same, as a fraction of the session's span.
const SAME: f64 = 0.02;
/// The part of a session that its start may still be seen in: one in so many.
const START: usize = 10;
/// What a reading may lie beyond the session's own loop at a voltage and still belong there, as a fraction of the stroke.
const BEYOND: f64 = 0.1;

/// Prepares a log that has been cut, with what it shows of its start.
///
/// # Errors
/// The log cannot be brought to the tick.
pub fn prepared(recipe: &Recipe, log: &Log) -> Result<Session, PrepareError> {
    Ok(prepared_without(recipe, log, &[])?.0)
}

/// As [`prepared`], with these flaws of the log mended and left out, of how it started, too; and how many instants were left out.
///
/// # Errors
/// The log cannot be brought to the tick.
pub fn prepared_without(recipe: &Recipe, log: &Log, flaws: &[Flaw]) -> Result<(Session, usize), PrepareError> {
    let mut session = recipe.session(&mended(log, flaws))?;
    let left_out = leave_out(&mut session, flaws, f64::from(recipe.delay_ticks) * recipe.tick_s());
    state_rest(&mut session, -recipe.voltage_zero_v);
    Ok((session, left_out))
}

/// States that the actuator had rested at 0 V at the amplifier (`off`, V relative to the model's zero), where its first reading
/// belongs there and not to the first voltage.
fn state_rest(session: &mut Session, off: f64) {
    let (Some(&first), Some(&reading)) = (session.voltage.first(), session.displacement.first()) else { return };
    let voltages = extent(session.voltage.iter().copied());
    let stroke = extent(session.displacement.iter().copied());
    let margin = BEYOND * (stroke.1 - stroke.0);
    let near = SAME * (voltages.1 - voltages.0);
    let belongs = |voltage: f64| {
        let there = session.instants.iter().zip(&session.displacement).skip(session.instants.len() / START);
        let there = there.filter(|&(&instant, _)| (session.voltage[instant as usize] - voltage).abs() <= near);
        let (low, high) = extent(there.map(|(_, &displacement)| displacement));
        low - margin <= reading && reading <= high + margin
    };
    if (first - off).abs() > near && !belongs(first) && belongs(off) {
        session.rested_v = Some(off);
    }
}

fn extent(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::log::{ReadOptions, read};
    use recordings::prepare::PrepareOptions;
    use std::path::Path;

    /// Half the voltage, with a lag of some ticks, from `rest`.
    fn session(rest: f64, phase: f64) -> Session {
        let voltage: Vec<f64> = (0..4000).map(|k| 50.0 - 50.0 * libm::cos(f64::from(k) * 0.01 + phase)).collect();
        let mut behind = rest;
        let displacement = voltage.iter().map(|v| {
            let before = behind;
            behind += 0.2 * (v - behind);
            0.5 * before
        });
        let displacement = displacement.collect();
        Session::new("log".into(), voltage, (0..4000).collect(), displacement, 5e-4)
    }

    #[test]
    fn a_jump_from_0_v_is_seen() {
        for (phase, rest, expected) in [(1.5, 0.0, Some(0.0)), (1.5, 46.5, None), (0.0, 0.0, None)] {
            let mut session = session(rest, phase);
            state_rest(&mut session, 0.0);
            assert_eq!(session.rested_v, expected, "from {rest} V at phase {phase}");
        }
        // Where 0 V lies outside of the log nothing can be said.
        let mut elsewhere = session(0.0, 1.5);
        state_rest(&mut elsewhere, -30.0);
        assert_eq!(elsewhere.rested_v, None);
    }

    /// The measured log began as the amplifier was switched on.
    #[test]
    fn a_spike_that_is_left_out_says_nothing_of_the_start() {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/picma-p885-1hz.csv");
        let log = read(&path, &ReadOptions::default()).unwrap();
        let recipe = PrepareOptions::default().resolve(std::slice::from_ref(&log));
        let clean = prepared(&recipe, &log).unwrap();
        assert!(clean.rested_v.is_some());
        for (row, by_um) in [(500, 50.0), (2000, 200.0), (2000, 9000.0), (5000, -9000.0)] {
            let mut spiky = log.clone();
            spiky.displacement.as_mut().unwrap()[row] += by_um;
            let (session, left_out) = prepared_without(&recipe, &spiky, &crate::flaws(&spiky)).unwrap();
            assert_eq!((session.rested_v, left_out > 0), (clean.rested_v, true), "{by_um} µm in row {row}");
        }
    }
}
