//! The lines that a validation prints of a log: figures by what the estimator was told, and what is to be said of them.

use crate::figures::row;
use crate::flaw::flaw_scored;
use crate::raised::remarks;
use crate::validated::{held, suspicion};
use identification::validate::{Comparison, Figures, Scope, Suspicion, ToldFigures};
use log_survey::{Flaw, flaws, gravest};
use recordings::log::Log;
use recordings::{LogUse, Role};
use serde_json::{Value, json};

/// The seconds of a log that a table was trained on.
#[derive(Clone, Copy, Debug)]
pub struct TrainedOn<'u> {
    /// The log as the table has it.
    pub used: &'u LogUse,
    /// From when to when, s since the first sample.
    pub at_s: (f64, f64),
}

/// Of a log that is one of those that a table was trained on, the seconds.
pub fn trained_on<'u>(uses: &'u [LogUse], log: &Log) -> Option<TrainedOn<'u>> {
    let mut training = uses.iter().filter(|used| used.role == Role::Training);
    training.find_map(|used| Some(TrainedOn { used, at_s: used.within(log)? }))
}

/// What became of a log's flaws that were to be left out.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Repair {
    /// So many measured instants are not scored.
    LeftOut(usize),
    /// They are more than half of the log, and are scored all the same.
    Hopeless,
}

impl Repair {
    /// Of what a repair says of the instants that it has left out.
    pub fn of(left_out: Option<usize>) -> Self {
        left_out.map_or(Self::Hopeless, Self::LeftOut)
    }
}

/// The figures of a log, or of all, under its name; where it is `zeroed` without those of an estimator that was told
/// the first reading, since no device that is zeroed later was.
pub fn rows(name: &str, mil: &Figures, told: &ToldFigures, settled: Option<&Figures>, zeroed: bool) -> Vec<String> {
    let first_reading = |figures| Some(figures).filter(|_| !zeroed);
    let lines = [
        ("  f64 (MIL)", first_reading(mil)),
        ("  f32 (SIL)", first_reading(&told.first_reading)),
        ("  f32, cold", Some(&told.nothing)),
        ("  f32, settled", settled),
        ("  f32, one cycle", told.one_cycle.as_ref()),
        ("  f32, no offset", Some(&told.offset)),
    ];
    let figures = lines.into_iter().filter_map(|(line, figures)| Some(row(line, figures?)));
    std::iter::once(name.to_owned()).chain(figures).collect()
}

/// A log's figures, and what is said of it, as JSON.
pub fn log_json(
    comparison: &Comparison,
    log: &Log,
    trained_on: Option<&TrainedOn<'_>>,
    suspicion: Option<&Suspicion>,
    repair: Option<Repair>,
) -> Value {
    let status: Vec<&str> = comparison.status.iter_names().map(|(name, _)| name).collect();
    let flaws = flaws_of(log, comparison.scored_s).into_iter();
    json!({
        "log": comparison.name,
        "mil": comparison.mil,
        "sil": comparison.sil,
        "mil_sil_um": comparison.mil_sil_um,
        "interval": comparison.interval,
        "interval_one_cycle": comparison.interval_one_cycle,
        "cold": comparison.cold,
        "told": comparison.told,
        "scored_s": comparison.scored_s,
        "zeroed_um": comparison.zeroed_um,
        "status": status,
        "trained_on_s": trained_on.map(|of| of.at_s),
        "suspicion": suspicion,
        "displacement_estimated": log.displacement_estimated,
        "left_out": match repair { Some(Repair::LeftOut(count)) => Some(count), _ => None },
        "beyond_repair": repair == Some(Repair::Hopeless),
        "flaws": flaws.map(|(worst, count)| json!({ "worst": worst, "count": count })).collect::<Vec<_>>(),
    })
}

/// The lines of a log.
pub fn of_log(
    comparison: &Comparison,
    log: &Log,
    trained_on: Option<&TrainedOn<'_>>,
    scope: &Scope,
    repair: Option<Repair>,
) -> Vec<String> {
    let cold = &comparison.cold;
    let mut said = Vec::new();
    if *scope != Scope::ALL {
        let (from, to) = comparison.scored_s;
        let zeroed = comparison.zeroed_um.map_or(String::new(), |um| format!("; cold was {um:+.4} µm off at the zero"));
        said.push(format!("scored: {from:.3} … {to:.3} s; the estimator runs from the log's beginning{zeroed}"));
    }
    said.push(match cold.settled_after_s {
        Some(after) => format!("cold: started as a device is, told nothing; settled: the same after {after:.2} s"),
        None => {
            "cold: started as a device is, told nothing; it never counts as settled, since the voltage does not turn \
                 at either end of half the table's range"
                .to_owned()
        }
    });
    if comparison.told.one_cycle.is_none() {
        said.push(
            "one cycle: the voltage makes no full one in what is scored, or next to nothing is left after it"
                .to_owned(),
        );
    }
    let since = if comparison.zeroed_um.is_some() { "told nothing, since the zero" } else { "since the first reading" };
    let intervals = [(since, &comparison.interval), ("told one cycle", &comparison.interval_one_cycle)];
    said.extend(intervals.into_iter().filter_map(|(since, interval)| Some(held(since, interval.as_ref()?))));
    said.push(format!("f32 differs from f64 by at most {:.2e} µm", comparison.mil_sil_um));
    if let Some(&TrainedOn { used, at_s: (from, to) }) = trained_on {
        if used.sha256 != log.sha256 {
            said.push(format!("it holds the samples of {}, written by another program", used.file));
        }
        let scored = comparison.scored_s;
        let (share, says) = match (from < scored.1 && scored.0 < to, from <= scored.0 && scored.1 <= to) {
            (false, _) => ("", "nothing of that is scored here"),
            (true, false) => ("a part of what is scored: ", "these errors prove nothing there"),
            (true, true) => ("all that is scored: ", "these errors prove nothing"),
        };
        said.push(format!("the table was trained on {share}{from:.2} … {to:.2} s of this log; {says}"));
    }
    let repaired = matches!(repair, Some(Repair::LeftOut(_)));
    let of_flaw = |(worst, count): &(Flaw, usize)| flaw_scored(worst, *count, repaired);
    said.extend(flaws_of(log, comparison.scored_s).iter().map(of_flaw));
    said.extend(repair.map(|of| match of {
        Repair::LeftOut(count) => format!("{count} measured instants are not scored (--repair)"),
        Repair::Hopeless => "more than half of it is no measurement: nothing was left out".to_owned(),
    }));
    if log.displacement_estimated {
        said.push(
            "its displacement is a device's estimate, no sensor's: these errors say nothing of the actuator".to_owned(),
        );
    }
    said.extend(Some(remarks(&comparison.raised)).filter(|remarks| !remarks.is_empty()));
    let zeroed = comparison.zeroed_um.is_some();
    let mut lines = rows(&comparison.name, &comparison.mil, &comparison.told, cold.settled.as_ref(), zeroed);
    lines.extend(said.iter().map(|said| format!("    {said}")));
    lines
}

/// Why the errors on a log say little of the table: what is no measurement in it before anything else.
pub fn suspected(comparison: &Comparison, log: &Log, found: &Suspicion, repair: Option<Repair>) -> String {
    let flawed = || flaws_of(log, comparison.scored_s).iter().any(|(worst, _)| worst.repairable());
    match repair {
        None if flawed() => format!(
            "what is no measurement in it, named above, may be all that is wrong: judge it with --repair. If it is not: {}",
            suspicion(found)
        ),
        _ => suspicion(found),
    }
}

/// The gravest of each kind of a log's flaws in what was scored, and how many there are of it. Of an estimate none
/// is looked for.
fn flaws_of(log: &Log, (from_s, to_s): (f64, f64)) -> Vec<(Flaw, usize)> {
    let mut found = if log.displacement_estimated { Vec::new() } else { flaws(log) };
    found.retain(|flaw| flaw.at().to_s >= from_s && flaw.at().from_s <= to_s);
    gravest(&found)
}
