//! How far an admitted table's estimate is from the sensor, in simulation: the f64 reference (MIL) and the f32 core
//! that the target runs (SIL) side by side.

use crate::coverage::Coverage;
use crate::figures::Figures;
use crate::raised::{Raised, raised};
use crate::run::Run;
use crate::scope::{Part, Scope, ScopeError, time_s};
use crate::told::{Correction, Told, ToldFigures, stroke};
use crate::trace::Trace;
use estimator_core::{Admitted, Status};
use recordings::session::Session;
use serde::Serialize;

/// Part of the error told the first reading, both without their offsets, that the error told nothing has at most where
/// the sensor's zero is another.
const LESS: f64 = 0.9;

/// The f32 core as a device starts: without the sensor's first reading, from rest at the first voltage.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Cold {
    /// All that is scored.
    pub all: Figures,
    /// From where it counts as settled ([`Status::NOT_SETTLED`]); `None` where it never does.
    pub settled: Option<Figures>,
    /// When that is, s since the log's first sample.
    pub settled_after_s: Option<f64>,
}

/// One log against a table.
#[derive(Clone, PartialEq, Debug)]
pub struct Comparison {
    /// Name of the log.
    pub name: String,
    /// The f64 reference, told the sensor's first reading.
    pub mil: Figures,
    /// The f32 core, told the same.
    pub sil: Figures,
    /// Largest difference of the two estimates, µm.
    pub mil_sil_um: f64,
    /// How the interval of the f32 core did, told the first reading and relative to that, or told nothing and relative
    /// to the zero where there is one; `None` where the table has no interval, or the zero comes too soon.
    pub interval: Option<Coverage>,
    /// The same once the mean over a full cycle was told ([`Told::OneCycle`]), over what follows;
    /// `None` where the table has no interval, or the voltage makes no cycle.
    pub interval_one_cycle: Option<Coverage>,
    /// The f32 core told nothing.
    pub cold: Cold,
    /// The f32 core by what it was told.
    pub told: ToldFigures,
    /// What is scored, s since the log's first sample.
    pub scored_s: (f64, f64),
    /// What the f32 core, told nothing, was off where it was zeroed, µm; `None` where it was not.
    pub zeroed_um: Option<f64>,
    /// Every status bit that the f32 core raised, from the log's beginning on.
    pub status: Status,
    /// How often it raised each of them.
    pub raised: Vec<Raised>,
    /// The reference beside the sensor, from the log's beginning on, not zeroed.
    pub trace: Trace,
}

impl Comparison {
    /// Errors whose offset is left aside: told the first reading; or told nothing, where that is clearly less and most
    /// of it was a constant. A log may begin amid a motion; or at rest, by a sensor whose zero is not that of the
    /// training, and the first reading is then a memory that the actuator does not have and that its first swing ends.
    pub fn from_its_start(&self) -> &Figures {
        let Self { mil, told: ToldFigures { nothing, .. }, .. } = self;
        let less = nothing.rmse_without_offset_um < LESS * mil.rmse_without_offset_um;
        let shifted = nothing.offset_um.abs() > nothing.rmse_without_offset_um;
        if less && shifted { nothing } else { mil }
    }

    /// The reference's errors, told the first reading; the offset, and the errors without it, are of the run that
    /// [`from_its_start`](Self::from_its_start) takes.
    pub fn figures(&self) -> Figures {
        let off = self.from_its_start();
        Figures {
            offset_um: off.offset_um,
            mae_without_offset_um: off.mae_without_offset_um,
            rmse_without_offset_um: off.rmse_without_offset_um,
            mae_without_offset_percent: off.mae_without_offset_percent,
            rmse_without_offset_percent: off.rmse_without_offset_percent,
            ..self.mil
        }
    }
}

/// Runs a table over a session, all of which is scored but what it says that something was learnt from.
pub fn compare(table: &Admitted, session: &Session) -> Comparison {
    let all = session.lead_in.saturating_sub(1)..session.instants.len().saturating_sub(1);
    let compared = within(table, session, &Part { scored: all.clone(), zero: None });
    Comparison { trace: compared.trace.since(all.start), ..compared }
}

/// Runs a table over a session from its beginning and scores a part of it.
///
/// # Errors
/// The scope does not fit the session.
pub fn compare_within(table: &Admitted, session: &Session, scope: &Scope) -> Result<Comparison, ScopeError> {
    Ok(within(table, session, &scope.part(session)?))
}

fn within(table: &Admitted, session: &Session, part: &Part) -> Comparison {
    let first = session.displacement[0];
    let zero = part.zero.as_ref().map(|window| window.end - 1);
    let reference = Run::of::<f64>(table, session, Some(first), zero);
    let single = Run::of::<f32>(table, session, Some(first), zero);
    let nothing = Run::of::<f32>(table, session, None, zero);
    let before = Told::FirstReading.before(zero.is_some());
    let run = if before == Told::Nothing { &nothing } else { &single };
    let beside = Correction::of(before, session, part, run);
    let interval = beside.ok().and_then(|correction| correction.coverage(session, run));
    let told = ToldFigures::of(session, part, &nothing, &single);
    let instants = &session.instants[1..];
    let time = |k: usize| time_s(session, instants[k]);
    let difference = |(a, b): (&f64, &f64)| (a - b).abs();
    Comparison {
        name: session.name.clone(),
        mil: ToldFigures::of(session, part, &reference, &reference).first_reading,
        sil: told.first_reading,
        mil_sil_um: reference.estimated.iter().zip(&single.estimated).map(difference).fold(0.0, f64::max),
        interval,
        interval_one_cycle: after_one_cycle(table, session, part, &nothing),
        cold: cold(session, part, &nothing),
        told,
        scored_s: if part.scored.is_empty() {
            (0.0, 0.0)
        } else {
            (time(part.scored.start), time(part.scored.end - 1))
        },
        zeroed_um: part.zero.as_ref().map(|_| part.zeroed(&nothing.errors(session))),
        raised: raised(&single.status, time),
        status: single.status.into_iter().fold(Status::empty(), Status::union),
        trace: Trace {
            time_s: instants.iter().map(|&instant| time_s(session, instant)).collect(),
            // The last instant's own voltage is the one after the last tick that was run.
            voltage: instants.iter().map(|&tick| session.voltage[tick as usize]).collect(),
            measured: session.displacement[1..].to_vec(),
            estimated: reference.estimated,
        },
    }
}

/// How the interval does of a device that is told its mean error over one cycle; `nothing` is the run of one that
/// is told nothing.
fn after_one_cycle(table: &Admitted, session: &Session, part: &Part, nothing: &Run) -> Option<Coverage> {
    table.interval?;
    let correction = Correction::of(Told::OneCycle, session, part, nothing).ok()?;
    correction.coverage(session, &Run::of::<f32>(table, session, None, correction.told()))
}

fn cold(session: &Session, part: &Part, run: &Run) -> Cold {
    let stroke_um = stroke(session, &part.scored);
    let figures = |part: &Part| {
        let correction = Correction::of(Told::Nothing, session, part, run);
        // Only a cycle can be missing.
        correction.expect("needs no cycle").figures(session, run, stroke_um)
    };
    let settled = run.status.iter().position(|status| !status.contains(Status::NOT_SETTLED));
    let scored = settled.map(|from| from.max(part.scored.start)..part.scored.end).filter(|scored| !scored.is_empty());
    Cold {
        all: figures(part),
        settled: scored.map(|scored| figures(&Part { scored, ..part.clone() })),
        settled_after_s: settled.map(|from| time_s(session, session.instants[1..][from])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of a stroke of 10 µm, one of three by so much larger.
    fn off(constant_um: f64, spread_um: f64) -> Figures {
        Figures::of(&[constant_um, constant_um + spread_um, 10.0 + constant_um], &[0.0, 0.0, 10.0], 10.0)
    }

    #[test]
    fn errors_without_offset_are_of_the_start_that_another_zero_spoils_least() {
        let of = |mil: Figures, nothing: Figures| {
            let told = ToldFigures { nothing, first_reading: mil, one_cycle: None, offset: nothing };
            let cold = Cold { all: nothing, settled: None, settled_after_s: None };
            let (name, raised, trace) = (String::new(), Vec::new(), Trace::default());
            let (sil, status, scored_s, zeroed_um) = (mil, Status::empty(), (0.0, 1.0), None);
            let (interval, interval_one_cycle, mil_sil_um) = (None, None, 0.0);
            let judged = Comparison {
                name,
                mil,
                sil,
                mil_sil_um,
                interval,
                interval_one_cycle,
                cold,
                told,
                scored_s,
                zeroed_um,
                status,
                raised,
                trace,
            };
            judged.figures()
        };
        let (spoilt, nothing) = (off(0.1, 0.9), off(5.0, 0.3));
        let figures = of(spoilt, nothing);
        let without = |of: Figures| {
            let um = (of.offset_um, of.mae_without_offset_um, of.rmse_without_offset_um);
            (um, of.mae_without_offset_percent, of.rmse_without_offset_percent)
        };
        assert_eq!(without(figures), without(nothing));
        assert_eq!((figures.mae_um, figures.max_um), (spoilt.mae_um, spoilt.max_um), "as told the first reading");
        assert_eq!(without(of(off(0.1, 0.31), nothing)), without(off(0.1, 0.31)), "not clearly less");
        assert_eq!(without(of(spoilt, off(0.1, 0.3))), without(spoilt), "no other zero");
    }
}
