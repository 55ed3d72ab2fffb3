//! `piezo compare`: models × logs → errors on held-out data, parameters, time, instructions.

use super::print::{out, progress};
use crate::option::{Fitting, OPTIMISERS, Overwrite, STARTS, asked, choice, models};
use crate::output::{self, FACES, PAGE};
use anyhow::{Context, Result};
use clap::Args;
use comparison::Instructions;
use estimator_core::Model;
use identification::search::Optimiser;
use identification::{SearchOptions, Start};
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
    /// Folder for compare.html and each model's table.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Instructions per tick on the target, to be shown beside the errors: a JSON map of model names to
    /// {"max": …, "mean": …}.
    #[arg(long, value_name = "FILE.json")]
    pub instructions: Option<PathBuf>,
    /// Candidates that may be evaluated for each model, of all its structures together. A model in
    /// which nothing is to be searched takes one, its least-squares solution; one with several such structures one
    /// each.
    #[arg(long, value_name = "N", default_value_t = 4000, value_parser = clap::value_parser!(u32).range(1..=100_000_000), allow_negative_numbers = true)]
    pub budget: u32,
    /// Method for every model.
    #[arg(long, value_parser = choice(OPTIMISERS), default_value = "local")]
    pub optimiser: Optimiser,
    /// Where the search of an extremum model starts: at the best of the simpler models' solutions, or in the middle.
    #[arg(long, value_parser = choice(STARTS), default_value = "family")]
    pub start: Start,
    /// Seed; the same seed gives the same result on any number of threads.
    #[arg(long, default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u32,
    /// What is fitted to what.
    #[command(flatten)]
    pub fitting: Fitting,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &mut Compare) -> Result<bool> {
    arguments.fitting.open_session(None)?;
    let folder = arguments.out.as_deref().map(output::to_folder).transpose()?;
    if let Some(folder) = &arguments.out {
        arguments.overwrite.of(&folder.join("compare.html"), PAGE)?;
        for model in asked(&arguments.models) {
            arguments.overwrite.of(&folder.join(findings::table_name(model)), FACES[0].1)?;
        }
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
    let facts = findings::compared_how(&job, budget, &matrix);
    let mut written = None;
    if let Some(folder) = &folder {
        let html =
            report::comparison(&ComparisonReport { matrix: &matrix, notes: &findings::COMPARED, facts: &facts })?;
        let tables = findings::compared_tables(&matrix, job.cost, &job.search)?;
        written = arguments.out.as_deref().map(|out| findings::written_to(out, &tables));
        folder.write_all(tables.into_iter().chain([("compare.html".to_owned(), html)]))?;
    }
    if arguments.fitting.json {
        out(&serde_json::to_string_pretty(&matrix)?);
    } else {
        findings::compared_lines(&matrix, &facts).iter().for_each(|line| out(line));
        if let Some(written) = written {
            out(&format!("\n{written}"));
        }
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
