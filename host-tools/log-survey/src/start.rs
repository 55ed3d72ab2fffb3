//! Where the actuator was before a log's first sample.
//!
//! A log begins where somebody pressed a button. Most begin at rest at their first voltage. One that was begun as the
//! amplifier was switched on jumps there from 0 V, and its first readings lie where the voltage has never been:
//! hysteresis and creep have to start from 0 V, or the largest signal of the log is lost.

use crate::flaw::{Flaw, SPIKE_ROWS, measured};
use crate::noise::noise_of;
use crate::stroke::stroke;
use recordings::log::Log;
use recordings::prepare::{PrepareError, Recipe};
use recordings::session::Session;

/// Voltages this near count as the same, as a fraction of the session's span.
const SAME: f64 = 0.02;
/// Or as so many deviations of its noise.
const NOISE: f64 = 8.0;
/// Noise alone goes over more than so many deviations, in any log but the shortest.
const DRIVE: f64 = 5.0;
/// A voltage that stands still for so long at first, s, is that of an actuator at rest.
pub const RESTS_S: f64 = 0.1;
/// The part of a session that its start may still be seen in: one in so many.
const START: usize = 10;
/// What a reading may lie beyond the session's own loop at a voltage and still belong there, as a fraction
/// of the stroke.
const BEYOND: f64 = 0.1;

/// How far from its first a log's voltage may be and still stand, V: of what the log goes over, and of its noise,
/// unless that is a drive which is another in each row.
pub(crate) fn still_v(span_v: f64, noise_v: f64) -> f64 {
    (SAME * span_v).max(if DRIVE * noise_v > span_v { 0.0 } else { NOISE * noise_v })
}

/// Whether a log's voltage (V) moves before it has stood for [`RESTS_S`]: what the actuator remembers and still creeps
/// from is then not known.
pub fn begins_in_motion(time_s: &[f64], voltage: &[f64]) -> bool {
    let (Some(begins), Some(&first)) = (time_s.first(), voltage.first()) else { return false };
    let (low, high) = extent(voltage.iter().copied());
    let still = still_v(high - low, noise_of(voltage).unwrap_or(0.0));
    let moved = voltage.iter().position(|voltage| (voltage - first).abs() > still);
    let stood = moved.and_then(|row| time_s.get(row.checked_sub(1)?));
    stood.is_some_and(|until| until - begins < RESTS_S)
}

/// Prepares a log that has been cut, with what it shows of its start.
///
/// # Errors
/// The log cannot be brought to the tick.
pub fn prepared(recipe: &Recipe, log: &Log) -> Result<Session, PrepareError> {
    repaired(recipe, log, &[]).map(|(session, _)| session)
}

/// The same of a log without what was measured in these flaws of it, and how many instants that were; `None` where they
/// are most of them, which stay. How it began is seen in what is left, unless that begins later.
///
/// # Errors
/// The log cannot be brought to the tick.
pub fn repaired(recipe: &Recipe, log: &Log, flaws: &[Flaw]) -> Result<(Session, Option<usize>), PrepareError> {
    let (mut session, left_out) = measured(recipe, log, flaws)?;
    let step = log.sample_period.max(session.tick_s);
    let soon = SPIKE_ROWS as f64 * log.sample_period + 2.0 * step;
    if session.instants.get(1).is_none_or(|&second| f64::from(second) * session.tick_s <= soon) {
        state_rest(&mut session, -recipe.voltage_zero_v);
    }
    Ok((session, left_out))
}

/// States that the actuator had rested at 0 V at the amplifier (`off`, V relative to the model's zero), where its first
/// reading belongs there and not to the first voltage.
fn state_rest(session: &mut Session, off: f64) {
    let (Some(&first), Some(&reading)) = (session.voltage.first(), session.displacement.first()) else { return };
    let voltages = extent(session.voltage.iter().copied());
    let measured_at: Vec<f64> = session.instants.iter().map(|&instant| session.voltage[instant as usize]).collect();
    let margin = BEYOND * stroke(&measured_at, &session.displacement, off);
    let near = SAME * (voltages.1 - voltages.0);
    let belongs = |voltage: f64| {
        let there = measured_at.iter().zip(&session.displacement).skip(measured_at.len() / START);
        let there = there.filter(|&(at, _)| (at - voltage).abs() <= near);
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
    use crate::flaw::flaws;
    use rand::{RngExt as _, SeedableRng as _};
    use rand_chacha::ChaCha8Rng;
    use rand_distr::StandardNormal;
    use recordings::prepare::{AutoOr, PrepareOptions};

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

    fn log(session: &Session, displacement: Vec<f64>) -> Log {
        Log {
            name: "log".into(),
            path: "log.csv".into(),
            sha256: String::new(),
            sample_period: session.tick_s,
            start_s: 0.0,
            voltage: session.voltage.clone(),
            displacement: Some(displacement),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    #[test]
    fn a_log_begins_at_rest_where_its_voltage_stands_at_first() {
        let times: Vec<f64> = (0..4000).map(|k| f64::from(k) * 5e-4).collect();
        let from = |rest_s: f64| {
            let swing = |t: &f64| 50.0 - 50.0 * libm::cos(60.0 * (t - rest_s).max(0.0)) + 0.1 * (1e3 * t).sin();
            times.iter().map(swing).collect::<Vec<f64>>()
        };
        assert!(begins_in_motion(&times, &from(0.0)) && begins_in_motion(&times, &from(0.05)));
        assert!(!begins_in_motion(&times, &from(0.2)));
        let mut random = ChaCha8Rng::seed_from_u64(3);
        let noise: Vec<f64> = times.iter().map(|_| 3.0 + 0.01 * random.sample::<f64, _>(StandardNormal)).collect();
        assert!(!begins_in_motion(&times, &noise) && !begins_in_motion(&[], &[]), "a voltage that is held");
        let every_row: Vec<f64> = (0..4000).map(|k| f64::from([20, -20, 20, -20, -20, 20, 20][k % 7])).collect();
        assert!(begins_in_motion(&times, &every_row), "a drive that is another in each row");
        let rows = [0.0, 1.0, 2.0, 3.0];
        assert!(begins_in_motion(&rows, &[0.0, 10.0, 20.0, 30.0]) && !begins_in_motion(&rows, &[0.0, 0.0, 20.0, 30.0]));
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

    /// The first reading of what is left is one of later, and 0 V may lie anywhere from it.
    #[test]
    fn where_a_log_begins_in_a_long_flaw_nothing_is_said_of_before() {
        let began = session(0.0, 1.5);
        let mut displacement = began.displacement.clone();
        displacement[..300].fill(-40.0);
        let log = log(&began, displacement);
        let recipe = PrepareOptions { voltage_zero: AutoOr::Given(0.0), ..PrepareOptions::default() };
        let recipe = recipe.resolve(std::slice::from_ref(&log));
        let found = flaws(&log);
        assert!(matches!(found[..], [Flaw::Frozen { .. }]), "{found:?}");
        let (session, left_out) = repaired(&recipe, &log, &found).unwrap();
        assert_eq!((session.rested_v, left_out.is_some_and(|count| count >= 300)), (None, true));
    }

    /// What a spike spans is no stroke, and where it stands no displacement belongs.
    #[test]
    fn a_spike_of_any_size_hides_no_jump_once_it_is_left_out() {
        let began = session(0.0, 1.5);
        let first = began.voltage[0];
        let back = (2_000..4_000).find(|&row| (began.voltage[row] - first).abs() < 0.1).unwrap();
        for leap_um in [50.0, 200.0, 9_000.0, -9_000.0] {
            for row in [700, 3_000, back] {
                let mut displacement = began.displacement.clone();
                displacement[row] += leap_um;
                let log = log(&began, displacement);
                let recipe = PrepareOptions { voltage_zero: AutoOr::Given(0.0), ..PrepareOptions::default() };
                let recipe = recipe.resolve(std::slice::from_ref(&log));
                let (session, left_out) = repaired(&recipe, &log, &flaws(&log)).unwrap();
                assert_eq!((session.rested_v, left_out), (Some(0.0), Some(1)), "{leap_um} µm in row {row}");
            }
        }
    }
}
