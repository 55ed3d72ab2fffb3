//! `piezo reproduce`: the thesis's tables and figures beside those of the same models on the synthetic rig, or on the
//! user's own logs.

use super::print::{out, progress};
use crate::option::{LogOptions, Overwrite, PrepareArgs, SearchArgs, asked, choice, limit, models};
use crate::output::{self, PAGE};
use ::calibration::CalibrationOptions;
use anyhow::{Result, ensure};
use clap::Args;
use clap::builder::TypedValueParser;
use estimator_core::Model;
use identification::cost::Feedback;
use identification::{Conditions, Job, ModelChoice};
use recordings::Role;
use recordings::rig::Rig;
use report::{ReproductionReport, Section};
use serde_json::{Map, Value};
use std::path::PathBuf;
use thesis::{Bench, Item, QUICK_SEEDS};

/// Arguments of `piezo reproduce`.
#[derive(Args, Debug)]
pub struct Reproduce {
    /// What of the thesis.
    #[arg(value_name = "ITEM", value_parser = items(), default_value = "errors")]
    pub items: Vec<Item>,
    /// Your own modelling logs instead of the synthetic rig's.
    #[arg(long, num_args = 1.., value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Your own logs to validate on: they decide nothing.
    #[arg(long, num_args = 1.., value_name = "LOG", requires = "logs")]
    pub validate_on: Vec<PathBuf>,
    /// Hold out this fraction at the end of each of your modelling logs; 0.5 unless --validate-on names logs.
    #[arg(long, value_name = "FRACTION", allow_negative_numbers = true, requires = "logs")]
    pub hold_out: Option<f64>,
    /// Folder for reproduce.html, the tables and figures on one page.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print JSON: an array of objects, one a model and cost, of the errors alone; else an object with each item by its
    /// name.
    #[arg(long)]
    pub json: bool,
    /// How wide the limits may be within which the estimate is proven to stay, as a multiple of the training stroke.
    #[arg(long, default_value_t = 2.0, value_parser = limit, allow_negative_numbers = true)]
    pub limit: f64,
    /// Seed of the rig's noise.
    #[arg(long, default_value_t = 1, conflicts_with = "logs", allow_negative_numbers = true)]
    pub rig_seed: u64,
    /// Seeds of devices and searches that `elsewhere` takes medians over; 10 for figures to rely on, some minutes.
    #[arg(long, default_value_t = QUICK_SEEDS, value_parser = clap::value_parser!(u32).range(1..=100), allow_negative_numbers = true)]
    pub seeds: u32,
    /// Models that `elsewhere` learns, separated by commas; all where none is named.
    #[arg(long, value_name = "MODEL,…", value_delimiter = ',', value_parser = models())]
    pub models: Vec<Model>,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// Preparation of the logs. `auto` takes the rig's known zeros, 0 V and 0 µm.
    #[command(flatten)]
    pub prepare: PrepareArgs,
    /// How models are searched.
    #[command(flatten)]
    pub search: SearchArgs,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// A parser of an item's name.
fn items() -> impl TypedValueParser<Value = Item> {
    choice(Item::EACH.into_iter().chain([Item::All]).map(|item| (item, item.name(), item.description())))
}

/// Runs the verb.
pub fn run(arguments: &Reproduce) -> Result<bool> {
    let items = Item::asked(&arguments.items);
    let elsewhere = items.contains(&Item::Elsewhere);
    ensure!(elsewhere || arguments.models.is_empty(), "--models is for `elsewhere`, which is not asked for");
    let folder = arguments.out.as_deref().map(output::to_folder).transpose()?;
    if let Some(folder) = &arguments.out {
        arguments.overwrite.of(&folder.join("reproduce.html"), PAGE)?;
    }
    let (job, rig) = job(arguments)?;
    let length = items.iter().map(|item| item.generations(&job.search, arguments.seeds)).sum();
    let bar = progress(length);
    let mut step = |model: Model, best: f64| {
        bar.set_prefix(model.to_string());
        bar.set_message(format!("{best:.4} µm"));
        bar.inc(1);
    };
    let mut bench = Bench::new(job, rig, remedy::sentence)?;
    bench.seeds = arguments.seeds;
    bench.models = asked(&arguments.models);
    let sections = thesis::run(&mut bench, &items, &mut step)?;
    bar.finish_and_clear();
    let facts = facts(&bench);
    if let Some(folder) = &folder {
        let shown: Vec<&Section> = sections.iter().map(|(_, section)| section).collect();
        let html = report::reproduction(&ReproductionReport { sections: &shown, whose: bench.whose(), facts: &facts })?;
        folder.write_all([("reproduce.html", html)])?;
    }
    if arguments.json {
        out(&json(&sections)?);
    } else {
        print(arguments, &sections, &facts);
    }
    Ok(true)
}

/// What everything is identified on.
fn job(arguments: &Reproduce) -> Result<(Job, Option<Rig>)> {
    let own = !arguments.logs.is_empty();
    let rig = (!own).then(|| Rig { seed: arguments.rig_seed, ..Rig::default() });
    let hold_out = arguments.hold_out.unwrap_or(if own && arguments.validate_on.is_empty() { 0.5 } else { 0.0 });
    ensure!((0.0..1.0).contains(&hold_out), "--hold-out must lie between 0 and 1, not {hold_out}");
    let (training, held_out) = match &rig {
        Some(rig) => Bench::logs_of(rig),
        None => (
            arguments.files.read_all(&arguments.logs, false)?,
            arguments.files.read_all(&arguments.validate_on, false)?,
        ),
    };
    let prepare = (&arguments.prepare).into();
    let job = Job {
        training,
        held_out,
        hold_out,
        as_judged: false,
        prepare: if own { prepare } else { Bench::zeroed(&prepare) },
        model: ModelChoice::Auto,
        conditions: Conditions { limit: arguments.limit, ..Conditions::default() },
        calibration: CalibrationOptions::default(),
        cost: Feedback::Simulation.into(),
        search: (&arguments.search).into(),
    };
    Ok((job, rig))
}

/// The errors alone are an array, as they have always been.
fn json(sections: &[(Item, Section)]) -> Result<String> {
    if let [(Item::Errors, errors)] = sections {
        return Ok(errors.json.clone());
    }
    let named = sections.iter().map(|(item, section)| Ok((item.name().to_owned(), section.data()?)));
    Ok(serde_json::to_string_pretty(&named.collect::<Result<Map<String, Value>>>()?)?)
}

fn print(arguments: &Reproduce, sections: &[(Item, Section)], facts: &[(String, String)]) {
    for (index, (item, section)) in sections.iter().enumerate() {
        if sections.len() > 1 || *item != Item::Errors {
            out(&format!("{}== {} ==\n", if index > 0 { "\n" } else { "" }, section.title));
        }
        out(&section.text());
    }
    if !arguments.logs.is_empty() {
        out("");
        facts.iter().for_each(|(name, what)| out(&format!("{name}: {what}")));
    }
    if let Some(folder) = &arguments.out {
        out(&format!("\nWritten to {}: reproduce.html", folder.display()));
    }
}

/// Where the figures come from.
fn facts(bench: &Bench) -> Vec<(String, String)> {
    let (recipe, search) = (&bench.prepared.context.recipe, bench.search());
    let used = |role: Role| findings::used(&bench.prepared.logs, role);
    let actuator = match &bench.rig {
        Some(rig) => format!("the synthetic rig, seed {}", rig.seed),
        None => "that of the given logs".to_owned(),
    };
    let facts = [
        ("Actuator", actuator),
        ("Modelled", used(Role::Training)),
        ("Held out", used(Role::HeldOut)),
        ("Zero and delay", findings::zeros(recipe)),
        ("Tick", format!("{} µs, forward Euler", recipe.tick_us)),
        ("Search", findings::searches(search)),
        ("Tool", format!("piezo {}", env!("CARGO_PKG_VERSION"))),
    ];
    let doubts = bench.prepared.of_logs.iter().chain(&bench.prepared.of_delay);
    let doubts = doubts.map(|doubt| ("Doubt".to_owned(), remedy::doubt(doubt)));
    facts.into_iter().map(|(name, what)| (name.to_owned(), what)).chain(doubts).collect()
}
