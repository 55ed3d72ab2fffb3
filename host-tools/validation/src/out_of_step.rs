//! Whether what a model leaves of a recording goes with how fast it moves: then the sensor is read at other times than
//! the voltage.
//!
//! ```text
//! e_k = measured − estimated, less its mean;  v_k = rate of the estimate
//! τ   = −Σ e·v / Σ v²                     the sensor is that much later than the estimate
//! s   = (Σ e·v)² / (Σ v² · Σ e²)          part of the squared error that goes with it
//! ```
//!
//! A sensor that is always later is learnt as a lag of the actuator. One that is early cannot be, for no model shows a
//! displacement before its voltage; nor one that is later and later, as by clocks that differ. On simulated actuators
//! that no model is made of, recorded at once, s was at most 0.1 over a log; with a voltage that came 6 ms late it was
//! 0.9. In thirds of a log it is now and then 0.5, but of a small error; and a lag that stands for hysteresis is too
//! long at one frequency and too short at another, so that only thirds are compared that move about as fast.

use crate::trace::Trace;
use serde::Serialize;
use std::ops::Range;

/// Part of the squared error of a log that goes with how fast it moves, where its voltage is read late.
const EARLY: f64 = 0.5;
/// The same of either of its outer thirds, where clocks differ.
const DRIFTS: f64 = 0.3;
/// How much faster one of them may move than the other, rms.
const ALIKE: f64 = 1.3;
/// What goes with it is that part of the log's stroke at least, rms.
const MATTERS: f64 = 0.005;

/// How voltage and displacement of a log are out of step.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(tag = "out_of_step", rename_all = "kebab-case")]
pub enum OutOfStep {
    /// The displacement comes before the voltage.
    VoltageLate {
        /// By so much more than a model can have, s.
        by_s: f64,
    },
    /// It is later at the end of the log than at its beginning.
    ClocksDiffer {
        /// By so much from its beginning to its end, s.
        by_s: f64,
    },
}

impl OutOfStep {
    /// By how much, s.
    pub fn by_s(self) -> f64 {
        match self {
            Self::VoltageLate { by_s } | Self::ClocksDiffer { by_s } => by_s,
        }
    }
}

/// What of an error goes with the rate of the estimate.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Late {
    /// How much later the sensor is than the estimate, s.
    by_s: f64,
    /// The part of the squared error that goes with that.
    part: f64,
    /// Root mean square of what goes with it, µm.
    rms_um: f64,
    /// Root mean square of the estimate's rate, µm/s.
    rate: f64,
}

impl Trace {
    /// How its voltage and displacement are out of step, of a log with this stroke, µm; `None` where they are not.
    pub fn out_of_step(&self, stroke_um: f64) -> Option<OutOfStep> {
        let count = self.time_s.len();
        let matters = |late: &Late| late.rms_um > MATTERS * stroke_um;
        let thirds = self.late(0..count / 3).zip(self.late(count - count / 3..count));
        if let Some((first, last)) = thirds
            && first.part.min(last.part) > DRIFTS
            && first.by_s * last.by_s < 0.0
            && first.rate.max(last.rate) < ALIKE * first.rate.min(last.rate)
            && (matters(&first) || matters(&last))
        {
            // From the middle of the one to that of the other it is two thirds of the log.
            return Some(OutOfStep::ClocksDiffer { by_s: 1.5 * (last.by_s - first.by_s) });
        }
        let whole = self.late(0..count)?;
        let early = whole.by_s < 0.0 && whole.part > EARLY && matters(&whole);
        early.then_some(OutOfStep::VoltageLate { by_s: -whole.by_s })
    }

    /// `None` of fewer than three instants, or where nothing moves or nothing is off.
    fn late(&self, part: Range<usize>) -> Option<Late> {
        let (time, estimated) = (self.time_s.get(part.clone())?, self.estimated.get(part.clone())?);
        let errors =
            || self.measured[part.clone()].iter().zip(estimated).map(|(measured, estimate)| measured - estimate);
        let mean = errors().sum::<f64>() / part.len().max(1) as f64;
        let rates = time.windows(3).zip(estimated.windows(3)).map(|(time, um)| (um[2] - um[0]) / (time[2] - time[0]));
        let (mut together, mut moved, mut off) = (0.0, 0.0, 0.0);
        for (error, rate) in errors().skip(1).map(|error| error - mean).zip(rates) {
            (together, moved, off) = (together + error * rate, moved + rate * rate, off + error * error);
        }
        let (by_s, instants) = (-together / moved, part.len().saturating_sub(2) as f64);
        let (rate, part) = ((moved / instants).sqrt(), together * together / (moved * off));
        let late = Late { by_s, part, rms_um: by_s.abs() * rate, rate };
        [late.by_s, late.part, late.rms_um].iter().all(|of| of.is_finite()).then_some(late)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// A sine of 10 µm and 2 Hz, 10 s at 1 kHz, seen so much later (s) at a time, beside what else is off.
    fn seen(late_s: impl Fn(f64) -> f64, off_um: impl Fn(f64) -> f64) -> Trace {
        let time_s: Vec<f64> = (0..10_000).map(|k| f64::from(k) * 1e-3).collect();
        let sine = |time: f64| 5.0 * (TAU * 2.0 * time).sin();
        Trace {
            voltage: time_s.iter().map(|&time| sine(time)).collect(),
            estimated: time_s.iter().map(|&time| sine(time)).collect(),
            measured: time_s.iter().map(|&time| sine(time - late_s(time)) + off_um(time)).collect(),
            time_s,
        }
    }

    #[test]
    fn a_displacement_before_its_voltage_is_out_of_step_and_a_late_one_is_a_lag() {
        let ripple = |time: f64| 0.02 * (TAU * 6.0 * time).cos();
        let Some(OutOfStep::VoltageLate { by_s }) = seen(|_| -3e-3, ripple).out_of_step(10.0) else { panic!() };
        assert!((by_s - 3e-3).abs() < 1e-4, "{by_s} s");
        assert_eq!(seen(|_| 3e-3, ripple).out_of_step(10.0), None);
        assert_eq!(seen(|_| -3e-4, ripple).out_of_step(10.0), None, "a thousandth of the stroke");
        assert_eq!(seen(|_| 0.0, |time| 0.5 * (TAU * 2.0 * time).sin()).out_of_step(10.0), None, "a gain");
    }

    #[test]
    fn a_displacement_that_is_later_and_later_is_by_another_clock() {
        let Some(OutOfStep::ClocksDiffer { by_s }) = seen(|time| 1e-3 * (time - 5.0), |_| 0.3).out_of_step(10.0) else {
            panic!()
        };
        assert!((by_s - 10e-3).abs() < 3e-4, "{by_s} s");
    }

    /// A lag that stands for hysteresis: late where it is slow, early where it is fast.
    #[test]
    fn a_log_that_becomes_faster_is_by_one_clock() {
        let time_s: Vec<f64> = (0..10_000).map(|k| f64::from(k) * 1e-3).collect();
        let phase = |time: f64| TAU * if time < 5.0 { time } else { 5.0 + 2.0 * (time - 5.0) };
        let loops = |late: f64| time_s.iter().map(|&time| 5.0 * (phase(time) - late).sin()).collect::<Vec<f64>>();
        let lagged = |time: f64| 5.0 * (phase(time) - 0.15 * if time < 5.0 { 0.67 } else { 1.33 }).sin();
        let estimated = time_s.iter().map(|&time| lagged(time)).collect();
        let trace = Trace { voltage: loops(0.0), estimated, measured: loops(0.15), time_s: time_s.clone() };
        assert_eq!(trace.out_of_step(10.0), None);
    }

    #[test]
    fn nothing_is_out_of_step_where_nothing_moves() {
        assert_eq!(Trace::default().out_of_step(10.0), None);
        let still = Trace { estimated: vec![0.0; 10_000], ..seen(|_| -3e-3, |_| 0.0) };
        assert_eq!(still.out_of_step(10.0), None);
    }
}
