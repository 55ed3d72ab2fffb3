//! `piezo compare`: models × logs → errors on held-out data, parameters, time, instructions.

use super::print::{out, progress};
use crate::option::{Fitting, OPTIMISERS, Overwrite, STARTS, asked, choice, models};
use crate::output::{self, PAGE};
use anyhow::{Context, Result};
use clap::Args;
use comparison::{Instructions, Judgement, Matrix, Row};
use estimator_core::Model;
use identification::search::Optimiser;
use identification::validate::Figures;
use identification::{Job, SearchOptions, Start, StraightLine};
use recordings::Role;
use report::ComparisonReport;
use serde::Deserialize;
use serde::de::IntoDeserializer;
use serde::de::value::Error;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Arguments of `piezo compare`.
#[derive(Args, Debug)]
pub struct Compare {
    /// Which models, separated by commas; all where none is named.
    #[arg(long, value_name = "MODEL,…", value_delimiter = ',', value_parser = models())]
    pub models: Vec<Model>,
    /// Folder for compare.html.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Instructions per tick on the target, to be shown beside the errors: a JSON map of model names to
    /// {"max": …, "mean": …}.
    #[arg(long, value_name = "FILE.json")]
    pub instructions: Option<PathBuf>,
    /// Candidates that may be evaluated for each model, of all its structures together. A model in
    /// which nothing is to be searched takes one, its least-squares solution; one with several such structures one
    /// each.
    #[arg(long, value_name = "N", default_value_t = 4000, value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub budget: u32,
    /// Method for every model.
    #[arg(long, value_parser = choice(OPTIMISERS), default_value = "local")]
    pub optimiser: Optimiser,
    /// Where the search of an extremum model starts: at the best of the simpler models' solutions, or in the middle.
    #[arg(long, value_parser = choice(STARTS), default_value = "family")]
    pub start: Start,
    /// Seed; the same seed gives the same result on any number of threads.
    #[arg(long, default_value_t = 1)]
    pub seed: u32,
    /// What is fitted to what.
    #[command(flatten)]
    pub fitting: Fitting,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Compare) -> Result<bool> {
    let folder = arguments.out.as_deref().map(output::to_folder).transpose()?;
    if let Some(folder) = &arguments.out {
        arguments.overwrite.of(&folder.join("compare.html"), PAGE)?;
    }
    let instructions = arguments.instructions.as_deref().map(read_instructions).transpose()?.unwrap_or_default();
    let Compare { optimiser, start, seed, .. } = *arguments;
    let job = arguments.fitting.job(SearchOptions { optimiser, start, seed, ..SearchOptions::default() })?;
    let budget = arguments.budget as usize;
    let models = asked(&arguments.models);
    let bar = progress(comparison::generations(&job, &models));
    let mut matrix = comparison::run(&job, &models, budget, remedy::sentence, &mut |model, cost| {
        bar.set_prefix(model.to_string());
        bar.set_message(format!("{cost:.4} µm"));
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    for row in &mut matrix.rows {
        row.instructions = instructions.iter().find(|(model, _)| *model == row.model).map(|(_, counts)| *counts);
    }
    let facts = facts(arguments, &job, &matrix);
    if let Some(folder) = &folder {
        let html = report::comparison(&ComparisonReport { matrix: &matrix, notes: &NOTES, facts: &facts })?;
        folder.write_all([("compare.html", html)])?;
    }
    if arguments.fitting.json {
        out(&serde_json::to_string_pretty(&matrix)?);
    } else {
        print(arguments, &matrix, &facts);
    }
    Ok(true)
}

/// Reads a JSON map of model names (`voigt-chain`) to instructions per tick (`{"max": 900, "mean": 840.5}`).
fn read_instructions(path: &Path) -> Result<Vec<(Model, Instructions)>> {
    let read = || -> Result<Vec<(Model, Instructions)>> {
        let map: BTreeMap<String, Instructions> = serde_json::from_slice(&std::fs::read(path)?)?;
        let model = |name: &str| Model::deserialize(IntoDeserializer::<Error>::into_deserializer(name));
        map.into_iter().map(|(name, counts)| Ok((model(&name)?, counts))).collect()
    };
    let remedy = "expected a map of model names to instructions per tick, {\"voigt\": {\"max\": 900, \"mean\": 840.5}}";
    read().with_context(|| format!("{}: {remedy}", path.display()))
}

/// How to read the figures.
const NOTES: [&str; 5] = [
    "Errors of the estimate in simulation, from the first sample on, on data that decided nothing: mean absolute (MAE), root \
     mean square (RMS), largest (MAX), and the mean absolute without the constant offset that re-zeroing removes; of the \
     stroke where it says %. Whoever chooses a model by them has used this data up: prove the choice on another log. The arrow \
     marks the smallest MAE.",
    "Straight line: the displacement proportional to the voltage and an offset, Eq. (2.1), by least squares through the training \
     logs, each weighing the same: what is left for a model to gain.",
    "Parameters: what was searched or solved for by least squares; a grid that was laid out before does not count.",
    "Evals: candidates that were evaluated, of the same budget for every model; a model in which nothing is searched takes one, \
     its least-squares solution, for each of its structures.",
    "Seconds: wall-clock time of the model's own search. An extremum model starts from the results of the simpler ones of \
     its family, whose evaluations and time are theirs (--start random: it does not).",
];

/// What every model saw, and how.
fn facts(arguments: &Compare, job: &Job, matrix: &Matrix) -> Vec<(String, String)> {
    let used = |role| findings::used(&matrix.logs, role);
    let recipe = &matrix.recipe;
    let facts = [
        ("Every model fitted to", used(Role::Training)),
        ("Held out", used(Role::HeldOut)),
        ("Zero and delay", remedy::zeros(recipe)),
        ("Tick", format!("{} µs, {} where it is the Voigt family's", recipe.tick_us, arguments.fitting.scheme)),
        ("Cost", job.cost.to_string()),
        (
            "Search",
            format!(
                "{} evaluations a model at most, by {}, seed {}",
                arguments.budget, arguments.optimiser, arguments.seed
            ),
        ),
        ("Tool", format!("piezo {}", env!("CARGO_PKG_VERSION"))),
    ];
    let doubts = matrix.doubts.iter().map(|doubt| ("Doubt".to_owned(), remedy::doubt(doubt)));
    let left_out = remedy::left_out(job, recipe, &matrix.problem).into_iter().map(|said| ("Left out".to_owned(), said));
    facts.into_iter().map(|(name, what)| (name.to_owned(), what)).chain(left_out).chain(doubts).collect()
}

fn print(arguments: &Compare, matrix: &Matrix, facts: &[(String, String)]) {
    let names = matrix.held_out();
    let counted = matrix.counted();
    let heading = |first: &str| {
        format!(
            "{first:<34} {:>8} {:>8} {:>8} {:>7} {:>7} {:>11}",
            "MAE µm", "RMS µm", "MAX µm", "MAE %", "RMS %", "MAE, no off"
        )
    };
    let all =
        format!("held out, {}", if let [name] = names[..] { name.to_owned() } else { format!("{} logs", names.len()) });
    let costs = if counted { format!(" {:>9} {:>9}", "instr max", "mean") } else { String::new() };
    out(&format!(
        "{} {:>9} {:>9} {:>6} {:>6} {:>8}{costs}",
        heading(&all),
        "train MAE",
        "train RMS",
        "param.",
        "evals",
        "seconds"
    ));
    let nearest = matrix.nearest();
    let first = |row: &Row| format!("{}{}", if nearest == Some(row.model) { "→ " } else { "  " }, row.model);
    let baseline = matrix.straight_line.as_ref().map(|baseline| &baseline.errors);
    let straight = format!("  {}", StraightLine::NAME);
    for row in &matrix.rows {
        let counts = row.instructions.map_or_else(
            || format!(" {:>9} {:>9}", "–", "–"),
            |counts| format!(" {:>9.0} {:>9.1}", counts.max, counts.mean),
        );
        let counts = if counted { counts } else { String::new() };
        match &row.result {
            Judgement::Identified(errors) => out(&format!(
                "{} {:>9.4} {:>9.4} {:>6} {:>6} {:>8.2}{counts}",
                line(&first(row), &errors.held_out.all),
                errors.training.all.mae_um,
                errors.training.all.rmse_um,
                errors.parameters,
                row.evaluations,
                row.seconds
            )),
            Judgement::Failed { failed } => out(&format!("{:<34} {failed}", first(row))),
        }
    }
    if let Some(errors) = baseline {
        out(&format!(
            "{} {:>9.4} {:>9.4} {:>6} {:>6} {:>8}{}",
            line(&straight, &errors.held_out.all),
            errors.training.all.mae_um,
            errors.training.all.rmse_um,
            errors.parameters,
            "–",
            "–",
            if counted { format!(" {:>9} {:>9}", "–", "–") } else { String::new() }
        ));
    }
    for (index, name) in names.iter().enumerate().filter(|_| names.len() > 1) {
        out(&format!("\n{}", heading(&format!("held out, {name}"))));
        for row in &matrix.rows {
            if let Some(log) = row.errors().and_then(|errors| errors.held_out.logs.get(index)) {
                out(&line(&first(row), &log.errors));
            }
        }
        if let Some(log) = baseline.and_then(|errors| errors.held_out.logs.get(index)) {
            out(&line(&straight, &log.errors));
        }
    }
    out("");
    NOTES.iter().for_each(|note| out(note));
    out("");
    facts.iter().for_each(|(name, what)| out(&format!("{name}: {what}")));
    if let Some(folder) = &arguments.out {
        out(&format!("\nWritten to {}: compare.html", folder.display()));
    }
}

fn line(first: &str, figures: &Figures) -> String {
    format!(
        "{first:<34} {:>8.4} {:>8.4} {:>8.4} {:>7.3} {:>7.3} {:>11.4}",
        figures.mae_um,
        figures.rmse_um,
        figures.max_um,
        figures.mae_percent,
        figures.rmse_percent,
        figures.mae_without_offset_um
    )
}
