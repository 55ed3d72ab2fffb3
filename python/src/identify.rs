//! Logs in, a table out.

use crate::error::{PiezoError, refused, require};
use crate::figures::Figures;
use crate::log::Log;
use crate::table::Table;
use calibration::CalibrationOptions;
use calibration::span::Span;
use estimator_core::Model;
use identification::cost::{Cost, Feedback};
use identification::{Conditions, Job, JobError, ModelChoice, Outcome, SearchOptions};
use pyo3::prelude::*;
use recordings::log::twins;
use recordings::prepare::{AutoOr, PrepareOptions, Recipe};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};

/// What an identification found.
#[pyclass(frozen, get_all, module = "piezo_estimator")]
pub struct Identified {
    /// The table of the chosen model.
    table: Py<Table>,
    /// Why that model was chosen.
    reason: String,
    /// Errors of the f64 reference on what the table was fitted to.
    training: Option<Figures>,
    /// The same of the model before it was fitted to what had been held out, on that; None where nothing was.
    held_out: Option<Figures>,
    /// Every model that was identified, simplest first, with its errors on what was held out, else in training.
    candidates: Vec<(&'static str, Option<Figures>)>,
    /// Reasons not to trust it.
    doubts: Vec<String>,
    /// What the training determined of the actuator: what, and what was found.
    determined: Vec<(String, String)>,
}

#[pymethods]
impl Identified {
    fn __repr__(&self) -> String {
        let Table { admitted, .. } = self.table.get();
        let (model, name, doubts) = (admitted.model().name(), table_files::name(admitted), self.doubts.len());
        format!("<Identified {model}, {name}, {doubts} doubts>")
    }
}

/// A number, or "auto".
#[derive(FromPyObject)]
pub enum Delay {
    /// The delay that was given, ms.
    Given(f64),
    /// A word, of which "auto" alone is known.
    Word(String),
}

/// What Ctrl-C has raised, on its way out of a search.
struct Stopped(PyErr);

/// Identifies a table from logs, as `piezo identify` does with the options of the same names and says of them. Ctrl-C
/// ends it between two generations of a search.
#[pyfunction]
#[pyo3(signature = (logs, *, validate_on=Vec::new(), hold_out=None, as_judged=false, model="auto", lag_ms=None, delay_ms=Delay::Given(0.0),
    repair=false, tick_us=500, voltage_scale=1.0, displacement_scale=1.0, skip_start_s=0.0, skip_end_s=0.0, adc_span=None,
    adc_full_scale=None, amplifier_slew=None, dac_span=None, dac_full_scale=None, devices=prediction_interval::DEVICES,
    evaluations=SearchOptions::DEFAULT.evaluations, seed=SearchOptions::DEFAULT.seed),
    text_signature = "(logs, *, validate_on=(), hold_out=None, as_judged=False, model='auto', lag_ms=None, delay_ms=0.0, repair=False, \
    tick_us=500, voltage_scale=1.0, displacement_scale=1.0, skip_start_s=0.0, skip_end_s=0.0, adc_span=None, \
    adc_full_scale=None, amplifier_slew=None, dac_span=None, dac_full_scale=None, devices=12, evaluations=250, seed=1)")]
// They are keywords in Python.
#[allow(clippy::too_many_arguments)]
pub fn identify(
    py: Python<'_>,
    logs: Vec<PyRef<'_, Log>>,
    validate_on: Vec<PyRef<'_, Log>>,
    hold_out: Option<f64>,
    as_judged: bool,
    model: &str,
    lag_ms: Option<f64>,
    delay_ms: Delay,
    repair: bool,
    tick_us: u32,
    voltage_scale: f64,
    displacement_scale: f64,
    skip_start_s: f64,
    skip_end_s: f64,
    adc_span: Option<(f64, f64)>,
    adc_full_scale: Option<u16>,
    amplifier_slew: Option<f64>,
    dac_span: Option<(f64, f64)>,
    dac_full_scale: Option<u16>,
    devices: u32,
    evaluations: u32,
    seed: u32,
) -> PyResult<Identified> {
    let hold_out = findings::hold_out(hold_out, !validate_on.is_empty());
    require((0.0..1.0).contains(&hold_out), "hold_out must lie between 0 and 1")?;
    require(devices <= 1_000, "devices must be 1000 at most")?;
    require(lag_ms.is_none_or(|ms| ms > 0.0 && ms.is_finite()), "lag_ms must be above 0")?;
    require((1..=1_000_000).contains(&evaluations), "evaluations must lie between 1 and 1000000")?;
    require(adc_full_scale != Some(0) && dac_full_scale != Some(0), "a converter's full scale must be above 0")?;
    require(amplifier_slew.is_none_or(|slew| slew > 0.0 && slew.is_finite()), "amplifier_slew must be above 0")?;
    let prepare = PrepareOptions {
        tick_us,
        voltage_scale,
        displacement_scale,
        delay: delay(delay_ms)?,
        skip_start: skip_start_s,
        skip_end: skip_end_s,
        ..PrepareOptions::default()
    };
    check(&prepare)?;
    let lag_s = lag_ms.map(|ms| 1e-3 * ms);
    let job = Job {
        training: whole(&logs)?,
        held_out: whole(&validate_on)?,
        hold_out,
        as_judged,
        prepare,
        model: findings::model(choice(model)?, lag_s),
        conditions: Conditions { lag_s, repair, ..Conditions::default() },
        calibration: CalibrationOptions {
            adc_span: span(adc_span, "adc_span")?,
            adc_full_scale,
            amplifier_slew,
            dac_span: span(dac_span, "dac_span")?,
            dac_full_scale,
            ..CalibrationOptions::default()
        },
        cost: Cost::from(Feedback::Simulation),
        search: SearchOptions { evaluations, seed, ..SearchOptions::DEFAULT },
    };
    let outcome = py.detach(|| stoppable(&job))??;
    let (mut outcome, _) =
        py.detach(|| prediction_interval::with_interval(outcome, &job.search, devices, || ())).map_err(refused)?;
    findings::doubt_interval(&mut outcome);
    py.check_signals()?;
    identified(py, &outcome, &job)
}

/// Runs a job until it ends, or until Python has something to raise.
fn stoppable(job: &Job) -> PyResult<PyResult<Outcome>> {
    let mut progress = |_: Model, _: f64| {
        if let Err(raised) = Python::attach(|py| py.check_signals()) {
            // A search has no other way out, and leaves nothing behind.
            resume_unwind(Box::new(Stopped(raised)));
        }
    };
    let run: Result<Result<Outcome, JobError>, _> = catch_unwind(AssertUnwindSafe(|| job.run(&mut progress)));
    match run {
        Ok(ended) => Ok(ended.map_err(refused)),
        Err(payload) => match payload.downcast::<Stopped>() {
            Ok(stopped) => Err(stopped.0),
            Err(panic) => resume_unwind(panic),
        },
    }
}

fn identified(py: Python<'_>, outcome: &Outcome, job: &Job) -> PyResult<Identified> {
    let (judged, candidate) = (outcome.judged(), &outcome.learnt.candidate);
    let training: Vec<_> = outcome.learnt_from().training().collect();
    let determined = findings::determination(identifiability::determination(&candidate.table, &training).as_ref());
    let file = findings::table_file(outcome, job.cost, &job.search, &determined);
    let candidates = outcome.candidates.iter().map(|candidate| {
        let figures = candidate.held_out_figures().or(candidate.training_figures());
        (candidate.table.model().name(), figures.map(Figures::from))
    });
    Ok(Identified {
        reason: findings::reason(&outcome.reason),
        training: candidate.training_figures().map(Figures::from),
        held_out: judged.held_out_figures().map(Figures::from),
        candidates: candidates.collect(),
        doubts: file.doubts.clone(),
        determined,
        table: Py::new(py, Table { admitted: candidate.table, file: Some(file) })?,
    })
}

/// The logs, each with voltage and displacement, and none of them twice.
fn whole(logs: &[PyRef<'_, Log>]) -> PyResult<Vec<recordings::log::Log>> {
    let logs: Vec<_> = logs.iter().map(|log| log.0.clone()).collect();
    for log in &logs {
        let path = log.path.display();
        require(log.displacement.is_some(), &format!("{path}: holds no displacement, which is to be learnt"))?;
        require(!log.voltage.is_empty(), &format!("{path}: holds no voltage, which is to be learnt from"))?;
    }
    match twins(&logs) {
        None => Ok(logs),
        Some([log, twin]) => {
            let (log, twin) = (log.path.display(), twin.path.display());
            Err(PiezoError::new_err(format!("{log}: holds the same bytes as {twin}: name each log once")))
        }
    }
}

/// A model by its name, or "auto".
fn choice(name: &str) -> PyResult<ModelChoice> {
    if name == "auto" {
        return Ok(ModelChoice::Auto);
    }
    let model = Model::ALL.into_iter().find(|model| model.name() == name);
    model.map(ModelChoice::Is).ok_or_else(|| {
        let names = Model::ALL.map(Model::name).join(", ");
        PiezoError::new_err(format!("model is auto or one of {names}, not {name:?}"))
    })
}

fn delay(delay: Delay) -> PyResult<AutoOr> {
    match delay {
        Delay::Word(word) if word == "auto" => Ok(AutoOr::Auto),
        Delay::Given(ms) if ms >= 0.0 && ms.is_finite() => Ok(AutoOr::Given(ms)),
        _ => Err(PiezoError::new_err("delay_ms must be 0 or positive, or \"auto\"")),
    }
}

/// What a converter's ends stand for.
fn span(span: Option<(f64, f64)>, name: &str) -> PyResult<Option<Span>> {
    let Some((zero, full)) = span else { return Ok(None) };
    require(
        zero.is_finite() && full.is_finite() && zero != full,
        &format!("the two ends of {name} must be numbers that differ"),
    )?;
    Ok(Some(Span { zero, full }))
}

/// Refuses what a table's recipe would be refused for.
fn check(prepare: &PrepareOptions) -> PyResult<()> {
    let recipe = Recipe {
        voltage_scale: prepare.voltage_scale,
        displacement_scale: prepare.displacement_scale,
        delay_ticks: match prepare.delay {
            AutoOr::Auto => 0,
            AutoOr::Given(ms) => (1e3 * ms / f64::from(prepare.tick_us)) as u32,
        },
        skip_start_s: prepare.skip_start,
        skip_end_s: prepare.skip_end,
        ..Recipe::at_tick(prepare.tick_us)
    };
    recipe.check().map_err(refused)
}
