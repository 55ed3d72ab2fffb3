//! Whether the sensor of one log goes farther than those of the others where the voltage goes as far: by another range
//! of the sensor, another lever, another load.
//!
//! ```text
//! b = Σ (estimated − ē)·(measured − m̄) / Σ (estimated − ē)²     what a log's sensor goes for a µm of the estimate
//! ```
//!
//! A model that is fitted to all of them goes in between. Logs of small swings are not compared: there the model's own
//! law of the amplitude decides.

use crate::statistics::mean;
use crate::trace::Trace;
use log_survey::{middle, range};

/// Part of what the voltage of all goes that a log's must go to be compared.
const FAR: f64 = 0.7;
/// How much farther than the others, as a factor.
const FARTHER: f64 = 1.05;
/// The part of the log's squared error that goes with that, its mean aside.
const MOST: f64 = 0.5;

/// What a trace's sensor goes for a µm of the estimate, and the part of the squared error that goes with it; `None`
/// where nothing moves, or nothing is off.
fn gain(trace: &Trace) -> Option<(f64, f64)> {
    let (e, m) = (mean(&trace.estimated), mean(&trace.measured));
    let (mut moved, mut together, mut off) = (0.0, 0.0, 0.0);
    for (estimated, measured) in trace.estimated.iter().zip(&trace.measured) {
        let (estimated, error) = (estimated - e, measured - m - (estimated - e));
        (moved, together, off) = (moved + estimated * estimated, together + estimated * error, off + error * error);
    }
    let (gain, part) = (1.0 + together / moved, together * together / (moved * off));
    (gain.is_finite() && part.is_finite()).then_some((gain, part))
}

/// The log whose sensor goes farther than the others', or less far, by most, and by which factor; `None` where none
/// does. Of two logs nobody can say which one it is.
pub fn other_gain<'a>(logs: impl Iterator<Item = (&'a str, &'a Trace)> + Clone) -> Option<(&'a str, f64)> {
    let span = |trace: &Trace| range(&trace.voltage);
    let far = logs.clone().map(|(_, trace)| span(trace)).fold(0.0, f64::max);
    let large = logs.filter(|(_, trace)| span(trace) > FAR * far);
    let gains: Vec<(&str, f64, f64)> =
        large.filter_map(|(name, trace)| gain(trace).map(|(gain, part)| (name, gain, part))).collect();
    let by = |at: usize| {
        let mut others: Vec<f64> = gains.iter().map(|(_, gain, _)| *gain).collect();
        let own = others.remove(at);
        Some(own / middle(others)?)
    };
    let factors = gains.iter().enumerate().filter_map(|(at, (name, _, part))| Some((*name, by(at)?, *part)));
    let found = factors.filter(|(_, by, part)| by.max(by.recip()) > FARTHER && *part > MOST);
    found.max_by(|(_, a, _), (_, b, _)| a.ln().abs().total_cmp(&b.ln().abs())).map(|(name, by, _)| (name, by))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A log of a sine, whose sensor goes so much of the estimate, beside what else is off.
    fn log(volts: f64, gain: f64, off_um: f64) -> Trace {
        let time_s: Vec<f64> = (0..2_000).map(|k| f64::from(k) * 1e-2).collect();
        let of = |scale: f64| time_s.iter().map(|time| scale * time.sin()).collect::<Vec<f64>>();
        let ripple = |time: &f64| 40.0 + off_um * (7.0 * time).sin();
        let measured = of(0.1 * volts * gain).iter().zip(&time_s).map(|(um, time)| um + ripple(time)).collect();
        Trace { voltage: of(volts), estimated: of(0.1 * volts), measured, time_s }
    }

    fn found(logs: [Trace; 3]) -> Option<(String, f64)> {
        other_gain(["a", "b", "c"].into_iter().zip(&logs)).map(|(name, by)| (name.to_owned(), by))
    }

    #[test]
    fn the_log_whose_sensor_goes_farther_is_found() {
        let (name, by) = found([log(50.0, 0.97, 0.02), log(50.0, 1.07, 0.02), log(45.0, 0.96, 0.02)]).unwrap();
        assert!(name == "b" && (by - 1.07 / 0.96).abs() < 0.02, "{name}: {by}");
        let (name, by) = found([log(50.0, 1.03, 0.02), log(50.0, 1.02, 0.02), log(45.0, 0.94, 0.02)]).unwrap();
        assert!(name == "c" && by < 0.95, "{name}: {by}");
    }

    #[test]
    fn small_swings_small_differences_and_other_errors_are_no_other_gain() {
        assert_eq!(found([log(50.0, 1.0, 0.02), log(50.0, 1.0, 0.02), log(20.0, 1.2, 0.02)]), None, "a small swing");
        assert_eq!(found([log(50.0, 0.99, 0.02), log(50.0, 1.02, 0.02), log(45.0, 0.99, 0.02)]), None, "a warm day");
        assert_eq!(found([log(50.0, 1.0, 0.02), log(50.0, 1.07, 0.8), log(45.0, 1.0, 0.02)]), None, "the model errs");
        assert_eq!(found([log(50.0, 1.0, 0.0), log(0.0, 1.0, 0.0), log(0.0, 1.0, 0.0)]), None, "nothing is off");
        assert_eq!(other_gain([("a", &log(50.0, 1.1, 0.0))].into_iter()), None, "there is no other");
    }
}
