//! Features of the models: Table 3.1, measured instead of quoted. Rate dependence, frequency range and reversibility of
//! each model, identified in simulation.

use super::bench::Bench;
use super::monotone::Probes;
use super::range::{Frequencies, HOLDS, Held, hertz, words};
use super::rate::{DEPENDENT, Rate};
use super::without_lag::without_lag;
use crate::error::ThesisError;
use estimator_core::{Model, Table};
use identification::cost::Feedback;
use identification::{Candidate, Character, Progress, SearchOptions, StraightLine};
use report::{Section, shown, yes};
use serde::Serialize;

/// Table 3.1: rate dependence, frequency range of validity in Hz, reversibility; of the models it has.
pub fn printed(model: Model) -> Option<[&'static str; 3]> {
    match model {
        Model::Preisach => Some(["no", "–", "no"]),
        Model::PrandtlIshlinskii => Some(["no", "0.1–500", "yes"]),
        Model::Duhem => Some(["no", "1–40", "yes"]),
        Model::MaxwellSlip => Some(["quasi", "0–100", "yes"]),
        Model::Voigt => Some(["yes", "1–1000", "yes"]),
        _ => None,
    }
}

#[derive(Serialize)]
struct Row {
    model: Model,
    /// Its identified input lag or look-ahead is set to 0.
    without_lag: bool,
    thesis: Option<[&'static str; 3]>,
    rate_dependent: bool,
    stroke_change_percent: f64,
    rate: Rate,
    holds: String,
    errors: Vec<Held>,
    reversible: bool,
    probes: Probes,
}

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    search.generations_of(&Model::VOIGT_FAMILY) + 500
}

/// Identifies every model and measures it.
///
/// # Errors
/// The rig's further logs cannot be prepared.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    bench.identify(Feedback::Simulation, &Model::ALL, progress);
    let frequencies = Frequencies::of(bench)?;
    let mut rows = Vec::new();
    let mut failed = Vec::new();
    for model in ordered() {
        let Some(attempt) = bench.attempt(Feedback::Simulation, model) else { continue };
        match &attempt.result {
            Ok(candidate) => {
                rows.push(row(bench, candidate, Some(&frequencies), &candidate.table));
                let without = without_lag(&candidate.table);
                rows.extend(without.map(|table| row(bench, candidate, None, &table)));
            }
            Err(why) => failed.push(format!("{model}: {}", (bench.say)(why))),
        }
    }
    let mut summary = bench
        .grid("Table 3.1: features of the models, measured. The thesis's are quoted from the literature.")
        .words("model", 27)
        .words("rate-dependent", 8)
        .words("thesis", 6)
        .words("holds at Hz", 12)
        .words("thesis", 8)
        .words("reversible", 6)
        .words("thesis", 6);
    let mut measured = bench
        .grid("What was measured: loops of the model's own, memories from which it rises.")
        .words("model", 27)
        .numbers("stroke slow µm", 8)
        .numbers("fast µm", 8)
        .numbers("change %", 8)
        .numbers("width slow %", 8)
        .numbers("fast %", 8)
        .numbers("memories", 8)
        .numbers("rising %", 8)
        .numbers("flat", 5)
        .numbers("falling", 5);
    let mut errors =
        bench.grid("MAE in % of the stroke of each held-out log, by its frequency in Hz.").words("model", 27);
    for hz in frequencies.hertz() {
        errors = errors.numbers(&hertz(hz), 6);
    }
    for row in &rows {
        let [rate, range, reversible] = row.thesis.unwrap_or(["–"; 3]).map(str::to_owned);
        let model = format!("{}{}", row.model, if row.without_lag { ", no lag" } else { "" });
        let ours = [yes(row.rate_dependent), row.holds.clone(), yes(row.reversible)];
        let [our_rate, our_range, our_reversible] = ours;
        summary.row([model.clone(), our_rate, rate, our_range, range, our_reversible, reversible]);
        measured.row(measures(model.clone(), &row.rate, Some(&row.probes)));
        if !row.without_lag {
            errors.row(std::iter::once(model).chain(row.errors.iter().map(|held| shown(Some(held.mae_percent), 2))));
        }
    }
    if let Some(row) = rows.first().filter(|row| row.errors.iter().any(|held| held.straight_line_percent.is_some())) {
        let percent = row.errors.iter().map(|held| shown(held.straight_line_percent, 2));
        errors.row(std::iter::once(StraightLine::NAME.to_owned()).chain(percent));
    }
    if let Some(rig) = bench.rig.as_ref().and_then(Rate::of_rig) {
        measured.row(measures("the rig itself".to_owned(), &rig, None));
    }
    let (slow, fast) = rows.first().map_or((1.0, 100.0), |row| (row.rate.slow_hz, row.rate.fast_hz));
    let mut notes = vec![
        format!(
            "Rate-dependent: stroke or width (both in % of the slow stroke) changes by more than {DEPENDENT} % \
             between {} and {} Hz, where the identified model runs the same sequence of voltages at both.",
            hertz(slow),
            hertz(fast)
        ),
        format!(
            "Holds: the tested frequencies at which the MAE in simulation, from the first sample, stays below {HOLDS} \
             % of that log's stroke; {}.",
            if bench.rig.is_some() { "triangles, none of them modelled" } else { "those of the held-out logs" }
        ),
        "Reversible: from every memory met along the logs the next tick's displacement rises strictly with this tick's \
         voltage, over all that the logs' voltage moves in a tick. Flat from everywhere is a model behind a delay, \
         which this tick's voltage does not reach by the next."
            .to_owned(),
    ];
    if Character::of(bench.problem().training(), bench.problem().deadband).single_frequency() {
        notes.push(
            "The modelling logs have a single frequency: a lag imitates hysteresis there, so that what a model does \
             at another, its rate dependence among it, was taught by nothing."
                .to_owned(),
        );
    }
    if rows.iter().any(|row| row.without_lag) {
        notes.push(
            "No lag: rate-independent models run behind a first-order input lag here, or are seen ahead of their tick, \
             which is not Table 3.1's; these rows have the same parameters but that lag."
                .to_owned(),
        );
    }
    notes.extend(failed);
    Ok(Section {
        title: "Features of the models: Table 3.1",
        tables: vec![summary, measured, errors],
        notes,
        figures: Vec::new(),
        json: serde_json::to_string_pretty(&rows)?,
    })
}

/// Those of Table 3.1 in its order, then the others.
fn ordered() -> Vec<Model> {
    let table = [Model::Preisach, Model::PrandtlIshlinskii, Model::Duhem, Model::MaxwellSlip, Model::Voigt];
    table.into_iter().chain(Model::ALL.into_iter().filter(|model| !table.contains(model))).collect()
}

fn row(bench: &Bench, candidate: &Candidate, frequencies: Option<&Frequencies>, table: &Table) -> Row {
    let problem = bench.problem();
    let voltages = problem.training_voltages();
    let rate = Rate::of(table, voltages.min, voltages.max);
    let sessions: Vec<_> = problem.training().chain(problem.validation()).collect();
    let probes = Probes::of(table, sessions.iter().copied(), problem.stroke().span());
    let errors = frequencies.map(|frequencies| frequencies.errors(&candidate.table));
    Row {
        model: candidate.fit.model,
        without_lag: frequencies.is_none(),
        thesis: printed(candidate.fit.model),
        rate_dependent: rate.dependent(),
        stroke_change_percent: rate.stroke_change(),
        rate,
        holds: errors.as_ref().map_or("–".to_owned(), |errors| words(errors)),
        errors: errors.unwrap_or_default(),
        reversible: probes.invertible(),
        probes,
    }
}

fn measures(name: String, rate: &Rate, probes: Option<&Probes>) -> Vec<String> {
    let count = |of: fn(&Probes) -> usize| probes.map_or("–".to_owned(), |probes| of(probes).to_string());
    vec![
        name,
        shown(Some(rate.slow_stroke_um), 3),
        shown(Some(rate.fast_stroke_um), 3),
        // What rounds to nothing has no sign.
        shown(Some(rate.stroke_change()), 2).replace("-0.00", "0.00"),
        shown(Some(rate.slow_width_percent), 2),
        shown(Some(rate.fast_width_percent), 2),
        count(|probes| probes.probed),
        shown(probes.map(Probes::rising_percent), 1),
        count(|probes| probes.flat),
        count(|probes| probes.falling),
    ]
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;
    use serde_json::json;

    #[test]
    fn every_model_is_measured_and_those_of_the_table_stand_beside_it() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        let of =
            |model: &str| rows.iter().find(|row| row["model"] == model).unwrap_or_else(|| panic!("{model} is missing"));
        assert_eq!(of("voigt")["rate_dependent"], true);
        for model in ["prandtl-ishlinskii", "maxwell-slip", "duhem", "bouc-wen", "preisach"] {
            let of_model = rows.iter().filter(|row| row["model"] == model);
            let lags: Vec<_> = of_model.map(|row| (&row["without_lag"], &row["rate_dependent"])).collect();
            assert_eq!(lags, [(&json!(false), &json!(true)), (&json!(true), &json!(false))], "{model}");
        }
        assert_eq!(of("generalised-prandtl-ishlinskii")["thesis"], serde_json::Value::Null);
        assert_eq!(of("maxwell-slip")["thesis"][0], "quasi");
        assert_eq!(section.tables.len(), 3);
        assert!(section.tables.iter().all(|table| table.caption.ends_with("Thesis: its own actuator.")));
    }
}
