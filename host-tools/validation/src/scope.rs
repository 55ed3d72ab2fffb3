//! Which part of a log is scored, and where the estimate is zeroed. The estimator runs from the log's beginning in any
//! case, as a device does; what lies before the part is its past.
//!
//! Zeroing at T is what `zero` does on a device that stands at a known position: from T on the estimate is less by what
//! it was off at T. That error is the mean over the [`ZERO_WINDOW_S`] up to T, so that it is not one reading's noise;
//! only what comes after T is scored.

use crate::statistics::mean;
use recordings::session::Session;
use std::fmt;
use std::ops::Range;

/// The error at which an estimate is zeroed is averaged over so much of the log up to there, s.
pub const ZERO_WINDOW_S: f64 = 0.05;
/// Fewest measured instants that are worth a figure.
pub const FEWEST: usize = 16;

/// The part of a log that is scored, in s since the log's first sample; all of it where nothing is said.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Scope {
    /// Where it begins, s from the log's first sample.
    pub from_s: Option<f64>,
    /// Where it ends, s from the log's first sample.
    pub to_s: Option<f64>,
    /// Where the estimate is zeroed; what is not later is not scored.
    pub zero_at_s: Option<f64>,
}

/// One of a scope's times.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Bound {
    /// The bound [`Scope::from_s`].
    From,
    /// The bound [`Scope::to_s`].
    To,
    /// The bound [`Scope::zero_at_s`].
    ZeroAt,
}

impl fmt::Display for Bound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::From => "the beginning of what is scored",
            Self::To => "the end of what is scored",
            Self::ZeroAt => "the zero",
        })
    }
}

/// Why a part of a log cannot be scored.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum ScopeError {
    /// A time at which the log has nothing.
    #[error(
        "{bound}, {at_s} s, must lie after {begins_s:.3} s, where what is used of the log begins, and before its end at {ends_s:.3} s"
    )]
    Outside {
        /// The bound that lies outside.
        bound: Bound,
        /// The time that was asked for, s.
        at_s: f64,
        /// First instant that is used, s.
        begins_s: f64,
        /// Last instant that is used, s.
        ends_s: f64,
    },
    /// The part ends before it begins, or before the zero.
    #[error("what is scored would end at {to_s} s, which is not after {bound}, {at_s} s")]
    Order {
        /// What it would begin with.
        bound: Bound,
        /// When that is, s.
        at_s: f64,
        /// The end that was asked for, s.
        to_s: f64,
    },
    /// Too few readings would be scored.
    #[error("only {left} measured instants would be scored; at least {FEWEST} are needed")]
    TooFew {
        /// How many samples are left.
        left: usize,
    },
    /// The voltage makes no full cycle that could be told of.
    #[error("the voltage makes no full cycle within what is scored, or next to nothing is left after it")]
    NoCycle,
}

/// A scope on a session: indices of the measured instants after the first.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Part {
    /// The instants that are scored.
    pub scored: Range<usize>,
    /// Where the error is averaged that the estimate is zeroed by, from its end on.
    pub zero: Option<Range<usize>>,
}

impl Part {
    /// What the estimate is to be less by at an instant, µm.
    pub fn zeroed(&self, errors: &[f64]) -> f64 {
        self.zero.as_ref().map_or(0.0, |window| mean(&errors[window.clone()]))
    }
}

/// Time of a measured instant, s since the log's first sample.
pub(crate) fn time_s(session: &Session, instant: u32) -> f64 {
    session.start_s + f64::from(instant) * session.tick_s
}

impl Scope {
    /// All of a log.
    pub const ALL: Self = Self { from_s: None, to_s: None, zero_at_s: None };

    /// From a time (s since the log's first sample) to the end.
    pub fn since(from_s: f64) -> Self {
        Self { from_s: Some(from_s), ..Self::ALL }
    }

    /// The scope on a session.
    pub(crate) fn part(&self, session: &Session) -> Result<Part, ScopeError> {
        let times: Vec<f64> = session.instants.iter().skip(1).map(|&instant| time_s(session, instant)).collect();
        let (begins_s, ends_s) = (session.start_s, times.last().copied().unwrap_or(session.start_s));
        // A reading stands for what follows until the next: a part may end where the log does.
        let period = if times.len() > 1 { (ends_s - times[0]) / (times.len() - 1) as f64 } else { 0.0 };
        let half = session.tick_s / 2.0;
        for (bound, at, first, last) in [
            (Bound::From, self.from_s, 0.0, ends_s),
            (Bound::To, self.to_s, begins_s, ends_s + period + half),
            (Bound::ZeroAt, self.zero_at_s, times.first().copied().unwrap_or(begins_s) - half, ends_s + half),
        ] {
            if let Some(at_s) = at.filter(|at| !(first..=last).contains(at)) {
                return Err(ScopeError::Outside { bound, at_s, begins_s, ends_s });
            }
        }
        let begins = [(Bound::From, self.from_s), (Bound::ZeroAt, self.zero_at_s)];
        for (bound, at_s) in begins.into_iter().filter_map(|(bound, at)| Some((bound, at?))) {
            if let Some(to_s) = self.to_s.filter(|&to_s| to_s <= at_s) {
                return Err(ScopeError::Order { bound, at_s, to_s });
            }
        }
        let before = |time: f64| times.partition_point(|&at| at < time);
        let zero = self.zero_at_s.map(|at| {
            let end = before(at + half).max(1);
            before(at - ZERO_WINDOW_S + half).min(end - 1)..end
        });
        let from = self.from_s.map_or(0, |from| before(from - half)).max(zero.as_ref().map_or(0, |zero| zero.end));
        let to = self.to_s.map_or(times.len(), |to| before(to - half)).max(from);
        match to - from {
            left if left < FEWEST => Err(ScopeError::TooFew { left }),
            _ => Ok(Part { scored: from..to, zero }),
        }
    }
}

/// Estimate − sensor (µm) of estimates that stand at the measured instants after the first, where a scope scores
/// them; not zeroed.
///
/// # Errors
/// The scope does not fit the session.
pub fn errors_within(session: &Session, scope: &Scope, estimated: &[f64]) -> Result<Vec<f64>, ScopeError> {
    let scored = scope.part(session)?.scored;
    let pairs = estimated.iter().zip(session.displacement.iter().skip(1));
    Ok(pairs.skip(scored.start).take(scored.len()).map(|(estimate, sensor)| estimate - sensor).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 s at 200 Hz, at a tick of 500 µs.
    fn session() -> Session {
        let instants: Vec<u32> = (0..=400).map(|k| 10 * k).collect();
        Session::new("ramp".into(), vec![0.0; 4001], instants, vec![0.0; 401], 5e-4)
    }

    fn scope(from_s: Option<f64>, to_s: Option<f64>, zero_at_s: Option<f64>) -> Scope {
        Scope { from_s, to_s, zero_at_s }
    }

    #[test]
    fn a_part_begins_with_its_first_instant_and_ends_before_its_last() {
        assert_eq!(Scope::ALL.part(&session()).unwrap(), Part { scored: 0..400, zero: None });
        // Index 0 is the instant at 5 ms.
        let part = scope(Some(0.5), Some(1.0), None).part(&session()).unwrap();
        assert_eq!(part.scored, 99..199);
        assert_eq!(scope(None, Some(2.005), None).part(&session()).unwrap().scored, 0..400);
    }

    #[test]
    fn a_zero_is_the_mean_of_50_ms_and_what_follows_is_scored() {
        let part = scope(None, None, Some(1.0)).part(&session()).unwrap();
        assert_eq!(part, Part { scored: 200..400, zero: Some(190..200) });
        let first = scope(None, None, Some(0.005)).part(&session()).unwrap();
        assert_eq!(first.zero, Some(0..1));
        assert_eq!(scope(Some(1.5), None, Some(1.0)).part(&session()).unwrap().scored, 299..400);
    }

    #[test]
    fn what_makes_no_part_is_refused() {
        let refused = |from, to, zero| scope(from, to, zero).part(&session()).unwrap_err();
        assert!(matches!(refused(Some(3.0), None, None), ScopeError::Outside { bound: Bound::From, .. }));
        assert!(matches!(refused(None, Some(3.0), None), ScopeError::Outside { bound: Bound::To, .. }));
        assert!(matches!(refused(None, None, Some(0.0)), ScopeError::Outside { bound: Bound::ZeroAt, .. }));
        assert!(matches!(refused(Some(f64::NAN), None, None), ScopeError::Outside { .. }));
        assert!(matches!(refused(Some(1.0), Some(1.0), None), ScopeError::Order { bound: Bound::From, .. }));
        assert!(matches!(refused(None, Some(1.0), Some(1.5)), ScopeError::Order { bound: Bound::ZeroAt, .. }));
        assert!(matches!(refused(Some(1.95), None, None), ScopeError::TooFew { left: 11 }));
    }
}
