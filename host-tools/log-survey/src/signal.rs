//! Numbers of a signal that outliers do not decide, and how far two go together.

use crate::noise::noise_of;
use recordings::session::Session;

/// One value in so many is left out of a range, at either end: a single spike is no movement.
const RARE: usize = 100;

/// Between the first and the last hundredth of the sorted values; 0 of none.
pub fn range(values: &[f64]) -> f64 {
    let mut values = values.to_vec();
    let Some(last) = values.len().checked_sub(1) else { return 0.0 };
    let rare = values.len() / RARE;
    let mut in_order = |at: usize| *values.select_nth_unstable_by(at, f64::total_cmp).1;
    let (low, high) = (in_order(rare), in_order(last - rare));
    high - low
}

/// The least and the largest; infinities the other way round of none.
pub(crate) fn ends(values: &[f64]) -> (f64, f64) {
    values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &value| (low.min(value), high.max(value)))
}

/// The least difference of two neighbours that are not the same; infinite where all are.
pub(crate) fn resolution(values: &[f64]) -> f64 {
    let steps = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    steps.fold(f64::INFINITY, f64::min)
}

/// Correlation of voltage and displacement at the measured instants, −1 … 1; 0 where one of them rests.
pub fn correlation(session: &Session) -> f64 {
    correlation_behind(session, 0)
}

/// The same with the voltage of so many ticks before.
fn correlation_behind(session: &Session, ticks: u32) -> f64 {
    let first = session.instants.partition_point(|&instant| instant < ticks);
    let pairs = session.instants[first..].iter().zip(&session.displacement[first..]);
    let pairs = pairs.map(|(&instant, &displacement)| (session.voltage[(instant - ticks) as usize], displacement));
    correlation_of(pairs)
}

/// Pearson's correlation of pairs of values, −1 … 1; 0 where one of the two rests.
pub fn correlation_of(pairs: impl Iterator<Item = (f64, f64)> + Clone) -> f64 {
    let count = pairs.clone().count().max(1) as f64;
    let (v, y) = pairs.clone().fold((0.0, 0.0), |(v, y), pair| (v + pair.0 / count, y + pair.1 / count));
    let [vv, vy, yy] = pairs.fold([0.0; 3], |[vv, vy, yy], pair| {
        let (dv, dy) = (pair.0 - v, pair.1 - y);
        [vv + dv * dv, vy + dv * dy, yy + dy * dy]
    });
    if vv * yy > 0.0 { vy / (vv * yy).sqrt() } else { 0.0 }
}

/// Whether the displacement falls while the voltage rises. A sensor that is late by half a period looks so, too: then
/// they go together with the voltage of some ms before, and before that never better against each other than without.
pub fn falls(session: &Session) -> bool {
    let now = correlation(session);
    if now > -AGAINST {
        return false;
    }
    let mut least = now;
    for part in 1..=STEPS {
        let behind =
            correlation_behind(session, (LATEST_S * f64::from(part) / f64::from(STEPS) / session.tick_s) as u32);
        least = least.min(behind);
        if behind > AGAINST {
            return now < -SURELY || least < now - BETTER;
        }
    }
    true
}

/// What falls correlates below minus this,
const AGAINST: f64 = 0.5;
/// below minus this whatever else is so,
const SURELY: f64 = 0.9;
/// or by this much less with an earlier voltage.
const BETTER: f64 = 0.02;
/// The latest that a sensor is expected to be, s, and in how many steps that is looked at.
const LATEST_S: f64 = 0.05;
const STEPS: u32 = 50;

/// The range of noise is less than so many of its standard deviations: nine in ten thousand of a normal
/// distribution's lie beyond.
const DEVIATIONS: f64 = 6.0;
/// What goes with the voltage correlates with it by more than this, one way or the other.
const GOES_WITH: f64 = 0.5;

/// Whether the displacement is noise alone, which does not go with the voltage.
pub fn is_noise(session: &Session) -> bool {
    let noise = noise_of(&session.displacement).unwrap_or(0.0);
    range(&session.displacement) < DEVIATIONS * noise && correlation(session).abs() < GOES_WITH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_leaves_the_rarest_out_and_a_correlation_has_the_sign_of_the_slope() {
        let mut values: Vec<f64> = (0..1000).map(f64::from).collect();
        values[500] = 1e6;
        assert_eq!(range(&values), 980.0);
        assert_eq!(range(&[]), 0.0);
        let of = |slope: f64| {
            let voltage: Vec<f64> = (0..20).map(f64::from).collect();
            let displacement = voltage.iter().map(|v| slope * v).collect();
            correlation(&Session::new("".into(), voltage, (0..20).collect(), displacement, 5e-4))
        };
        assert!((of(2.0) - 1.0).abs() < 1e-12 && (of(-0.1) + 1.0).abs() < 1e-12 && of(0.0) == 0.0);
    }

    /// Sines at 2 kHz; the displacement is `slope` times the voltage of some ms before.
    #[test]
    fn a_late_sensor_is_told_from_a_displacement_that_falls() {
        let of = |slope: f64, late_ms: f64, hertz: f64| {
            let volts = |tick: f64| 50.0 - 50.0 * libm::cos(std::f64::consts::TAU * hertz * 5e-4 * tick);
            let voltage: Vec<f64> = (0..2000).map(|tick| volts(f64::from(tick))).collect();
            let displacement = (0..2000).map(|tick| slope * volts(f64::from(tick) - 2.0 * late_ms)).collect();
            falls(&Session::new("".into(), voltage, (0..2000).collect(), displacement, 5e-4))
        };
        for (late_ms, hertz) in [(0.0, 1.0), (0.0, 30.0), (12.0, 30.0), (25.0, 15.0), (3.0, 100.0)] {
            assert!(!of(0.1, late_ms, hertz), "{late_ms} ms late at {hertz} Hz");
        }
        for (late_ms, hertz) in [(0.0, 1.0), (0.0, 30.0), (3.0, 30.0), (1.0, 100.0), (8.0, 10.0)] {
            assert!(of(-0.1, late_ms, hertz), "falls, {late_ms} ms late at {hertz} Hz");
        }
    }
}
