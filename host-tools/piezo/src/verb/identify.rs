//! `piezo identify`: logs → a proven parameter table and a report.

use super::print::{out, progress};
use crate::option::{CalibrationArgs, Fitting, Overwrite, SearchArgs, model_choice};
use crate::output::{self, FACES, Held, PAGE, PICTURE};
use anyhow::{Context, Result};
use clap::Args;
use estimator_core::Table;
use findings::figures::{heading, row};
use identifiability::Determination;
use identification::cost::Cost;
use identification::validate::{Comparison, Estimates, Scope, Told, ZERO_WINDOW_S, estimates};
use identification::{Candidate, Doubt, Job, ModelChoice, Outcome, SearchOptions, StraightLine};
use log_survey::Stretch;
use recordings::Role;
use recordings::prepare::Recipe;
use report::{Mark, Report};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Arguments of `piezo identify`.
#[derive(Args, Debug)]
pub struct Identify {
    /// Folder for table.toml, table.rs, table.bin, report.html and estimate.svg.
    #[arg(long)]
    pub out: PathBuf,
    /// Which model; `auto` tries every one and chooses by cross-validation inside the training data.
    #[arg(long, value_parser = model_choice(), default_value = "auto")]
    pub model: ModelChoice,
    /// Deliver the chosen model as it was judged, instead of learning it once more from what was held out of the logs.
    #[arg(long, hide_short_help = true)]
    pub as_judged: bool,
    /// What comes next is typed by learn.
    #[arg(skip)]
    pub of_learn: bool,
    /// What is fitted to what.
    #[command(flatten)]
    pub fitting: Fitting,
    /// What the target's converters stand for.
    #[command(flatten)]
    pub calibration: CalibrationArgs,
    /// Devices to simulate for the interval beside the estimate; 0 for a table without one.
    #[arg(
        long,
        hide_short_help = true,
        help_heading = "The interval beside the estimate",
        default_value_t = prediction_interval::DEVICES,
        value_name = "N"
    )]
    pub devices: u32,
    /// The search.
    #[command(flatten)]
    pub search: SearchArgs,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &mut Identify) -> Result<bool> {
    arguments.fitting.open_session()?;
    let folder = output::to_folder(&arguments.out)?;
    let inputs: Vec<&Path> =
        arguments.fitting.logs.iter().chain(&arguments.fitting.validate_on).map(PathBuf::as_path).collect();
    for (name, known_by) in FACES.into_iter().chain([("report.html", PAGE), ("estimate.svg", PICTURE)]) {
        output::not_over(&arguments.out.join(name), &inputs)?;
        arguments.overwrite.of(&arguments.out.join(name), known_by)?;
    }
    if let Some(former) = table_files::former(&arguments.out) {
        eprintln!("piezo: careful: {}: what is learnt will replace {former}", arguments.out.display());
    }
    let calibration = arguments.calibration.options()?;
    let drive = &calibration.drive;
    drive.require(drive.drive_span.is_some(), drive.setpoint_span.is_some())?;
    let mut job =
        Job { calibration, as_judged: arguments.as_judged, ..arguments.fitting.job((&arguments.search).into())? };
    job.model = findings::model(arguments.model, job.conditions.lag_s);
    let bar = progress(job.generations());
    let outcome = job.run(&mut |model, cost| {
        bar.set_prefix(model.to_string());
        bar.set_message(format!("{cost:.4} µm"));
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    let bar = progress(arguments.devices.into());
    bar.set_prefix("interval");
    let (mut outcome, interval) =
        prediction_interval::with_interval(outcome, &job.search, arguments.devices, || bar.inc(1))?;
    bar.finish_and_clear();
    findings::doubt_interval(&mut outcome);
    let training: Vec<_> = outcome.learnt_from().training().collect();
    let determination = identifiability::determination(&outcome.learnt.candidate.table, &training);
    let determined = remedy::determination(determination.as_ref());
    let mut verdict =
        [remedy::verdict(&outcome), remedy::left_out(&job, &outcome.learnt.context.recipe, outcome.learnt_from())]
            .concat();
    verdict.push(remedy::interval(interval.as_ref(), arguments.devices));
    write(&folder, arguments, &job, &outcome, &verdict, &determined)?;
    if arguments.fitting.json {
        out(&serde_json::to_string_pretty(&to_json(&outcome, &verdict, determination.as_ref().ok())?)?);
    } else {
        summary(arguments, &outcome, &verdict, &determined);
    }
    // Learn installs no table that belongs on no board.
    Ok(!(arguments.of_learn && unfit(&outcome)))
}

/// Whether the table is not to be used as it is.
fn unfit(outcome: &Outcome) -> bool {
    outcome.doubts.first().is_some_and(Doubt::grave)
}

fn write(
    folder: &Held,
    arguments: &Identify,
    job: &Job,
    outcome: &Outcome,
    verdict: &[String],
    determined: &[(String, String)],
) -> Result<()> {
    let candidate = outcome.judged();
    let file = findings::table_file(outcome, job.cost, &job.search, determined);
    let names: Vec<&str> =
        outcome.learnt.logs.iter().filter(|log| log.role == Role::Training).map(|log| log.file.as_str()).collect();
    let noise: Vec<_> =
        file.noise.map(|noise| ("Noise".to_owned(), noise.told(file.table.deadband_v))).into_iter().collect();
    let mark = |(log, at, what): (String, Stretch, String)| Mark { log, from_s: at.from_s, to_s: at.to_s, what };
    let flaws: Vec<Mark> = findings::flaws(job).into_iter().map(mark).collect();
    let html = report::render(&Report {
        title: &names.join(", "),
        verdict,
        doubts: &file.doubts,
        chosen: candidate,
        learnt: &outcome.learnt.candidate,
        candidates: &outcome.candidates,
        straight_line: outcome.straight_line.as_ref(),
        flaws: &flaws,
        facts: &[determined, &facts(arguments, job.cost, &job.search, outcome), &noise].concat(),
    })?;
    let shown = candidate.held_out.first().or(candidate.training.first()).context("no log was fitted to")?;
    let title = format!("{}: {}", shown.name, candidate.table.model());
    let picture = report::picture(shown, &title, zeroed(outcome, shown).as_ref())?;
    // Everything is made before anything is written.
    let pages = [("report.html", html.into_bytes()), ("estimate.svg", picture.into_bytes())];
    Ok(folder.write_all(file.faces()?.into_iter().chain(pages))?)
}

/// When the first log that was held out, else fitted to, may be zeroed first (s), and its estimates with the delivered table's interval
/// since then; `None` where that has none, or the log ends before.
fn zeroed(outcome: &Outcome, shown: &Comparison) -> Option<(f64, Estimates)> {
    let Table { interval, .. } = *outcome.learnt.candidate.table;
    let table = outcome.judged().clone().with_interval(interval).ok()?.table;
    let session = outcome.problem.validation().next().or(outcome.problem.training().next())?;
    let at = shown.trace.time_s.first()?.max(interval?.earliest_s.into()) + 2.0 * ZERO_WINDOW_S;
    // µm relative to the model's zero, as the comparison has them.
    let recipe = Recipe { displacement_scale: 1.0, displacement_zero_um: 0.0, ..outcome.learnt.context.recipe.clone() };
    let scope = Scope { zero_at_s: Some(at), ..Scope::ALL };
    Some((at, estimates(&table, session, &recipe, &scope, Told::FirstReading).ok()?))
}

fn summary(arguments: &Identify, outcome: &Outcome, verdict: &[String], determined: &[(String, String)]) {
    let figures = |candidate: &Candidate| candidate.held_out_figures().or(candidate.training_figures());
    let held_out = outcome.judged().held_out_figures().is_some();
    out(&heading(if held_out { "held out, in simulation" } else { "training, in simulation" }));
    for (index, candidate) in outcome.candidates.iter().enumerate() {
        let mark = if index == outcome.chosen { "→ " } else { "  " };
        if let Some(figures) = figures(candidate) {
            out(&row(&format!("{mark}{}", candidate.table.model()), &figures));
        }
    }
    if let Some(line) = &outcome.straight_line {
        out(&row(&format!("  {}", StraightLine::NAME), &line.held_out.unwrap_or(line.training)));
    }
    for (model, _) in &outcome.failed {
        out(&format!("  {model}: no admissible candidate was found"));
    }
    out("");
    verdict.iter().for_each(|sentence| out(sentence));
    out(remedy::DETERMINED);
    determined.iter().for_each(|(what, found)| out(&format!("  {what:<46} {found}")));
    out(&format!("\n{}", remedy::doubts(&outcome.doubts)));
    let folder = arguments.out.display();
    out(&format!("\nWritten to {folder}: table.toml, table.rs, table.bin, report.html, estimate.svg"));
    if !arguments.of_learn || unfit(outcome) {
        out(&remedy::next(&outcome.doubts, &arguments.out));
    }
}

/// Provenance for the report.
fn facts(arguments: &Identify, cost: Cost, search: &SearchOptions, outcome: &Outcome) -> Vec<(String, String)> {
    let recipe = &outcome.learnt.context.recipe;
    let mut facts = vec![
        ("Tool".to_owned(), format!("piezo {}", env!("CARGO_PKG_VERSION"))),
        ("Tick".to_owned(), format!("{} µs, {}", recipe.tick_us, arguments.fitting.scheme)),
        ("Zero".to_owned(), remedy::zeros(recipe)),
        ("Cost".to_owned(), cost.to_string()),
        ("Search".to_owned(), findings::search(outcome.judged().table.model(), search)),
    ];
    facts.extend(outcome.learnt.logs.iter().map(findings::log_use));
    facts
}

fn to_json(outcome: &Outcome, verdict: &[String], determination: Option<&Determination>) -> serde_json::Result<Value> {
    let candidates: Vec<Value> = outcome
        .candidates
        .iter()
        .map(|candidate| {
            json!({
                "model": candidate.table.model(),
                "cost": candidate.fit.minimised.feedback,
                "norm": candidate.fit.minimised.norm,
                "feedback_weight": candidate.fit.minimised.feedback_weight,
                "cost_um": candidate.fit.cost,
                "evaluations": candidate.fit.evaluations,
                "parameters": candidate.table.parameters,
                "training": candidate.training_figures(),
                "held_out": candidate.held_out_figures(),
            })
        })
        .collect();
    let failed: Vec<Value> = outcome
        .failed
        .iter()
        .map(|(model, error)| json!({ "model": model, "reason": remedy::sentence(error) }))
        .collect();
    let doubts = outcome.doubts.iter().map(remedy::doubt_json).collect::<serde_json::Result<Vec<Value>>>()?;
    Ok(json!({
        "model": outcome.judged().table.model(),
        "reason": remedy::reason(&outcome.reason),
        "cross_validation": outcome.reason.cross_validation(),
        "verdict": verdict,
        "determination": determination,
        "candidates": candidates,
        "parameters": outcome.learnt.candidate.table.parameters,
        "interval": outcome.learnt.candidate.table.interval,
        "straight_line": outcome.straight_line,
        "failed": failed,
        "doubts": doubts,
        "recipe": outcome.learnt.context.recipe,
        "logs": outcome.learnt.logs,
    }))
}
