//! `piezo identify`: logs → a parameter table, judged on what it had not seen, and a report.

use super::print::{out, progress};
use crate::option::{CalibrationArgs, Fitting, Overwrite, SearchArgs, model_choice};
use crate::output::{self, FACES, Held, PAGE, PICTURE};
use anyhow::{Context, Error, Result};
use clap::Args;
use estimator_core::Table;
use fleet::{Asked, Found, Run, UNIT, UnitName};
use identification::cost::Cost;
use identification::validate::{Comparison, Scope, Told, ZERO_WINDOW_S, estimates};
use identification::{Doubt, Job, ModelChoice, Outcome, SearchOptions};
use log_survey::Stretch;
use recordings::Role;
use recordings::prepare::Recipe;
use report::{Mark, Report, Zeroed};
use std::collections::BTreeMap;
use std::path::PathBuf;
use table_files::TableFile;

/// What its results name as their maker.
const TOOL: &str = concat!("piezo ", env!("CARGO_PKG_VERSION"));

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
    /// Words of yours for the report: the actuator's serial number, what it carries, who recorded it.
    #[arg(long, hide_short_help = true, value_name = "TEXT")]
    pub note: Option<String>,
    /// What comes next is typed by learn.
    #[arg(skip)]
    pub of_learn: bool,
    /// What is fitted to what.
    #[command(flatten)]
    pub fitting: Fitting,
    /// What the target's converters stand for.
    #[command(flatten)]
    pub calibration: CalibrationArgs,
    /// Devices to simulate for the interval beside the estimate, up to 1000; 0 for a table without one.
    #[arg(
        long,
        hide_short_help = true,
        help_heading = "The interval beside the estimate",
        default_value_t = prediction_interval::DEVICES, value_parser = clap::value_parser!(u32).range(0..=1_000),
        value_name = "N", allow_negative_numbers = true
    )]
    pub devices: u32,
    /// How models are searched.
    #[command(flatten)]
    pub search: SearchArgs,
    /// One of a fleet: its name or serial number, for the table, the report and unit.json in the folder. That file says
    /// what came of it, a table or the error that there was instead; `piezo collect` reads many of them.
    #[arg(long, hide_short_help = true, help_heading = FLEET, value_name = "NAME", allow_hyphen_values = true)]
    pub unit: Option<UnitName>,
    /// Search nothing where the folder has the unit's result of the same logs, whatever they are called now, by the
    /// same options and the same program, as it was written.
    #[arg(long, hide_short_help = true, help_heading = FLEET, requires = "unit")]
    pub if_changed: bool,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

const FLEET: &str = "A fleet of units";

/// Runs the verb.
pub fn run(arguments: &mut Identify) -> Result<bool> {
    // Whether a session is being recorded shows by its folder being held: it is looked at before this program holds it.
    let opened = arguments.fitting.open_session(arguments.calibration.board.as_deref()).map_err(Error::from);
    let path = arguments.out.join(UNIT.0);
    let Some(unit) = arguments.unit.clone() else {
        let missing = opened?;
        let folder = output::to_folder(&arguments.out)?;
        remedy::of_no_unit(&path).map_err(Error::msg)?;
        return identify(arguments, &folder, missing, None);
    };
    let folder = output::to_folder(&arguments.out)?;
    arguments.overwrite.of_inputs(&path, UNIT.1, inputs(arguments))?;
    let mut run = Run::new(&arguments.out, unit, TOOL.to_owned());
    let fit = opened.and_then(|missing| identify(arguments, &folder, missing, Some(&mut run)));
    let (exit_code, error) = match &fit {
        Ok(fit) => (u8::from(!fit), None),
        Err(error) => (2, Some(remedy::sentence(error.as_ref()))),
    };
    match (run.end(exit_code, error), fit) {
        (Err(unwritten), Err(error)) => {
            eprintln!("piezo: careful: {}", remedy::sentence(&unwritten));
            Err(error)
        }
        (written, fit) => written.map_err(Into::into).and(fit),
    }
}

/// The files that the command reads.
fn inputs(arguments: &Identify) -> impl Iterator<Item = &PathBuf> {
    arguments.fitting.logs.iter().chain(&arguments.fitting.validate_on)
}

/// Identifies from a session of which something may be missing, with a unit's run told of it where it is one; whether
/// the table is to be used.
fn identify(
    arguments: &mut Identify,
    folder: &Held,
    missing: Option<String>,
    mut run: Option<&mut Run>,
) -> Result<bool> {
    for (name, known_by) in FACES.into_iter().chain([("report.html", PAGE), ("estimate.svg", PICTURE)]) {
        arguments.overwrite.of_inputs(&arguments.out.join(name), known_by, inputs(arguments))?;
    }
    let calibration = arguments.calibration.options()?;
    let drive = &calibration.drive;
    drive.require(drive.drive_span.is_some(), drive.setpoint_span.is_some())?;
    let mut job =
        Job { calibration, as_judged: arguments.as_judged, ..arguments.fitting.job((&arguments.search).into())? };
    job.model = findings::model(arguments.model, job.conditions.lag_s);
    let asked =
        run.is_some().then(|| Asked::of(&job, &arguments.fitting.files.options(), arguments.devices)).transpose()?;
    if let (Some(run), Some(asked)) = (&mut run, &asked) {
        match run.changed(asked).filter(|_| arguments.if_changed) {
            Some(changed) => eprintln!("piezo: {}: {changed}: it is searched", arguments.out.display()),
            None if arguments.if_changed => return unchanged(arguments, run),
            None => {}
        }
        run.begin()?;
    }
    if let Some(former) = table_files::former(&arguments.out) {
        eprintln!("piezo: careful: {}: what is learnt will replace {former}", arguments.out.display());
    }
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
    findings::doubt_session(&mut outcome, missing);
    let training: Vec<_> = outcome.learnt_from().training().collect();
    let determination = identifiability::determination(&outcome.learnt.candidate.table, &training);
    let determined = remedy::determination(determination.as_ref());
    let mut verdict = remedy::verdict(&outcome, bench::of_session(&arguments.fitting.logs));
    verdict.extend(remedy::left_out(&job, &outcome.learnt.context.recipe, outcome.learnt_from()));
    verdict.push(remedy::interval(interval.as_ref(), arguments.devices));
    let on_the_board = remedy::on_the_board(&outcome);
    let all = [&verdict[..], &on_the_board].concat();
    let files = write(folder, arguments, &job, &outcome, &all, &determined)?;
    if let (Some(run), Some(asked)) = (run, asked) {
        run.found(asked, Found::of(&outcome)?, files);
    }
    if arguments.fitting.json {
        out(&serde_json::to_string_pretty(&remedy::outcome_json(&outcome, &all, determination.as_ref().ok())?)?);
    } else {
        summary(arguments, &outcome, [&verdict, &on_the_board], &determined);
    }
    // Learn installs no table that belongs on no board.
    Ok(!(arguments.of_learn && unfit(&outcome)))
}

/// Says that the result is there already, and leaves it.
fn unchanged(arguments: &Identify, run: &Run) -> Result<bool> {
    let unit = run.keep()?;
    if arguments.fitting.json {
        out(&serde_json::to_string_pretty(&unit)?);
    } else {
        let (unit, folder) = (unit.unit, arguments.out.display());
        out(&format!("{unit}: logs, options and program are those of the result in {folder}: nothing was searched"));
    }
    Ok(true)
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
) -> Result<BTreeMap<String, String>> {
    let candidate = outcome.judged();
    let unit = arguments.unit.as_ref().map(UnitName::to_string);
    let file = TableFile { unit: unit.clone(), ..findings::table_file(outcome, job.cost, &job.search, determined) };
    let names: Vec<&str> =
        outcome.learnt.logs.iter().filter(|log| log.role == Role::Training).map(|log| log.file.as_str()).collect();
    let noise: Vec<_> =
        file.noise.map(|noise| ("Noise".to_owned(), noise.told(file.table.deadband_v))).into_iter().collect();
    let mark = |(log, at, what): (String, Stretch, String)| Mark { log, from_s: at.from_s, to_s: at.to_s, what };
    let flaws: Vec<Mark> = findings::flaws(job).into_iter().map(mark).collect();
    let html = report::render(&Report {
        title: &report::heading(unit.as_deref(), &names),
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
    let files: Vec<_> = file.faces()?.into_iter().chain(pages).collect();
    folder.write_all(files.iter().map(|(name, contents)| (*name, contents)))?;
    Ok(fleet::digests(files))
}

/// When the first log that was held out, else fitted to, may be zeroed first (s), and its estimates with the delivered
/// table's interval since then; `None` where that has none, or the log ends before.
fn zeroed(outcome: &Outcome, shown: &Comparison) -> Option<Zeroed> {
    let Table { interval, .. } = *outcome.learnt.candidate.table;
    let table = outcome.judged().clone().with_interval(interval).ok()?.table;
    let session = outcome.problem.validation().next().or(outcome.problem.training().next())?;
    let at = shown.trace.time_s.first()?.max(interval?.earliest_s.into()) + 2.0 * ZERO_WINDOW_S;
    // µm relative to the model's zero, as the comparison has them.
    let recipe = Recipe { displacement_scale: 1.0, displacement_zero_um: 0.0, ..outcome.learnt.context.recipe.clone() };
    let scope = Scope { zero_at_s: Some(at), ..Scope::ALL };
    let estimates = estimates(&table, session, &recipe, &scope, Told::FirstReading).ok()?;
    Some(Zeroed { at_s: at, estimates, learnt: outcome.learnt.whole.is_some() })
}

fn summary(
    arguments: &Identify,
    outcome: &Outcome,
    [verdict, on_the_board]: [&[String]; 2],
    determined: &[(String, String)],
) {
    findings::figures::of_outcome(outcome).iter().for_each(|line| out(line));
    out("");
    verdict.iter().for_each(|sentence| out(sentence));
    out(remedy::DETERMINED);
    determined.iter().for_each(|(what, found)| out(&format!("  {what:<46} {found}")));
    out(&format!("\n{}\n", remedy::doubts(&outcome.doubts)));
    on_the_board.iter().for_each(|sentence| out(sentence));
    let (folder, unit) = (arguments.out.display(), arguments.unit.as_ref().map_or("", |_| ", unit.json"));
    out(&format!("\nWritten to {folder}: table.toml, table.rs, table.bin, report.html, estimate.svg{unit}"));
    if !arguments.of_learn || unfit(outcome) {
        out(&remedy::next(&outcome.doubts, &arguments.out));
    }
}

/// Provenance for the report.
fn facts(arguments: &Identify, cost: Cost, search: &SearchOptions, outcome: &Outcome) -> Vec<(String, String)> {
    let recipe = &outcome.learnt.context.recipe;
    let unit = arguments.unit.iter().map(|unit| ("Unit".to_owned(), unit.to_string()));
    let note = arguments.note.iter().map(|note| ("Note".to_owned(), note.clone()));
    let mut facts: Vec<_> = unit.chain(note).collect();
    facts.extend([
        ("Tool".to_owned(), TOOL.to_owned()),
        ("Tick".to_owned(), format!("{} µs, {}", recipe.tick_us, arguments.fitting.scheme)),
        ("Zero".to_owned(), findings::zeros(recipe)),
        ("Cost".to_owned(), cost.to_string()),
        ("Search".to_owned(), findings::search(outcome.judged().table.model(), search)),
    ]);
    facts.extend(outcome.learnt.logs.iter().map(findings::log_use));
    facts
}
