//! Why the figures of a log say little of the table: the log is of another actuator, or read in another unit, or its
//! sensor has another zero.

use crate::compare::Comparison;
use crate::coverage::Coverage;
use crate::scope::Scope;
use crate::told::Told;
use estimator_core::Table;
use log_survey::{begins_in_motion, correlation_of, range};
use serde::Serialize;

/// A reason to look at the log before its figures are believed.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "suspicion", rename_all = "kebab-case")]
pub enum Suspicion {
    /// The log does not go with the table, whatever constant is taken off.
    Another {
        /// What speaks for it.
        evidence: Vec<Evidence>,
    },
    /// A constant is most of the error.
    Constant {
        /// Median of estimate − sensor, µm.
        offset_um: f64,
        /// Mean absolute error, µm.
        mae_um: f64,
        /// The same without the offset, µm.
        without_um: f64,
    },
    /// The interval holds the sensor less often than most recordings are held.
    Narrow {
        /// What was told before.
        since: Since,
        /// How often it does, %.
        held_percent: f64,
        /// The log begins in motion: what the actuator creeps from is in no interval.
        in_motion: bool,
        /// It was zeroed before it had settled: of what its start left open a larger swing shows more.
        unsettled: bool,
    },
}

/// Since when an interval is looked at.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Since {
    /// Since the zero at a time that was asked for.
    Zero,
    /// Since the mean over one cycle was told.
    OneCycle,
    /// Since the first reading or since one cycle, whichever does better.
    Either,
}

/// What speaks for another actuator, unit or column.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
#[serde(tag = "evidence", rename_all = "kebab-case")]
pub enum Evidence {
    /// Most of the voltage lies beyond what the table was learnt on.
    Beyond {
        /// Part of what is scored, %.
        percent: f64,
    },
    /// The sensor falls where the table says that it rises.
    Reversed {
        /// Correlation of sensor and estimate, −1 … 1.
        correlation: f64,
    },
    /// The sensor goes over much more or much less than the table says of the same voltages.
    Span {
        /// What the sensor goes over, µm.
        measured_um: f64,
        /// What the estimate does, µm.
        estimated_um: f64,
    },
    /// The error is large even without an offset.
    Error {
        /// Mean absolute error without the offset, % of the log's stroke.
        percent: f64,
        /// Mean absolute error in the table's training, µm.
        training_um: f64,
    },
    /// The interval holds the sensor far less often than it says, wherever the displacement was told.
    Interval {
        /// How often it does, %, at best.
        held_percent: f64,
    },
}

/// An interval that says 95 % and holds less than this, %, does not hold on this log.
const HELD: f64 = 50.0;
/// One that holds less than this, %, is too narrow for it: `piezo prove` fails there, too.
const NARROW: f64 = 80.0;
/// Without its offset an error of less than this, % of the log's stroke, is too small for another unit, sign or column:
/// what does not hold it is too narrow.
const SMALL: f64 = 2.0;
/// A larger error without its offset, % of the log's stroke,
const ERROR: f64 = 10.0;
/// and than so many times that of the training.
const TIMES: f64 = 3.0;
/// Spans that differ by this factor are not one actuator's.
const SPAN: f64 = 1.5;
/// A correlation of sensor and estimate below this is one of a sensor that is mounted the other way.
const REVERSED: f64 = -0.5;
/// Part of the table's limits that a log goes over, at least, where its stroke says something.
const MOVES: f64 = 0.03;
/// Part of what is scored beyond the table's voltages, %.
const BEYOND: f64 = 50.0;
/// The error without its offset is at most this part of one that is mostly offset.
const WITHOUT: f64 = 0.3;
/// An offset that matters: of the stroke, %.
const MATTERS: f64 = 1.0;

impl Suspicion {
    /// Of a log against a table, by what was told and what is scored; `None` where nothing is suspicious. An error that
    /// is judged without its offset (`rezeroed`) may be a constant.
    pub fn of(comparison: &Comparison, table: &Table, scope: &Scope, told: Told, rezeroed: bool) -> Option<Self> {
        let evidence = evidence(comparison, table);
        if !evidence.is_empty() {
            return Some(Self::Another { evidence });
        }
        // Told nothing, it may be off by where it started; otherwise zeroed, the offset is taken off.
        let read = told == Told::FirstReading && scope.zero_at_s.is_none() && !rezeroed;
        if let Some(figures) = comparison.told.get(told).filter(|_| read) {
            let (offset_um, mae_um, without_um) = (figures.offset_um, figures.mae_um, figures.mae_without_offset_um);
            if without_um < WITHOUT * mae_um && figures.mae_percent > MATTERS {
                return Some(Self::Constant { offset_um, mae_um, without_um });
            }
        }
        let &Comparison { interval, interval_one_cycle, .. } = comparison;
        let (since, coverage) = asked(told, scope.zero_at_s.is_some(), interval, interval_one_cycle);
        let held_percent = coverage?.covered_percent;
        let in_motion = begins_in_motion(&comparison.trace.time_s, &comparison.trace.voltage);
        let settled_s = comparison.cold.settled_after_s;
        let early = |zero_s: f64| settled_s.is_none_or(|settled_s| settled_s > zero_s);
        let unsettled = since == Since::Zero && scope.zero_at_s.is_some_and(early);
        (held_percent < NARROW).then_some(Self::Narrow { since, held_percent, in_motion, unsettled })
    }
}

/// How the interval did since what was told last, a cycle after a zero. Where that is the first reading, nothing, or an
/// offset that no device knows, since whichever does better.
fn asked(
    told: Told,
    zeroed: bool,
    since: Option<Coverage>,
    since_cycle: Option<Coverage>,
) -> (Since, Option<Coverage>) {
    match told {
        Told::OneCycle => (Since::OneCycle, since_cycle),
        Told::Nothing | Told::FirstReading if zeroed => (Since::Zero, since),
        _ => (Since::Either, better(since, since_cycle)),
    }
}

/// What holds the sensor more often. One that was zeroed anew spoils the interval since the first reading, a transient
/// in the first cycle the other. Without a cycle there is only the one that the sensor's zero may spoil: `None`.
fn better(since: Option<Coverage>, since_cycle: Option<Coverage>) -> Option<Coverage> {
    let since_cycle = since_cycle?;
    Some(since.filter(|since| since.covered_percent > since_cycle.covered_percent).unwrap_or(since_cycle))
}

fn evidence(comparison: &Comparison, table: &Table) -> Vec<Evidence> {
    let (from_s, to_s) = comparison.scored_s;
    let trace = &comparison.trace;
    let scored: Vec<usize> = (0..trace.time_s.len()).filter(|&k| (from_s..=to_s).contains(&trace.time_s[k])).collect();
    let known: Vec<usize> =
        scored.iter().copied().filter(|&k| table.voltage_range_v.contains(trace.voltage[k] as f32)).collect();
    let span = |of: &[f64], at: &[usize]| range(&at.iter().map(|&k| of[k]).collect::<Vec<_>>());
    let least_um = MOVES * f64::from(table.displacement_limits_um.span());
    let mut found = Vec::new();
    let percent = 100.0 - 100.0 * known.len() as f64 / scored.len().max(1) as f64;
    if percent > BEYOND {
        found.push(Evidence::Beyond { percent });
    } else {
        let (measured_um, estimated_um) = (span(&trace.measured, &known), span(&trace.estimated, &known));
        let (less, more) = (measured_um.min(estimated_um), measured_um.max(estimated_um));
        if more > least_um && more > SPAN * less {
            found.push(Evidence::Span { measured_um, estimated_um });
        }
        let correlation = correlation_of(known.iter().map(|&k| (trace.measured[k], trace.estimated[k])));
        if less > least_um && correlation < REVERSED {
            found.push(Evidence::Reversed { correlation });
        }
    }
    let (figures, training_um) = (comparison.told.offset, f64::from(table.provenance.train_mae_um));
    // Of an actuator that rests the error is a large part of next to nothing.
    let large = figures.mae_without_offset_percent > ERROR && figures.mae_without_offset_um > TIMES * training_um;
    if large && span(&trace.measured, &scored) > least_um {
        found.push(Evidence::Error { percent: figures.mae_without_offset_percent, training_um });
    }
    let held_percent = better(comparison.interval, comparison.interval_one_cycle).map(|best| best.covered_percent);
    let small = found.is_empty() && figures.mae_without_offset_percent < SMALL;
    found.extend(
        held_percent
            .filter(|&percent| percent < HELD && !small)
            .map(|held_percent| Evidence::Interval { held_percent }),
    );
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_is_judged_by_what_was_told() {
        let of = |covered_percent| Some(Coverage { covered_percent, half_width_um: 1.0, best_constant_um: 1.0 });
        let asked = |told, zeroed, since, since_cycle| {
            asked(told, zeroed, of(since), of(since_cycle)).1.map(|of| of.covered_percent)
        };
        assert_eq!(asked(Told::OneCycle, false, 97.8, 11.9), Some(11.9));
        assert_eq!(asked(Told::OneCycle, true, 97.8, 11.9), Some(11.9), "one cycle takes the zero's place");
        assert_eq!(asked(Told::Nothing, true, 53.6, 82.5), Some(53.6));
        assert_eq!(asked(Told::FirstReading, false, 0.0, 99.0), Some(99.0), "its sensor may have another zero");
        assert_eq!([asked(Told::Offset, false, 97.0, 11.9), asked(Told::Offset, true, 11.9, 97.0)], [Some(97.0); 2]);
        assert_eq!(
            super::asked(Told::FirstReading, false, of(0.0), None),
            (Since::Either, None),
            "no cycle tells the two apart"
        );
        assert_eq!(super::asked(Told::Nothing, true, of(70.0), None), (Since::Zero, of(70.0)));
    }
}
