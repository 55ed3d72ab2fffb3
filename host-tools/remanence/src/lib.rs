//! How an actuator rests, as the memory of its model has it ([`Table::remanence_um`](estimator_core::Table)).
//!
//! A displacement that is told at rest stays right in the swings that follow only if the model remembers there what the
//! actuator does: driven over its range before, it stands higher at the lowest voltage than one that never was. So the
//! logs that begin at rest say how far off a model is after the first swing which is right before it:
//!
//! ```text
//! o_i = mean of estimate − reading once settled, less that at rest           µm; log i begins at the part p_i of the range
//! r₀, r₁: least Σ (o_i − (1 − p_i)·r₀ − p_i·r₁)² + λ·(r₀ + r₁)² + λ²·(r₀ − r₁)²
//! ```
//!
//! λ is small: what the logs do not say of the one end is the opposite of the other.

use estimator_core::{Admitted, Estimator, Range};
use log_survey::settled::settled;
use recordings::session::Session;
use validation::ZERO_WINDOW_S;

/// A voltage stands where it moves by no more than this part of a session's span.
const STILL: f64 = 0.02;
/// λ: how much less what no log says of an end counts than a log.
const RIDGE: f64 = 1e-3;

/// r₀ and r₁ (µm) of a table that has none, from the logs that begin at rest; 0 without any, and of a model
/// that needs none.
pub fn remanence<'s>(table: &Admitted, sessions: impl Iterator<Item = &'s Session>) -> [f32; 2] {
    if !table.model().remembers() {
        return [0.0; 2];
    }
    let range: Range<f64> = table.voltage_range_v.of();
    let [mut low, mut between, mut high] = [RIDGE + RIDGE * RIDGE, RIDGE - RIDGE * RIDGE, RIDGE + RIDGE * RIDGE];
    let [mut of_low, mut of_high] = [0.0; 2];
    for session in sessions {
        let Some((rests_v, off_um)) = rests_v(session).zip(off_after_first_swing(table, session)) else { continue };
        let part = (range.clamp(rests_v) - range.min) / range.span();
        let weights = [1.0 - part, part];
        low += weights[0] * weights[0];
        between += weights[0] * weights[1];
        high += weights[1] * weights[1];
        of_low += weights[0] * off_um;
        of_high += weights[1] * off_um;
    }
    // At least 4·λ³: the ridge alone makes it positive.
    let determinant = low * high - between * between;
    [(high * of_low - between * of_high) / determinant, (low * of_high - between * of_low) / determinant]
        .map(|um| um as f32)
}

/// The voltage (V) at which the actuator had rested before a session: where nothing else is known, the one that stands
/// for the first 50 ms.
pub fn rests_v(session: &Session) -> Option<f64> {
    if session.rested_v.is_some() {
        return session.rested_v;
    }
    let of = |ticks: &[f64]| Range::of_values(ticks.iter().copied());
    let begins = of(session.voltage.get(..(ZERO_WINDOW_S / session.tick_s).ceil() as usize)?);
    (begins.span() <= STILL * of(&session.voltage).span()).then(|| begins.middle())
}

/// What an estimate that is right in a session's first 50 ms is off by after its first swing, µm: the mean over as
/// many readings as came before its end. `None` where no swing is over, or the session begins with a jump.
fn off_after_first_swing(table: &Admitted, session: &Session) -> Option<f64> {
    let settled = settled(session);
    if session.rested_v.is_some() || settled == 0 {
        return None;
    }
    let mut estimator = Estimator::<f64>::new(table);
    let zero = f64::from(table.voltage_zero_v);
    let readings: Vec<(u32, f64)> =
        session.instants.iter().copied().zip(session.displacement.iter().copied()).take(2 * settled).collect();
    let ticks = readings.last()?.0 as usize;
    let estimates: Vec<f64> =
        session.voltage.iter().take(ticks).map(|voltage| estimator.tick_volts(voltage + zero).displacement).collect();
    // An estimate is of the tick that follows; the first has none.
    let off = |&(instant, reading): &(u32, f64)| Some(estimates.get(instant.checked_sub(1)? as usize)? - reading);
    let begins = (ZERO_WINDOW_S / session.tick_s) as u32;
    let at_rest = readings.partition_point(|(instant, _)| *instant <= begins).max(2).min(settled);
    let mean = |readings: &[(u32, f64)]| {
        let offs: Vec<f64> = readings.iter().filter_map(off).collect();
        (!offs.is_empty()).then(|| offs.iter().sum::<f64>() / offs.len() as f64)
    };
    Some(mean(&readings[settled..])? - mean(&readings[..at_rest])?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Table;
    use std::path::Path;

    fn table(model: &str) -> Table {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../tests/data/table/models/{model}.toml"));
        let file: toml::Table = std::fs::read_to_string(path).unwrap().parse().unwrap();
        file["table"].clone().try_into().unwrap()
    }

    /// Of an actuator that is a table's model and rests so, read by a sensor with a zero of its own: 600 ticks at rest
    /// at a part of the range, then swings over all of it.
    fn session(table: Table, remanence_um: [f32; 2], part: f64) -> Session {
        let actuator = Table { remanence_um, ..table }.admit().unwrap();
        let range: Range<f64> = actuator.voltage_range_v.of();
        let start = libm::acos(1.0 - 2.0 * part);
        let phase = |tick: u32| start + 0.004 * f64::from(tick.saturating_sub(600));
        let voltage: Vec<f64> =
            (0..6_000).map(|tick| range.min + 0.5 * range.span() * (1.0 - libm::cos(phase(tick)))).collect();
        let mut estimator = Estimator::<f64>::new(&actuator);
        let zero = f64::from(actuator.voltage_zero_v);
        let estimates: Vec<f64> = voltage.iter().map(|volts| estimator.tick_volts(volts + zero).displacement).collect();
        let read = std::iter::once(estimates[0]).chain(estimates.iter().copied()).take(6_000);
        let displacement = read.map(|um| um + 7.0).collect();
        Session::new("log".to_owned(), voltage, (0..6_000).collect(), displacement, actuator.sample_period())
    }

    fn found(model: &str, sessions: &[Session]) -> [f32; 2] {
        remanence(&table(model).admit().unwrap(), sessions.iter())
    }

    fn near(found: [f32; 2], expected: [f32; 2], tolerance_um: f32) {
        let off = found.iter().zip(expected).map(|(found, expected)| (found - expected).abs());
        assert!(off.fold(0.0, f32::max) < tolerance_um, "{found:?}, not {expected:?}");
    }

    #[test]
    fn how_an_actuator_rests_is_found_whatever_the_sensor_s_zero() {
        for (model, um) in [("bouc-wen", 1.0), ("duhem", 0.3)] {
            let of = |part| session(table(model), [0.8 * um, -0.5 * um], part);
            let near = |found: [f32; 2], expected: [f32; 2]| near(found, expected.map(|part| part * um), 0.04 * um);
            near(found(model, &[of(0.0), of(1.0)]), [0.8, -0.5]);
            near(found(model, &[of(0.0)]), [0.8, -0.8]);
            near(found(model, &[of(1.0)]), [0.5, -0.5]);
            near(found(model, &[of(0.5)]), [0.15, 0.15]);
            near(found(model, &[session(table(model), [0.0; 2], 0.0)]), [0.0; 2]);
        }
    }

    #[test]
    fn a_log_that_moves_at_once_or_jumps_says_nothing_nor_does_a_model_that_knows() {
        let rested = session(table("bouc-wen"), [0.8, -0.5], 0.0);
        let cut = |first: usize| Session {
            voltage: rested.voltage[first..].to_vec(),
            displacement: rested.displacement[first..].to_vec(),
            instants: (0..6_000 - first as u32).collect(),
            ..rested.clone()
        };
        assert_eq!(found("bouc-wen", &[cut(1_200)]), [0.0; 2]);
        assert_eq!(found("bouc-wen", &[Session { rested_v: Some(0.0), ..rested.clone() }]), [0.0; 2]);
        assert_eq!(found("voigt", std::slice::from_ref(&rested)), [0.0; 2]);
        assert_eq!(found("generalised-prandtl-ishlinskii", &[rested]), [0.0; 2]);
        assert_eq!(found("bouc-wen", &[]), [0.0; 2]);
    }
}
