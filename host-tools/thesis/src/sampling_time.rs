//! Sampling time: Table 4.4 and Figure 4.8. The Voigt model (4.8) identified by one-step prediction at each printed
//! sampling time t_s (s), its mean absolute error on the held-out log in simulation (µm).

use super::bench::Bench;
use crate::error::ThesisError;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::{Candidate, CandidateError, Prepared, Problem, Progress, SearchOptions, identify};
use recordings::session::Session;
use report::drawn;
use report::{Picture, Section, shown};
use serde::Serialize;

/// Table 4.4: sampling time, µs, and MAE, µm. Its last row is split over three lines in print; this is one plausible
/// order, in which only the 0.3811 of 500 µs, which the thesis selects, is certain.
pub const TABLE_4_4: [(u32, f64); 7] =
    [(100, 0.5063), (200, 0.4777), (500, 0.3811), (1_000, 0.5054), (2_000, 0.6470), (5_000, 1.0365), (10_000, 0.6129)];

/// A log whose voltage spans less at a tick than this fraction of what it spans at the job's tick is a constant there.
const CONSTANT: f64 = 0.05;

#[derive(Serialize)]
struct Row {
    sampling_time_s: f64,
    mae_um: Option<f64>,
    /// Of the straight line through the modelling logs at this tick, on the held-out logs at it.
    straight_line_mae_um: Option<f64>,
    thesis_mae_um: f64,
    /// Modelling logs of which this tick leaves a constant voltage.
    constant_logs: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    failed: Option<String>,
}

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    TABLE_4_4.len() as u64 * search.generations_of(&[Model::Voigt])
}

/// Identifies at each sampling time and compares.
///
/// # Errors
/// None of the figures can be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    let mut rows = Vec::new();
    for (tick_us, thesis_mae_um) in TABLE_4_4 {
        let sampling_time_s = f64::from(tick_us) / 1e6;
        rows.push(match at(bench, tick_us, progress) {
            Ok(At { mae_um, straight_line_mae_um, constant_logs }) => Row {
                sampling_time_s,
                mae_um: Some(mae_um),
                straight_line_mae_um,
                thesis_mae_um,
                constant_logs,
                failed: None,
            },
            Err(error) => Row {
                sampling_time_s,
                mae_um: None,
                straight_line_mae_um: None,
                thesis_mae_um,
                constant_logs: 0,
                failed: Some((bench.say)(&error)),
            },
        });
    }
    let best = |of: fn(&Row) -> Option<f64>| {
        let known = rows.iter().filter_map(|row| Some((row.sampling_time_s, of(row)?)));
        known.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(time, _)| time)
    };
    let (ours, theirs) = (best(|row| row.mae_um), best(|row| Some(row.thesis_mae_um)));
    let mark = |time: f64, best: Option<f64>| if best == Some(time) { " ←" } else { "" };
    let caption = format!("Voigt (4.8) by OSP: MAE on {}, held out, in simulation.", bench.held_out());
    let mut grid = bench
        .grid(&caption)
        .words("sampling time s", 15)
        .numbers("MAE µm", 10)
        .numbers("straight line's", 10)
        .numbers("thesis MAE", 12)
        .numbers("modelling logs that become constant", 8);
    for row in &rows {
        let time = row.sampling_time_s;
        grid.row([
            format!("{time:.0e}"),
            shown(row.mae_um, 4) + mark(time, ours),
            shown(row.straight_line_mae_um, 4),
            shown(Some(row.thesis_mae_um), 4) + mark(time, theirs),
            row.constant_logs.to_string(),
        ]);
    }
    let mut notes = vec![
        "← is the smallest. Of the printed row, split over three lines, one plausible order is taken; only 0.3811 at \
         5e-4 s is certain."
            .to_owned(),
    ];
    let failed = rows.iter().filter_map(|row| Some(format!("{:.0e} s: {}", row.sampling_time_s, row.failed.as_ref()?)));
    notes.extend(failed);
    let points = |of: fn(&Row) -> Option<f64>| -> Vec<(f64, f64)> {
        rows.iter().filter_map(|row| Some((1e3 * row.sampling_time_s, of(row)?))).collect()
    };
    let name = "Error over the sampling time, as Figure 4.8".to_owned();
    let caption = format!("{} Each circle is the smallest of its line.", bench.whose());
    let (ours, theirs) = (points(|row| row.mae_um), points(|row| Some(row.thesis_mae_um)));
    let svg = drawn::sampling_times(&ours, &theirs, &format!("{name}. {caption}"));
    Ok(Section {
        title: "Sampling time: Table 4.4, Figure 4.8",
        tables: vec![grid],
        notes,
        figures: vec![Picture { svg, name, role: "held out", caption }],
        json: serde_json::to_string_pretty(&rows)?,
    })
}

/// What a tick comes to.
struct At {
    mae_um: f64,
    straight_line_mae_um: Option<f64>,
    constant_logs: usize,
}

/// Errors at a tick, and how many modelling logs are constant at it.
fn at(bench: &mut Bench, tick_us: u32, progress: Progress<'_>) -> Result<At, ThesisError> {
    let of_line = |problem: &Problem| Some(problem.baseline()?.held_out?.mae_um);
    let mae = |candidate: &Candidate| {
        candidate.held_out_figures().map(|figures| figures.mae_um).ok_or(ThesisError::NoFigures("held out"))
    };
    if tick_us == bench.prepared.context.recipe.tick_us {
        bench.identify(Feedback::Osp, &[Model::Voigt], progress);
        let attempt = bench.attempt(Feedback::Osp, Model::Voigt).ok_or(ThesisError::NotSearched(Model::Voigt))?;
        let mae_um = mae(attempt.result.as_ref().map_err(CandidateError::clone)?)?;
        return Ok(At { mae_um, straight_line_mae_um: of_line(bench.problem()), constant_logs: 0 });
    }
    let Prepared { problem, context, .. } = bench.at_tick(tick_us)?;
    let both = problem.training().zip(bench.problem().training());
    let constant_logs = both.filter(|(here, there)| span(here) < CONSTANT * span(there)).count();
    let fits = identify(&problem, &[Model::Voigt], Feedback::Osp, bench.search(), progress);
    let fit = fits.into_iter().next().ok_or(ThesisError::NotSearched(Model::Voigt))?;
    let mae_um = mae(&Candidate::new(&problem, fit, &context)?)?;
    Ok(At { mae_um, straight_line_mae_um: of_line(&problem), constant_logs })
}

fn span(session: &Session) -> f64 {
    let voltage = || session.voltage.iter().copied();
    voltage().fold(f64::NEG_INFINITY, f64::max) - voltage().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;
    use recordings::prepare::Decimation;

    #[test]
    fn the_seven_sampling_times_stand_beside_the_printed_errors() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        let times: Vec<f64> = rows.iter().map(|row| row["sampling_time_s"].as_f64().unwrap()).collect();
        assert_eq!(times, [1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2]);
        assert_eq!(rows[2]["thesis_mae_um"], 0.3811);
        assert!(rows.iter().all(|row| row["mae_um"].as_f64().is_some_and(|mae| mae > 0.01)), "{rows:?}");
        // At the tick that the model is for, it is better than no model.
        assert!(rows[2]["straight_line_mae_um"].as_f64() > rows[2]["mae_um"].as_f64(), "{}", rows[2]);
        let lines: Vec<f64> = rows.iter().filter_map(|row| row["straight_line_mae_um"].as_f64()).collect();
        assert!(
            lines.len() == 7 && lines.windows(2).any(|pair| pair[0] != pair[1]),
            "each tick has its own: {lines:?}"
        );
        // 100 Hz sampled every 5 or 10 ms always shows the same voltage: two logs.
        let constant: Vec<u64> = rows.iter().map(|row| row["constant_logs"].as_u64().unwrap()).collect();
        assert_eq!(constant, [0, 0, 0, 0, 0, 2, 2]);
        assert!(section.text().contains("Thesis: its own actuator.") && section.text().contains("5e-4"));
    }

    #[test]
    fn a_tick_that_the_logs_cannot_be_brought_to_is_a_row_with_a_reason() {
        let mut bench = small();
        bench.job.prepare.decimate = Decimation::Average;
        for log in bench.job.training.iter_mut().chain(&mut bench.job.held_out) {
            log.sample_period = 1.0 / 9_000.0;
        }
        let section = section(&mut bench, &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        assert!(rows[1]["failed"].as_str().unwrap().contains("no multiple of the tick rate"), "{rows:?}");
        assert!(section.notes.iter().any(|note| note.starts_with("2e-4 s:")), "{:?}", section.notes);
    }
}
