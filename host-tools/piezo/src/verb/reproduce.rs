//! `piezo reproduce`: the thesis's tables and figures beside those of the same models on the synthetic rig, or on the
//! user's own logs.

use super::identify::zeros;
use super::print::{out, progress};
use crate::option::{Choice, LogOptions, PrepareArgs, SearchArgs, choice, limit};
use crate::{output, remedy};
use anyhow::{Result, ensure};
use clap::Args;
use identification::calibration::CalibrationOptions;
use identification::cost::Feedback;
use identification::{Conditions, Job, ModelChoice, Role};
use recordings::rig::Rig;
use report::{ReproductionReport, Section};
use serde_json::{Map, Value};
use std::path::PathBuf;
use thesis::{Bench, Item, QUICK_SEEDS};

/// Arguments of `piezo reproduce`.
#[derive(Args, Debug)]
pub struct Reproduce {
    /// What of the thesis.
    #[arg(value_name = "ITEM", value_parser = choice(ITEMS), default_value = "errors")]
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
    #[arg(long, default_value_t = 1, conflicts_with = "logs")]
    pub rig_seed: u64,
    /// Seeds of devices and searches that `elsewhere` takes medians over; 10 for figures to rely on, some minutes.
    #[arg(long, default_value_t = QUICK_SEEDS, value_parser = clap::value_parser!(u32).range(1..=100))]
    pub seeds: u32,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// Preparation of the logs. `auto` takes the rig's known zeros, 0 V and 0 µm.
    #[command(flatten)]
    pub prepare: PrepareArgs,
    /// The search.
    #[command(flatten)]
    pub search: SearchArgs,
}

/// What can be reproduced.
const ITEMS: [Choice<Item>; 13] = [
    (Item::Errors, Item::Errors.name(), "Validation errors: Tables 4.8, 5.3, 5.4, 5.5, Figures 4.11 and 5.1 to 5.6"),
    (Item::SamplingTime, Item::SamplingTime.name(), "Validation error over the sampling time: Table 4.4, Figure 4.8"),
    (Item::Parameters, Item::Parameters.name(), "Parameters and their ranges: Tables 4.5, 4.6, 5.2"),
    (
        Item::Convergence,
        Item::Convergence.name(),
        "Modelling and validation error over the search: Table 4.7, Figures 4.9 and 4.10",
    ),
    (Item::BlackBox, Item::BlackBox.name(), "NARX with and without extrema: Table 5.1"),
    (Item::Search, Item::Search.name(), "Population and bits of the search: Tables C.1, C.2"),
    (Item::Loops, Item::Loops.name(), "Recorded signals and loops: Appendix B"),
    (Item::Features, Item::Features.name(), "Rate dependence, frequency range, reversibility: Table 3.1"),
    (Item::Tracking, Item::Tracking.name(), "The rig driven by each model's inverse, beside plain scaling"),
    (Item::ExtremumTerms, Item::ExtremumTerms.name(), "The extremum terms tried on every model: Section 6.2"),
    (Item::Optimisers, Item::Optimisers.name(), "Optimisers at equal budget: Section 6.2"),
    (
        Item::Elsewhere,
        Item::Elsewhere.name(),
        "What was learnt judged on what was not: other sessions, amplitudes, frequencies, waveforms, devices",
    ),
    (Item::All, Item::All.name(), "Everything"),
];

/// Runs the verb.
pub fn run(arguments: &Reproduce) -> Result<bool> {
    let items = Item::asked(&arguments.items);
    if let Some(folder) = &arguments.out {
        ensure!(!folder.exists() || folder.is_dir(), "{}: is a file, --out names a folder", folder.display());
    }
    let (job, rig) = job(arguments)?;
    let length =
        items.iter().map(|item| item.generations(&job.search, arguments.seeds)).sum::<u64>() + job.generations_before();
    let bar = progress(length);
    let mut step = |model: estimator_core::Model, best: f64| {
        bar.set_prefix(model.to_string());
        bar.set_message(format!("{best:.4} µm"));
        bar.inc(1);
    };
    let mut bench = Bench::new(job, rig, remedy::sentence, &mut step)?;
    bench.seeds = arguments.seeds;
    let sections = thesis::run(&mut bench, &items, &mut step)?;
    bar.finish_and_clear();
    let facts = facts(&bench);
    if let Some(folder) = &arguments.out {
        let shown: Vec<&Section> = sections.iter().map(|(_, section)| section).collect();
        let html = report::reproduction(&ReproductionReport { sections: &shown, whose: bench.whose(), facts: &facts })?;
        output::folder(folder)?;
        output::write(&folder.join("reproduce.html"), html)?;
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
        None => (arguments.files.read_all(&arguments.logs)?, arguments.files.read_all(&arguments.validate_on)?),
    };
    let prepare = (&arguments.prepare).into();
    let job = Job {
        training,
        held_out,
        hold_out,
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
    let (recipe, search) = (&bench.prepared.setting.recipe, bench.search());
    let used = |role: Role| {
        let logs = bench.prepared.logs.iter().filter(|log| log.role == role);
        logs.map(|log| format!("{} {:.2} … {:.2} s", log.file, log.from_s, log.to_s)).collect::<Vec<_>>().join(", ")
    };
    let actuator = match &bench.rig {
        Some(rig) => format!("the synthetic rig, seed {}", rig.seed),
        None => "that of the given logs".to_owned(),
    };
    let facts = [
        ("Actuator", actuator),
        ("Modelled", used(Role::Training)),
        ("Held out", used(Role::HeldOut)),
        ("Zero and delay", zeros(recipe)),
        ("Tick", format!("{} µs, forward Euler", recipe.tick_us)),
        (
            "Search",
            format!(
                "seed {}; Voigt family {} rounds of {} generations of {} chromosomes of {} bits a gene, the others {} \
                 candidates a searched number by {}",
                search.seed,
                search.rounds,
                search.generations,
                search.population,
                search.bits,
                search.evaluations,
                search.optimiser
            ),
        ),
        ("Tool", format!("piezo {}", env!("CARGO_PKG_VERSION"))),
    ];
    let doubts = bench.prepared.estimates.iter().chain(&bench.prepared.delay_at_bound);
    let doubts = doubts.map(|doubt| ("Doubt".to_owned(), remedy::doubt(doubt)));
    facts.into_iter().map(|(name, what)| (name.to_owned(), what)).chain(doubts).collect()
}
