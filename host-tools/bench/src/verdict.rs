//! Whether a proof passes: how far the board's estimate is off, and whether it knew so.
//!
//! ```text
//! held = ticks with |e| ≤ ±, a ± that was stated, neither the voltage nor the estimate at a limit, and no voltage that leapt, of all
//! PASS = mean |e| ≤ most  and, where the table states a ±,  held ≥ 80 %
//! ```
//!
//! The ± says 95 %, over recordings and devices. The errors of one recording are all of one piece: a ± that is as good
//! as it says holds one recording in ten for less than nine tenths of its time (`identify` makes it so). So that hardly
//! a sound table fails, four fifths are asked of one. A ± however wide holds the sensor; so the mean error must be
//! small beside it in any case.

use estimator_core::Status;
use serde::Serialize;
use std::fmt;
use validation::Figures;

/// How often the table's ± says that it holds the sensor, %.
pub const STATED_PERCENT: f64 = 95.0;
/// How often it must hold it in one recording, %.
pub const ENOUGH_PERCENT: f64 = 80.0;
/// The mean absolute error that passes where nothing else is asked for, % of the stroke.
pub const MOST_PERCENT: f64 = 2.0;

/// A tick since the zero.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Instant {
    /// As the board says, µm.
    pub estimate_um: f64,
    /// The sensor above its zero, µm.
    pub sensor_um: f64,
    /// The voltage at that tick, V.
    pub voltage_v: f64,
    /// The ± that the board states, µm.
    pub half_width_um: Option<f64>,
    /// What the board says of its estimate.
    pub status: Status,
}

/// Parts of all ticks, %.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Shares {
    /// The ± held the sensor; `None` where the table has none.
    pub held_percent: Option<f64>,
    /// Mean of the ±, µm, where there was one.
    pub half_width_um: Option<f64>,
    /// The voltage went as it never did in the training.
    pub untrained_percent: f64,
    /// Any of the next four.
    pub beyond_percent: f64,
    /// The voltage was beyond what the model was identified on.
    pub out_of_range_percent: f64,
    /// It stood at an end of the ADC's range.
    pub saturated_percent: f64,
    /// It leapt as the amplifier cannot.
    pub leapt_percent: f64,
    /// The estimate was clamped to the table's limits.
    pub clamped_percent: f64,
}

impl Shares {
    /// Of all ticks, by a table that has an interval or none.
    pub fn of(instants: &[Instant], interval: bool) -> Self {
        let beyond = Status::CLAMPED | Status::VOLTAGE_OUT_OF_RANGE | Status::ADC_SATURATED | Status::SLEW_EXCEEDED;
        let percent = |of: &dyn Fn(&Instant) -> bool| {
            100.0 * instants.iter().filter(|at| of(at)).count() as f64 / instants.len().max(1) as f64
        };
        let held = |at: &Instant| {
            let within = |half: f64| (at.estimate_um - at.sensor_um).abs() <= half;
            at.half_width_um.is_some_and(within) && !at.status.intersects(beyond)
        };
        let raised = |bits: Status| percent(&|at| at.status.intersects(bits));
        let stated: Vec<f64> = instants.iter().filter_map(|at| at.half_width_um).collect();
        Self {
            held_percent: interval.then(|| percent(&held)),
            half_width_um: (!stated.is_empty()).then(|| stated.iter().sum::<f64>() / stated.len() as f64),
            untrained_percent: raised(Status::UNTRAINED),
            beyond_percent: raised(beyond),
            out_of_range_percent: raised(Status::VOLTAGE_OUT_OF_RANGE),
            saturated_percent: raised(Status::ADC_SATURATED),
            leapt_percent: raised(Status::SLEW_EXCEEDED),
            clamped_percent: raised(Status::CLAMPED),
        }
    }
}

/// Whether it passes, and by what.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Verdict {
    /// It is good enough.
    pub passed: bool,
    held_percent: Option<f64>,
    mae_percent: f64,
    stroke_um: f64,
    most_percent: f64,
}

impl Verdict {
    /// Of figures and shares, where the mean absolute error may be `most_percent` of the stroke, else [`MOST_PERCENT`].
    pub fn of(figures: &Figures, shares: &Shares, most_percent: Option<f64>) -> Self {
        let (mae_percent, stroke_um, held_percent) = (figures.mae_percent, figures.stroke_um, shares.held_percent);
        let most_percent = most_percent.unwrap_or(MOST_PERCENT);
        let held = held_percent.is_none_or(|held| held >= ENOUGH_PERCENT);
        Self { passed: held && mae_percent <= most_percent, held_percent, mae_percent, stroke_um, most_percent }
    }
}

impl Verdict {
    /// The mean absolute error is more than what is allowed.
    pub fn too_far_off(&self) -> bool {
        self.mae_percent > self.most_percent
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { passed, held_percent, mae_percent, stroke_um, most_percent } = self;
        // Of two, the one that failed it must be told from the other.
        let which = |missed| match (*passed, missed) {
            (true, _) => "",
            (false, true) => " (MISSED)",
            (false, false) => " (met)",
        };
        write!(f, "{}: ", if *passed { "PASS" } else { "FAIL" })?;
        if let Some(held) = held_percent {
            write!(
                f,
                "the table's ± holds the sensor {held:.1} % of the time, it says {STATED_PERCENT} %, and {ENOUGH_PERCENT} % are \
                 asked of one recording{}; ",
                which(*held < ENOUGH_PERCENT)
            )?;
        }
        let off = which(self.too_far_off());
        write!(
            f,
            "the mean absolute error is {mae_percent:.2} % of the {stroke_um:.1} µm stroke, {most_percent} % are allowed{off}"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundred ticks over 10 µm, off by so much (µm), with this ±, and what the board says of the first 21.
    fn verdict(off_um: f64, half_width_um: impl Fn(usize) -> Option<f64>, odd: Status, most: Option<f64>) -> Verdict {
        let instants: Vec<Instant> = (0..100)
            .map(|k| Instant {
                estimate_um: 0.1 * k as f64 + off_um,
                sensor_um: 0.1 * k as f64,
                voltage_v: k as f64,
                half_width_um: half_width_um(k),
                status: if k < 21 { odd } else { Status::empty() },
            })
            .collect();
        let (estimates, sensor): (Vec<f64>, Vec<f64>) =
            instants.iter().map(|at| (at.estimate_um, at.sensor_um)).unzip();
        let shares = Shares::of(&instants, instants.iter().any(|at| at.half_width_um.is_some()));
        Verdict::of(&Figures::of(&estimates, &sensor, 9.9), &shares, most)
    }

    #[test]
    fn it_passes_where_the_error_is_small_and_the_interval_holds_and_only_there() {
        let (sound, wide) = (Status::empty(), |_| Some(5.0));
        assert!(verdict(0.1, |_| Some(0.2), sound, None).passed);
        assert!(!verdict(0.1, |_| Some(0.05), sound, None).passed, "outside the ±");
        let said = verdict(1.0, wide, sound, None);
        assert!(!said.passed, "a ± that holds anything");
        assert!(said.to_string().starts_with("FAIL: the table's ± holds the sensor 100.0 %"), "{said}");
        assert!(
            said.to_string().contains("one recording (met); ") && said.to_string().ends_with(" (MISSED)"),
            "{said}"
        );
        let said = verdict(0.1, |_| Some(0.05), sound, None).to_string();
        assert!(said.contains("one recording (MISSED); ") && said.ends_with(" (met)"), "{said}");
        assert!(!verdict(0.1, wide, sound, None).to_string().contains("met"));
        assert!(verdict(1.0, wide, sound, Some(15.0)).passed);
        assert!(
            !verdict(0.1, |k| (k >= 21).then_some(5.0), sound, None).passed,
            "more than a fifth of the ticks state no ±"
        );
        assert!(verdict(0.1, |k| (k >= 20).then_some(5.0), sound, None).passed, "a fifth may be outside");
        for odd in [Status::CLAMPED, Status::VOLTAGE_OUT_OF_RANGE, Status::ADC_SATURATED, Status::SLEW_EXCEEDED] {
            assert!(!verdict(0.1, wide, odd, None).passed, "{odd:?}");
        }
        assert!(verdict(0.1, wide, Status::UNTRAINED, None).passed);
        assert!(verdict(0.1, |_| None, sound, Some(2.0)).passed && !verdict(0.1, |_| None, sound, Some(0.5)).passed);
    }

    #[test]
    fn each_cause_has_its_own_share() {
        let statuses = [
            Status::SLEW_EXCEEDED | Status::CLAMPED,
            Status::SLEW_EXCEEDED,
            Status::VOLTAGE_OUT_OF_RANGE,
            Status::ADC_SATURATED,
        ];
        let at = |status| Instant { estimate_um: 0.0, sensor_um: 0.0, voltage_v: 0.0, half_width_um: None, status };
        let of =
            Shares::of(&[&statuses[..], &[Status::empty(); 6]].concat().into_iter().map(at).collect::<Vec<_>>(), false);
        assert_eq!((of.beyond_percent, of.leapt_percent, of.clamped_percent), (40.0, 20.0, 10.0));
        assert_eq!((of.out_of_range_percent, of.saturated_percent, of.untrained_percent), (10.0, 10.0, 0.0));
    }
}
