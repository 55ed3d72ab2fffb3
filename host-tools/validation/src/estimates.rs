//! The f32 core's estimates of a log, beside its sensor or without one: a row a recorded instant, in the units of
//! the log's file.

use crate::raised::{Raised, raised};
use crate::run::Run;
use crate::scope::{Scope, ScopeError, time_s};
use crate::told::{Correction, Told};
use estimator_core::{Admitted, Estimator, Range, Status};
use recordings::log::Log;
use recordings::prepare::{PrepareError, Recipe};
use recordings::session::Session;
use std::fmt::Write;

/// Of the limits: a reading and a model may be off by so much, and a start further away is worth a word.
const FAR: f64 = 0.01;

/// An estimate, beside the sensor where there is one.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Instant {
    /// When it happened, s since the log's first sample (the sensor's delay is taken off).
    pub time_s: f64,
    /// Voltage as recorded, V.
    pub voltage: f64,
    /// Sensor as recorded, µm; `None` of a log that was read without.
    pub displacement: Option<f64>,
    /// Estimate, µm with the sensor's zero.
    pub estimate: f64,
    /// Half-width of its interval, µm; `None` where there is none.
    pub half_width: Option<f64>,
    /// What was raised on the way to it.
    pub status: Status,
    /// It counts in the errors.
    pub scored: bool,
}

impl Instant {
    /// Estimate − sensor, µm.
    pub fn error(&self) -> Option<f64> {
        self.displacement.map(|measured| self.estimate - measured)
    }
}

/// A log's estimates, at the recorded instants after the first; of the first there is none.
#[derive(Clone, PartialEq, Debug)]
pub struct Estimates {
    /// Name of the log.
    pub log: String,
    /// In the order of time.
    pub instants: Vec<Instant>,
    /// The zero that was taken at a time, where one was ([`Known::Zero`]).
    pub zero: Option<Zero>,
    /// Where the model is at the first sample's voltage, µm with the sensor's zero, where that is not where it was said
    /// to start ([`Known::Start`]).
    pub starts_um: Option<f64>,
    /// How many instants are not among them, for the log has no voltage there ([`Log::holes`]).
    pub left_out: usize,
}

/// A zero that the estimates have taken.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Zero {
    /// The first instant that it holds for, counted from 0.
    pub instant: usize,
    /// What it has added to the estimates from then on, µm.
    pub by_um: f64,
}

/// Runs a table's f32 core over a session from its beginning. The recipe, by which the session was prepared, leads back
/// to the file's units and zeros.
///
/// # Errors
/// The scope does not fit the session, or there is no cycle that could be told.
pub fn estimates(
    table: &Admitted,
    session: &Session,
    recipe: &Recipe,
    scope: &Scope,
    told: Told,
) -> Result<Estimates, ScopeError> {
    let (part, told) = (scope.part(session)?, told.before(scope.zero_at_s.is_some()));
    let start = (told == Told::FirstReading).then_some(session.displacement[0]);
    let run = Run::of::<f32>(table, session, start, None);
    let correction = Correction::of(told, session, &part, &run)?;
    // When it was told follows from a run that was not.
    let run = Run::of::<f32>(table, session, start, correction.told());
    let mut estimates = Estimates::of(session, recipe, &run);
    for (k, instant) in estimates.instants.iter_mut().enumerate() {
        instant.displacement = Some(in_file(recipe, session.displacement[k + 1]));
        instant.estimate = in_file(recipe, run.estimated[k] - correction.at(k));
        instant.scored = correction.scored.contains(&k);
    }
    Ok(estimates)
}

/// What is known of the displacement of a log that has no sensor, in µm of the training's.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Known {
    /// Nothing: the actuator is taken to have rested at the first voltage.
    Nothing,
    /// Where it was at the first sample.
    Start(f64),
    /// Where it was at a time, as `zero` tells a device.
    Zero {
        /// That time, s since the log's first sample.
        at_s: f64,
        /// Where it then was.
        um: f64,
    },
}

/// Why there are no estimates of a voltage alone.
#[derive(Debug, thiserror::Error)]
pub enum UnmeasuredError {
    /// The log cannot be brought to the tick.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// No actuator of the table is where it is said to have started.
    #[error(
        "a start at {start_um} µm is none of this table's, whose displacements go from {min_um:.3} to {max_um:.3} µm by the training sensor's zero"
    )]
    Start {
        /// What was said.
        start_um: f64,
        /// The table's least.
        min_um: f64,
        /// The table's largest.
        max_um: f64,
    },
    /// The log has nothing at the zero's time.
    #[error(transparent)]
    Zero(#[from] ScopeError),
    /// The voltage at the zero is none that the table knows: there its model stands still, and a device takes no zero.
    #[error("no zero can be told at {at_s} s: the voltage is {volts} V there, beyond the table's {} … {} V", range.min, range.max)]
    Beyond {
        /// The zero's time, s since the log's first sample.
        at_s: f64,
        /// The voltage at the zero, as the file has it, V.
        volts: f64,
        /// The voltages that the table knows, as the file would have them, V.
        range: Range<f64>,
    },
}

/// Runs a table's f32 core over a log's voltage, whether or not a sensor is beside it, as does a device that is
/// switched on where the log begins. Over holes of the log the voltage goes straight, and there is no estimate in them.
///
/// # Errors
/// The log cannot be brought to the tick, or what is known lies outside the table or the log.
pub fn unmeasured(table: &Admitted, log: Log, recipe: &Recipe, known: Known) -> Result<Estimates, UnmeasuredError> {
    let row_s = |row: usize| log.start_s + row as f64 * log.sample_period;
    let holes: Vec<Range<f64>> =
        log.holes.iter().map(|hole| Range { min: row_s(hole.start), max: row_s(hole.end.saturating_sub(1)) }).collect();
    Ok(everywhere(table, log, recipe, known)?.without(&holes))
}

/// Where the model is at a session's first voltage, told that it starts at a displacement (µm, relative to its zero).
fn started(table: &Admitted, session: &Session, start: f64) -> f64 {
    let mut estimator = Estimator::<f64>::new(table);
    estimator.start_at(start);
    let first = session.rested_v.or(session.voltage.first().copied()).unwrap_or(0.0);
    let voltage = first + f64::from(table.voltage_zero_v);
    // What a look-ahead makes of the way there is over by the second tick.
    estimator.tick_volts(voltage);
    estimator.tick_volts(voltage).displacement
}

/// The estimates at all instants, in holes of the log, too.
fn everywhere(table: &Admitted, log: Log, recipe: &Recipe, known: Known) -> Result<Estimates, UnmeasuredError> {
    // What a sensor would have shown is not looked at, nor when.
    let recipe = Recipe { delay_ticks: 0, ..recipe.clone() };
    let nothing = vec![0.0; log.voltage.len()];
    let session = recipe.session(&recipe.cut(&Log { displacement: Some(nothing), ..log }))?;
    let of_model = |um: f64| um * recipe.displacement_scale - recipe.displacement_zero_um;
    let run = |start: Option<f64>, told: Option<usize>| Run::of::<f32>(table, &session, start, told);
    match known {
        Known::Nothing => Ok(Estimates::of(&session, &recipe, &run(None, None))),
        Known::Start(start_um) => {
            let start = of_model(start_um);
            let limits: Range<f64> = table.displacement_limits_um.of();
            if !limits.contains(start) {
                let ends = Range::of_values([limits.min, limits.max].map(|um| in_file(&recipe, um)));
                return Err(UnmeasuredError::Start { start_um, min_um: ends.min, max_um: ends.max });
            }
            let model = started(table, &session, start);
            let elsewhere = (start - model).abs() > FAR * limits.span();
            let starts_um = elsewhere.then(|| in_file(&recipe, model));
            Ok(Estimates { starts_um, ..Estimates::of(&session, &recipe, &run(Some(start), None)) })
        }
        Known::Zero { at_s, um } => {
            let part = Scope { zero_at_s: Some(at_s), ..Scope::ALL }.part(&session)?;
            // The last instant up to there, as a device is told: there is one, since the scope has found the time
            // within the log.
            let at = part.zero.map_or(0, |window| window.end.saturating_sub(1));
            let volts = session.instants.get(at + 1).and_then(|&tick| session.voltage.get(tick as usize));
            if let Some(&volts) = volts.filter(|&&volts| !table.voltage_range_v.contains(volts as f32)) {
                let [volts, min, max] = [volts, table.voltage_range_v.min.into(), table.voltage_range_v.max.into()]
                    .map(|volts| (1e3 * recipe.as_recorded(volts)).round() / 1e3);
                return Err(UnmeasuredError::Beyond { at_s, volts, range: Range { min, max } });
            }
            let mut run = run(None, Some(at));
            let off = run.estimated.get(at).map_or(0.0, |estimate| estimate - of_model(um));
            run.estimated.iter_mut().skip(at).for_each(|estimate| *estimate -= off);
            let zero = Zero { instant: at, by_um: -off / recipe.displacement_scale };
            Ok(Estimates { zero: Some(zero), ..Estimates::of(&session, &recipe, &run) })
        }
    }
}

/// A displacement in the units and from the zero of the log's file, µm, of one relative to the model's zero.
fn in_file(recipe: &Recipe, um: f64) -> f64 {
    (um + recipe.displacement_zero_um) / recipe.displacement_scale
}

impl Estimates {
    /// Heading of [`csv`](Self::csv) of a log with a sensor.
    pub const HEADING: &str = "time_s,voltage_V,displacement_um,estimate_um,half_width_um,status,scored,log\n";
    /// Heading of [`csv`](Self::csv) of a log without.
    pub const UNMEASURED_HEADING: &str = "time_s,voltage_V,estimate_um,half_width_um,status,log\n";

    fn of(session: &Session, recipe: &Recipe, run: &Run) -> Self {
        let instants = session.instants.iter().skip(1).enumerate().map(|(k, &instant)| Instant {
            time_s: time_s(session, instant),
            voltage: recipe.as_recorded(session.voltage[instant as usize]),
            displacement: None,
            estimate: in_file(recipe, run.estimated[k]),
            half_width: run.half_width[k].map(|half| half / recipe.displacement_scale.abs()),
            status: run.status[k],
            scored: false,
        });
        Self { log: session.name.clone(), instants: instants.collect(), zero: None, starts_um: None, left_out: 0 }
    }

    /// The same without the instants that lie in these times (s since the log's first sample).
    fn without(self, holes: &[Range<f64>]) -> Self {
        const ARITHMETIC: f64 = 1e-9;
        let wide = |hole: &Range<f64>| Range { min: hole.min - ARITHMETIC, max: hole.max + ARITHMETIC };
        let holes: Vec<Range<f64>> = holes.iter().map(wide).collect();
        // They are in the order of time.
        let next = |time_s: f64| holes.get(holes.partition_point(|hole| hole.max < time_s));
        let has = |row: &Instant| !next(row.time_s).is_some_and(|hole| hole.contains(row.time_s));
        let first_behind = |zero: Zero| self.instants.iter().take(zero.instant).filter(|row| has(row)).count();
        let zero = self.zero.map(|zero| Zero { instant: first_behind(zero), ..zero });
        let instants: Vec<Instant> = self.instants.iter().filter(|row| has(row)).copied().collect();
        Self { zero, left_out: self.instants.len() - instants.len(), instants, ..self }
    }

    /// How often each status bit was raised.
    pub fn raised(&self) -> Vec<Raised> {
        let statuses: Vec<Status> = self.instants.iter().map(|instant| instant.status).collect();
        raised(&statuses, |k| self.instants[k].time_s)
    }

    /// A row an instant: numbers with six decimals (none where there is no interval), the names of the status bits
    /// joined by `|`, 1 where the row counts in the errors, and the log's name.
    pub fn csv(&self) -> String {
        let mut text = String::new();
        let log = if self.log.contains(['"', ',', '\n', '\r']) {
            format!("\"{}\"", self.log.replace('"', "\"\""))
        } else {
            self.log.clone()
        };
        for row in &self.instants {
            let &Instant { time_s, voltage, displacement, estimate, half_width, status, scored } = row;
            let half_width = half_width.map_or(String::new(), |half| format!("{half:.6}"));
            let status = status.iter_names().map(|(name, _)| name).collect::<Vec<_>>().join("|");
            let (measured, counts) = match displacement {
                Some(um) => (format!("{um:.6},"), format!("{},", u8::from(scored))),
                None => (String::new(), String::new()),
            };
            // Writing to a string cannot fail.
            let _ =
                writeln!(text, "{time_s:.6},{voltage:.6},{measured}{estimate:.6},{half_width},{status},{counts}{log}");
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_with_a_comma_is_quoted_and_bits_are_named() {
        let instant = Instant {
            time_s: 0.005,
            voltage: 1.0,
            displacement: Some(-120.0),
            estimate: -119.5,
            half_width: Some(0.25),
            status: Status::NOT_SETTLED | Status::CLAMPED,
            scored: true,
        };
        let of = |instant| Estimates {
            log: "a, \"b\"".to_owned(),
            instants: vec![instant],
            zero: None,
            starts_um: None,
            left_out: 0,
        };
        let estimates = of(instant);
        let expected = "0.005000,1.000000,-120.000000,-119.500000,0.250000,CLAMPED|NOT_SETTLED,1,\"a, \"\"b\"\"\"\n";
        assert_eq!(estimates.csv(), expected);
        assert_eq!(Estimates::HEADING.split(',').count(), 8);
        let estimates = of(Instant { displacement: None, ..instant });
        let expected = "0.005000,1.000000,-119.500000,0.250000,CLAMPED|NOT_SETTLED,\"a, \"\"b\"\"\"\n";
        assert_eq!(estimates.csv(), expected);
        assert_eq!(Estimates::UNMEASURED_HEADING.split(',').count(), 6);
    }
}
