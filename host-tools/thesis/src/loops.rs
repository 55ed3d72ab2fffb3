//! The recorded loops: Appendix B. For each log voltage and displacement against time and displacement against voltage
//! (Figures B.1 to B.18), with the identified enhanced model's (5.3) estimate laid over, and what they measure.

use super::bench::Bench;
use super::hysteresis::Loop;
use crate::error::ThesisError;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::validate::Comparison;
use identification::{CandidateError, Progress, SearchOptions};
use recordings::rig::EXCITATIONS;
use report::drawn;
use report::{Picture, Section, shown};
use serde::Serialize;

/// Logs that are drawn at most.
const DRAWN: usize = 24;

#[derive(Serialize)]
struct Row {
    log: String,
    role: &'static str,
    sensor: Loop,
    estimate: Loop,
    mae_percent: f64,
}

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    search.generations_of(&Model::VOIGT_FAMILY)
}

/// Identifies the enhanced model in simulation and lays it over each log.
///
/// # Errors
/// It has no admissible candidate.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    bench.identify(Feedback::Simulation, &[Model::Enhanced], progress);
    let attempt =
        bench.attempt(Feedback::Simulation, Model::Enhanced).ok_or(ThesisError::NotSearched(Model::Enhanced))?;
    let failed = |why: &CandidateError| ThesisError::Model { model: Model::Enhanced, source: why.clone() };
    let candidate = attempt.result.as_ref().map_err(failed)?;
    let role = |role: &'static str| move |log| (log, role);
    let mut logs: Vec<(&Comparison, &'static str)> = candidate
        .training
        .iter()
        .map(role("training"))
        .chain(candidate.held_out.iter().map(role("held out")))
        .collect();
    if bench.rig.is_some() {
        logs.sort_by_key(|(log, _)| place(&log.name));
    }
    let mut grid = bench
        .grid("Appendix B: what the loops measure. The thesis draws its own and prints no numbers of them.")
        .words("log", 8)
        .words("role", 8)
        .numbers("amplitude V", 9)
        .numbers("frequency Hz", 9)
        .numbers("stroke µm", 9)
        .numbers("width %", 8)
        .numbers("model's stroke µm", 9)
        .numbers("its width %", 8)
        .numbers("MAE %", 7);
    let mut rows = Vec::new();
    for (log, role) in &logs {
        let trace = &log.trace;
        let [sensor, estimate] =
            [&trace.measured, &trace.estimated].map(|values| Loop::of(&trace.time_s, &trace.voltage, values));
        grid.row([
            log.name.clone(),
            (*role).to_owned(),
            shown(Some(sensor.amplitude_v), 2),
            shown(sensor.frequency_hz, 2),
            shown(Some(sensor.stroke_um), 3),
            shown(sensor.width_percent, 2),
            shown(Some(estimate.stroke_um), 3),
            shown(estimate.width_percent, 2),
            shown(Some(log.mil.mae_percent), 2),
        ]);
        rows.push(Row { log: log.name.clone(), role, sensor, estimate, mae_percent: log.mil.mae_percent });
    }
    let mut notes = vec![format!(
        "Width: the largest distance between the falling and the rising branch at the same voltage, in % of the \
         stroke. The model is {}, identified in simulation on the modelling logs.",
        Model::Enhanced
    )];
    if logs.len() > DRAWN {
        notes.push(format!("The first {DRAWN} of {} logs are drawn.", logs.len()));
    }
    let numbered = bench.rig.is_some();
    let figures = logs.iter().take(DRAWN).filter_map(|(log, role)| picture(log, role, numbered)).collect();
    Ok(Section {
        title: "Loops: Appendix B, Figures B.1 to B.18",
        tables: vec![grid],
        notes,
        figures,
        json: serde_json::to_string_pretty(&rows)?,
    })
}

/// Where in Appendix B a log of the rig stands.
fn place(name: &str) -> usize {
    EXCITATIONS.iter().position(|excitation| excitation.name == name).unwrap_or(EXCITATIONS.len())
}

fn picture(log: &Comparison, role: &'static str, numbered: bool) -> Option<Picture> {
    let first = 3 * place(&log.name) + 1;
    let name = match numbered {
        true => format!("{}, as Figures B.{first} to B.{}", log.name, first + 2),
        false => log.name.clone(),
    };
    let (svg, caption) = drawn::appendix_b(log, &name)?;
    Some(Picture { svg, name, role, caption })
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn six_logs_with_what_the_rig_was_told_and_a_figure_each() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        let names: Vec<&str> = rows.iter().map(|row| row["log"].as_str().unwrap()).collect();
        assert_eq!(names, EXCITATIONS.map(|excitation| excitation.name));
        // Half a second of 1 Hz has no whole period.
        assert!(rows[0]["sensor"]["width_percent"].is_null());
        for (row, hertz) in rows.iter().zip([1.0, 10.0, 100.0].into_iter().cycle()).filter(|(_, hertz)| *hertz > 1.0) {
            let sensor = |name: &str| row["sensor"][name].as_f64().unwrap();
            assert!(
                (sensor("amplitude_v") - 20.0).abs() < 0.1 && (sensor("frequency_hz") / hertz - 1.0).abs() < 0.01,
                "{row}"
            );
            assert!((15.0..85.0).contains(&sensor("width_percent")), "{row}");
        }
        assert_eq!(rows[4]["role"], "held out");
        assert_eq!(section.figures.len(), 6);
        assert!(section.figures[5].name.ends_with("B.16 to B.18"), "{}", section.figures[5].name);
    }
}
