//! What a model is worth elsewhere: learnt on one set of recordings, judged on others — later in the same session,
//! another session, another amplitude, another frequency, other waveforms, devices outside every model's class, and
//! devices that have changed since. Each estimator runs from its log's beginning, as a device does.
//!
//! Errors by what the estimator was told (nothing, the first reading, one cycle, the offset), medians and ranges over
//! devices and seeds, and which models a paired bootstrap tells from the best.

mod bootstrap;
mod judge;
mod subject;
mod summary;

use super::bench::Bench;
use crate::error::ThesisError;
use estimator_core::Model;
use identification::{Brief, Progress, SearchOptions};
use judge::{Judged, learn};
use rayon::prelude::*;
use report::{Grid, Section, shown};
use subject::{Subject, plants, sessions, thesis_rig};
use summary::{Range, Row, rows};

/// Steps of the progress bar for each seed: one a subject.
pub fn generations(_search: &SearchOptions) -> u64 {
    2 * plants::CATALOGUE.len() as u64 + 2
}

/// Learns on each subject and judges.
///
/// # Errors
/// The logs are a user's, or the measured recordings cannot be prepared.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    if bench.rig.is_none() {
        return Err(ThesisError::OwnRecordings);
    }
    let mut subjects: Vec<Subject> = Vec::new();
    for seed in 1..=bench.seeds {
        subjects.push(sessions(&bench.job, seed)?);
        subjects.push(thesis_rig(&bench.job, seed));
        subjects.extend(plants(&bench.job, seed));
    }
    let mut judged: Vec<Judged> = Vec::new();
    // As many at a time as there are threads: what is done is told in between.
    for some in subjects.chunks(rayon::current_num_threads().max(1)) {
        let found: Vec<Result<Vec<Judged>, ThesisError>> =
            some.par_iter().map(|subject| learn(subject, &bench.models)).collect();
        for of_one in found {
            judged.extend(of_one?);
            if let Some(&model) = bench.models.last() {
                progress(model, 0.0);
            }
        }
    }
    let rows = rows(&judged);
    Ok(Section {
        title: "Elsewhere: what was not learnt",
        tables: grids(&rows),
        notes: notes(&rows, bench),
        figures: Vec::new(),
        json: serde_json::to_string_pretty(&rows)?,
    })
}

/// A table for each condition.
fn grids(rows: &[Row]) -> Vec<Grid> {
    let of_a_condition = rows.chunk_by(|a, b| (&a.subject, &a.condition) == (&b.subject, &b.condition));
    of_a_condition.map(grid).collect()
}

fn grid(rows: &[Row]) -> Grid {
    // Chunks are not empty.
    let first = &rows[0];
    let caption = format!(
        "{}: {}. {} recording{}, stroke {} µm, sensor noise {} µm.",
        first.subject,
        first.condition,
        first.recordings,
        if first.recordings == 1 { "" } else { "s" },
        first.stroke_um.map_or("–".to_owned(), |stroke| stroke.told(1)),
        shown(first.noise_floor_um, 4),
    );
    let mut grid = Grid::new(caption)
        .words("model", 28)
        .numbers("found", 5)
        .numbers("told nothing", 12)
        .numbers("first reading", 12)
        .numbers("one cycle", 12)
        .numbers("without offset", 12)
        .numbers("RMS, no offset", 12)
        .numbers("± 95 %", 12)
        .numbers("holds %", 12)
        .numbers("±, one cycle", 12)
        .numbers("holds %", 12)
        .words("", 1);
    for row in rows {
        let cell = |range: Option<Range>| range.map_or("–".to_owned(), |range| range.told(3));
        let percent = |range: Option<Range>| range.map_or("–".to_owned(), |range| range.told(0));
        grid.row([
            row.name.clone(),
            format!("{}/{}", row.found, row.searched),
            cell(row.told_nothing_um),
            cell(row.told_first_reading_um),
            cell(row.told_one_cycle_um),
            cell(row.without_offset_um),
            cell(row.rms_without_offset_um),
            cell(row.interval_um),
            percent(row.coverage_percent),
            cell(row.interval_one_cycle_um),
            percent(row.coverage_one_cycle_percent),
            match (row.best, row.different_from_best) {
                (true, _) => "best",
                (_, Some(true)) => "*",
                _ => "",
            }
            .to_owned(),
        ]);
    }
    grid
}

/// How the tables are to be read, and what they say of the enhanced model.
fn notes(rows: &[Row], bench: &Bench) -> Vec<String> {
    let seeds = bench.seeds;
    let Brief { of_a_number, of_voigt } = Brief::of(bench.search());
    let mut notes = vec![
        format!(
            "MAE in µm, the median over the recordings and in brackets their range; {seeds} seed{} of devices and searches.",
            if seeds == 1 { "" } else { "s" }
        ),
        format!(
            "Each search tries {of_a_number} candidates a number, of the Voigt family {of_voigt} in all; what a longer one would \
             find this does not tell."
        ),
        "Told nothing: at rest for long at the first voltage. One cycle: the mean error over a full cycle, the second where enough follows it, is \
         taken off, what follows is scored. Without offset: the mean error is taken off, which no device knows."
            .to_owned(),
        "Best: the least median without offset. *: different from it by a paired bootstrap over recordings and blocks of \
         them, 95 %; without a mark the difference is none that these recordings show."
            .to_owned(),
        "Found: searches with an admissible candidate. ±: half-width of the interval, relative to the first reading or the zero, \
         and once one cycle was told; holds: how often the sensor lay within.".to_owned(),
    ];
    let of = |model: Model| {
        let at = |row: &&Row| {
            row.subject == subject::THESIS_RIG && row.condition == subject::OTHER_AMPLITUDE && row.model == Some(model)
        };
        rows.iter().find(at)?.told_first_reading_um.map(|range| range.median)
    };
    if let (Some(voigt), Some(enhanced)) = (of(Model::Voigt), of(Model::Enhanced)) {
        notes.push(format!(
            "The thesis's enhanced model (5.3), learnt at ±20 V, is {enhanced:.3} µm off on a triangle of ±8 V, the Voigt model (4.8) \
             that it enhances {voigt:.3} µm: {:.1} times {}.",
            (enhanced / voigt).max(voigt / enhanced),
            if enhanced > voigt { "worse" } else { "better" }
        ));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn every_model_has_a_row_in_every_condition_one_is_the_best_and_the_plays_have_an_interval() {
        let mut job = small().job;
        job.search.evaluations = 4;
        let devices: Vec<Subject> = plants(&job, 1).take(1).chain([thesis_rig(&job, 1)]).collect();
        let judged: Vec<Judged> = devices.iter().flat_map(|subject| learn(subject, &Model::ALL).unwrap()).collect();
        let rows = rows(&judged);
        for part in rows.chunk_by(|a, b| (&a.subject, &a.condition) == (&b.subject, &b.condition)) {
            assert_eq!(part.len(), Model::ALL.len() + 1, "{:?}", part[0]);
            assert_eq!(part.iter().filter(|row| row.best).count(), 1, "{:?}", part[0]);
            assert_eq!(part[0].recordings, 1);
            for row in part {
                let calibrated = row.model == Some(Model::GeneralisedPrandtlIshlinskii);
                assert_eq!(
                    (row.interval_um.is_some(), row.coverage_percent.is_some()),
                    (calibrated, calibrated),
                    "{row:?}"
                );
            }
            let rms = |row: &Row| row.rms_without_offset_um.zip(row.without_offset_um);
            assert!(part.iter().filter_map(rms).all(|(rms, mae)| rms.median >= mae.median), "{part:?}");
        }
        let text: String = grids(&rows).iter().map(|grid| grid.text() + "\n").collect();
        for words in ["other amplitude", "staircase", "multisine", "aged", "loaded", "warming", "straight line (2.1)"] {
            assert!(text.contains(words), "{words} is missing in {text}");
        }
        assert!(notes(&rows, &small()).iter().any(|note| note.contains("learnt at ±20 V")));
    }
}
