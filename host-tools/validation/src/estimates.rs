//! The f32 core's estimate beside the sensor, a row a measured instant, in the units of the log's file.

use crate::run::Run;
use crate::scope::{Scope, ScopeError, time_s};
use crate::told::{Correction, Told};
use estimator_core::{Admitted, Status};
use recordings::prepare::Recipe;
use recordings::session::Session;
use std::fmt::Write;

/// An estimate beside the sensor.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Instant {
    /// When it happened, s since the log's first sample (the sensor's delay is taken off).
    pub time_s: f64,
    /// Voltage as recorded, V.
    pub voltage: f64,
    /// Sensor as recorded, µm.
    pub displacement: f64,
    /// Estimate, µm with the sensor's zero.
    pub estimate: f64,
    /// Half-width of its interval, µm; `None` where there is none.
    pub half_width: Option<f64>,
    /// What was raised on the way to it.
    pub status: Status,
    /// It counts in the errors.
    pub scored: bool,
}

/// A log's estimates, at the measured instants after the first; of the first there is none.
#[derive(Clone, PartialEq, Debug)]
pub struct Estimates {
    /// Name of the log.
    pub log: String,
    /// In the order of time.
    pub instants: Vec<Instant>,
}

/// Runs a table's f32 core over a session from its beginning. The recipe, by which the session was prepared, leads back to
/// the file's units and zeros.
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
    let part = scope.part(session)?;
    let start = (told == Told::FirstReading).then_some(session.displacement[0]);
    let run = Run::of::<f32>(table, session, start, None);
    let correction = Correction::of(told, session, &part, &run)?;
    // When it was told follows from a run that was not.
    let run = Run::of::<f32>(table, session, start, correction.told());
    let displacement = |um: f64| (um + recipe.displacement_zero_um) / recipe.displacement_scale;
    let instants = session.instants.iter().zip(&session.displacement).skip(1).enumerate();
    let instants = instants.map(|(k, (&instant, &measured))| Instant {
        time_s: time_s(session, instant),
        voltage: (session.voltage[instant as usize] + recipe.voltage_zero_v) / recipe.voltage_scale,
        displacement: displacement(measured),
        estimate: displacement(run.estimated[k] - correction.at(k)),
        half_width: run.half_width[k].map(|half| half / recipe.displacement_scale.abs()),
        status: run.status[k],
        scored: correction.scored.contains(&k),
    });
    Ok(Estimates { log: session.name.clone(), instants: instants.collect() })
}

impl Estimates {
    /// Heading of [`csv`](Self::csv).
    pub const HEADING: &str = "time_s,voltage_V,displacement_um,estimate_um,half_width_um,status,scored,log\n";

    /// A row an instant: numbers with six decimals (none where there is no interval), the names of the status bits joined by `|`, 1 where the row counts
    /// in the errors, and the log's name.
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
            let names: Vec<&str> = status.iter_names().map(|(name, _)| name).collect();
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{time_s:.6},{voltage:.6},{displacement:.6},{estimate:.6},{half_width},{},{},{log}",
                names.join("|"),
                u8::from(scored)
            );
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
            displacement: -120.0,
            estimate: -119.5,
            half_width: Some(0.25),
            status: Status::NOT_SETTLED | Status::CLAMPED,
            scored: true,
        };
        let estimates = Estimates { log: "a, \"b\"".to_owned(), instants: vec![instant] };
        let expected = "0.005000,1.000000,-120.000000,-119.500000,0.250000,CLAMPED|NOT_SETTLED,1,\"a, \"\"b\"\"\"\n";
        assert_eq!(estimates.csv(), expected);
        assert_eq!(Estimates::HEADING.split(',').count(), 8);
    }
}
