//! What an estimator is told of the actuator before its errors are counted. A sensorless estimate starts somewhere, and
//! by how much it is off depends on that more than on the model:
//!
//! - nothing: it takes the actuator to have rested at the first voltage, as a device does that is switched on;
//! - the sensor's first reading, from which it goes on;
//! - one cycle: beside a sensor, or between known stops, over a full cycle of the voltage; the mean error there
//!   is taken off from then on, and what follows is scored;
//! - the offset: the mean error over what is scored is taken off. No device knows it: a bound on what zeroing can do.
//!
//! A full cycle is what lies between the second and the fourth reversal of the voltage, each a retreat by a quarter of
//! its span within what is scored: the swing before it wipes out what lies within its span of an unknown start. Where
//! less than half a cycle follows, it lies between the first and the third.

use crate::coverage::Coverage;
use crate::figures::Figures;
use crate::run::Run;
use crate::scope::{FEWEST, Part, ScopeError};
use crate::statistics::mean;
use log_survey::reversals::early_cycles;
use recordings::session::Session;
use serde::Serialize;
use std::fmt;
use std::ops::Range;

/// What an estimator is told.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Told {
    /// Nothing: it takes the actuator to have rested at the first voltage.
    Nothing,
    /// The sensor's first reading.
    FirstReading,
    /// The sensor over one full cycle: the mean error there is taken off, and what follows is scored.
    OneCycle,
    /// The mean error of what is scored, which is taken off: a bound on what zeroing can do.
    Offset,
}

impl Told {
    /// What an estimator is told where it may be `zeroed` at a time within the log: a device that is zeroed while it
    /// runs was told no first reading.
    pub fn before(self, zeroed: bool) -> Self {
        match self {
            Self::FirstReading if zeroed => Self::Nothing,
            told => told,
        }
    }

    /// Each, the least first.
    pub const ALL: [Self; 4] = [Self::Nothing, Self::FirstReading, Self::OneCycle, Self::Offset];

    /// Its name on the command line and in JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Nothing => "nothing",
            Self::FirstReading => "first-reading",
            Self::OneCycle => "one-cycle",
            Self::Offset => "offset",
        }
    }
}

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Nothing => "told nothing",
            Self::FirstReading => "told the first reading",
            Self::OneCycle => "told one cycle",
            Self::Offset => "without offset",
        })
    }
}

/// Errors by what the estimator was told.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct ToldFigures {
    /// Of an estimator that is told nothing.
    pub nothing: Figures,
    /// Told the sensor's first reading.
    pub first_reading: Figures,
    /// Told one cycle; `None` where the voltage makes none, or next to nothing follows.
    pub one_cycle: Option<Figures>,
    /// Told nothing, and the mean error taken off.
    pub offset: Figures,
}

impl ToldFigures {
    /// Those of what was told.
    pub fn get(&self, told: Told) -> Option<&Figures> {
        match told {
            Told::Nothing => Some(&self.nothing),
            Told::FirstReading => Some(&self.first_reading),
            Told::OneCycle => self.one_cycle.as_ref(),
            Told::Offset => Some(&self.offset),
        }
    }

    /// Of estimates that need no table, such as a straight line's: to be told the first reading is there to be moved
    /// onto it. `estimated` stands at the measured instants after the first, `first` at the first.
    ///
    /// # Errors
    /// The scope does not fit the session.
    pub fn of_estimates(
        session: &Session,
        scope: &crate::Scope,
        first: f64,
        estimated: &[f64],
    ) -> Result<Self, ScopeError> {
        let part = scope.part(session)?;
        let run = |offset: f64| Run {
            estimated: estimated.iter().map(|estimate| estimate - offset).collect(),
            half_width: Vec::new(),
            status: Vec::new(),
        };
        Ok(Self::of(session, &part, &run(0.0), &run(first - session.displacement[0])))
    }

    /// Several logs in one line ([`Figures::all`]); one cycle over the logs that have one.
    pub fn all<'a>(figures: impl ExactSizeIterator<Item = &'a Self> + Clone) -> Option<Self> {
        let cycles: Vec<Figures> = figures.clone().filter_map(|of| of.one_cycle).collect();
        Some(Self {
            nothing: Figures::all(figures.clone().map(|of| &of.nothing))?,
            first_reading: Figures::all(figures.clone().map(|of| &of.first_reading))?,
            one_cycle: Figures::all(cycles.iter()),
            offset: Figures::all(figures.map(|of| &of.offset))?,
        })
    }

    /// Of a run that was told nothing and one that was told the first reading.
    pub(crate) fn of(session: &Session, part: &Part, nothing: &Run, first_reading: &Run) -> Self {
        // Of all that is scored, also where one cycle leaves less of it: every line's percentage is of one stroke.
        let stroke_um = stroke(session, &part.scored);
        let figures = |told: Told, run: &Run| {
            Correction::of(told, session, part, run).map(|correction| correction.figures(session, run, stroke_um))
        };
        Self {
            // Only a cycle can be missing.
            nothing: figures(Told::Nothing, nothing).expect("needs no cycle"),
            first_reading: figures(Told::FirstReading, first_reading).expect("needs no cycle"),
            one_cycle: figures(Told::OneCycle, nothing).ok(),
            offset: figures(Told::Offset, nothing).expect("needs no cycle"),
        }
    }
}

/// What is taken off a run, and what is scored of it then.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Correction {
    /// Instants from which on something is taken off, and how much, µm; in the order of time.
    steps: Vec<(usize, f64)>,
    /// The instants that are scored.
    pub scored: Range<usize>,
}

impl Correction {
    pub fn of(told: Told, session: &Session, part: &Part, run: &Run) -> Result<Self, ScopeError> {
        let errors = run.errors(session);
        let zero = part.zero.as_ref().map(|window| (window.end - 1, part.zeroed(&errors)));
        let (more, scored) = match told {
            Told::Nothing | Told::FirstReading => (None, part.scored.clone()),
            Told::OneCycle => {
                let cycle = cycle(session, &part.scored).ok_or(ScopeError::NoCycle)?;
                (Some((cycle.end, mean(&errors[cycle.clone()]))), cycle.end..part.scored.end)
            }
            Told::Offset => (Some((0, mean(&errors[part.scored.clone()]))), part.scored.clone()),
        };
        // A cycle and the offset are told after the zero, and take its place.
        let zero = zero.filter(|_| told != Told::Offset);
        Ok(Self { steps: zero.into_iter().chain(more).collect(), scored })
    }

    /// What is taken off at an instant, µm.
    pub fn at(&self, instant: usize) -> f64 {
        self.steps.iter().rev().find(|(from, _)| *from <= instant).map_or(0.0, |(_, offset)| *offset)
    }

    /// Where the interval begins that is relative to the last thing told: `None` at the log's beginning, or nowhere.
    pub fn told(&self) -> Option<usize> {
        self.steps.last().and_then(|(from, _)| from.checked_sub(1))
    }

    /// How the interval did over what is scored; `None` where the run has none.
    pub fn coverage(&self, session: &Session, run: &Run) -> Option<Coverage> {
        let errors = run.errors(session);
        let beside = |k: usize| Some((errors[k] - self.at(k), run.half_width.get(k).copied().flatten()?));
        Coverage::of(&self.scored.clone().filter_map(beside).collect::<Vec<_>>())
    }

    /// Errors of what is scored, in µm and in parts of this stroke.
    pub fn figures(&self, session: &Session, run: &Run, stroke_um: f64) -> Figures {
        let estimated: Vec<f64> = self.scored.clone().map(|k| run.estimated[k] - self.at(k)).collect();
        Figures::of(&estimated, &session.displacement[1..][self.scored.clone()], stroke_um)
    }
}

/// The stroke (µm) of some of the measured instants after the first.
pub(crate) fn stroke(session: &Session, part: &Range<usize>) -> f64 {
    let measured = session.displacement.get(1..).and_then(|of| of.get(part.clone())).unwrap_or_default();
    let voltage: Vec<f64> = session.instants.iter().skip(1).map(|&tick| session.voltage[tick as usize]).collect();
    // What a log's beginning shows of the voltage before it may be seen for some rows.
    let before_v = match part.start.checked_sub(SEEN) {
        Some(before) => voltage.get(before).copied().unwrap_or(0.0),
        None => session.rested_v.unwrap_or(0.0),
    };
    log_survey::stroke(voltage.get(part.clone()).unwrap_or_default(), measured, before_v)
}

/// Measured instants for which a log may show how it began.
const SEEN: usize = 3;

/// The measured instants of the full cycle within a part that is told; `None` where there is none, or
/// next to nothing after it.
fn cycle(session: &Session, part: &Range<usize>) -> Option<Range<usize>> {
    let instants = session.instants.get(1..)?;
    let first = instants.get(part.start).copied()? as usize;
    let last = instants.get(part.end.checked_sub(1)?).copied()? as usize;
    let voltage = session.voltage.get(first..=last)?;
    let at = |turn: usize| instants.partition_point(|&instant| (instant as usize) < first + turn);
    let mut cycles = early_cycles(voltage).map(|turns| at(turns.start)..at(turns.end));
    let left = |cycle: &Range<usize>| part.end.saturating_sub(cycle.end);
    let later = cycles.next()?;
    let told = if 2 * left(&later) >= later.len() { later } else { cycles.next().unwrap_or(later) };
    (!told.is_empty() && left(&told) >= FEWEST).then_some(told)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scope;
    use std::f64::consts::TAU;

    /// Three periods of a sine of 1 s with a displacement of 1 µm/V, at 200 Hz.
    fn session() -> Session {
        let voltage: Vec<f64> = (0..=6000).map(|k| (TAU * f64::from(k) / 2000.0).sin()).collect();
        let instants: Vec<u32> = (0..=600).map(|k| 10 * k).collect();
        let displacement = instants.iter().map(|&tick| voltage[tick as usize]).collect();
        Session::new("sine".into(), voltage, instants, displacement, 5e-4)
    }

    /// The sensor's reading and something on top, a function of the instant.
    fn run(session: &Session, more: impl Fn(usize) -> f64) -> Run {
        let estimated = session.displacement[1..].iter().enumerate().map(|(k, y)| y + more(k)).collect();
        Run { estimated, half_width: Vec::new(), status: Vec::new() }
    }

    #[test]
    fn a_cycle_lies_between_the_second_and_the_fourth_reversal_where_enough_follows() {
        let found = cycle(&session(), &(0..600)).unwrap();
        // Bottoms at 0.75 and 1.75 s; index 0 is the instant at 5 ms.
        assert_eq!(found, 149..349);
        // The second reversal after 0.5 s is the top at 1.25 s.
        assert_eq!(cycle(&session(), &(100..600)).unwrap(), 249..449);
        assert_eq!(cycle(&session(), &(0..449)).unwrap(), 149..349, "half a cycle follows the second");
        assert_eq!(cycle(&session(), &(0..448)).unwrap(), 49..249, "less follows the second");
        assert_eq!(cycle(&session(), &(0..250)), None, "there is no third reversal");
    }

    #[test]
    fn a_constant_is_gone_once_it_is_told() {
        let session = session();
        let part = Scope::ALL.part(&session).unwrap();
        let off = run(&session, |k| if k < 349 { 0.5 } else { 0.75 });
        let figures = ToldFigures::of(&session, &part, &off, &off);
        assert!((figures.one_cycle.unwrap().mae_um - 0.25).abs() < 1e-12);
        assert!(figures.nothing.mae_um > 0.5 && figures.offset.mae_um < 0.13);
        assert!((figures.offset.rmse_um - figures.nothing.rmse_without_offset_um).abs() < 1e-12);
    }

    #[test]
    fn a_zero_takes_the_error_at_that_time_off_what_follows() {
        let session = session();
        let part = Scope { zero_at_s: Some(1.0), ..Scope::ALL }.part(&session).unwrap();
        let off = run(&session, |k| if k < 300 { 0.5 } else { 0.75 });
        let correction = Correction::of(Told::Nothing, &session, &part, &off).unwrap();
        assert_eq!((correction.at(198), correction.at(199), correction.at(599)), (0.0, 0.5, 0.5));
        let figures = correction.figures(&session, &off, 1.0);
        assert!((figures.max_um - 0.25).abs() < 1e-12 && (figures.mae_um - 0.1875).abs() < 1e-12, "{figures:?}");
    }

    /// A sine of which less is left after its first cycle than went before.
    #[test]
    fn what_follows_one_cycle_is_judged_by_the_stroke_of_all_that_is_scored() {
        let mut session = session();
        for (y, &tick) in session.displacement.iter_mut().zip(&session.instants) {
            *y *= if tick > 2600 { 0.5 } else { 1.0 };
        }
        let part = Scope::ALL.part(&session).unwrap();
        let (nothing, first) = (run(&session, |k| if k < 400 { 0.0 } else { 0.1 }), run(&session, |_| 0.1));
        let figures = ToldFigures::of(&session, &part, &nothing, &first);
        let strokes = [figures.nothing, figures.first_reading, figures.one_cycle.unwrap()].map(|of| of.stroke_um);
        assert!(strokes.iter().all(|&stroke| (stroke - 2.0).abs() < 1e-3), "{strokes:?}");
    }

    #[test]
    fn a_log_at_rest_has_no_cycle() {
        let still = Session { voltage: vec![1.0; 6001], ..session() };
        let part = Scope::ALL.part(&still).unwrap();
        let off = run(&still, |_| 0.1);
        assert_eq!(Correction::of(Told::OneCycle, &still, &part, &off), Err(ScopeError::NoCycle));
        assert!(ToldFigures::of(&still, &part, &off, &off).one_cycle.is_none());
    }
}
