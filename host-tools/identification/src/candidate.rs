//! An identified model made into an admitted table, and run over every session.

use crate::calibration::CalibrationOptions;
use crate::fit::Fit;
use crate::problem::Problem;
use crate::validate::{Comparison, Figures, compare};
use anyhow::{Context, Result, anyhow};
use estimator_core::{Admitted, Digest, Parameters, Provenance, Range, Scheme, Table};
use recordings::prepare::Recipe;

/// An identified model with its table and its errors.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// How it was found.
    pub fit: Fit,
    /// The table it makes.
    pub table: Admitted,
    /// Its simulation errors on what it was fitted to, a log at a time.
    pub training: Vec<Comparison>,
    /// Its simulation errors on what was held out; empty where nothing was.
    pub held_out: Vec<Comparison>,
}

/// What a table holds besides what was identified.
#[derive(Clone, Debug)]
pub struct Setting {
    /// How the logs were prepared.
    pub recipe: Recipe,
    /// The converters.
    pub calibration: CalibrationOptions,
    /// Over the training logs' digests.
    pub logs: Digest,
    /// Seed of the search.
    pub seed: u32,
}

/// The admissibility of an optimum that lies on its own constraint must survive rounding to f32.
const ROUNDING: f64 = 1e-3;

impl Candidate {
    /// Makes the table and runs it over the sessions of its problem.
    pub fn new(problem: &Problem, fit: Fit, setting: &Setting) -> Result<Self> {
        let parameters = fit.parameters.context(
            "no candidate has a solution: try logs of more amplitudes, a longer search (--evaluations, --budget) or another --limit"
        )?;
        let table = table(problem, parameters, setting)?;
        let admit = |table: Table| table.admit().context("the identified table is refused");
        let first = admit(table)?;
        let candidate = Self {
            training: problem.training().map(|session| compare(&first, session)).collect(),
            held_out: problem.validation().map(|session| compare(&first, session)).collect(),
            fit,
            table: first,
        };
        let held_out = candidate.held_out_figures();
        let provenance = Provenance {
            train_mae_um: candidate.training_figures().map_or(0.0, |figures| figures.mae_um as f32),
            validation_mae_um: held_out.map(|figures| figures.mae_um as f32),
            validation_max_um: held_out.map(|figures| figures.max_um as f32),
            ..table.provenance
        };
        Ok(Self { table: admit(Table { provenance, ..table })?, ..candidate })
    }

    /// Reference errors over all training logs.
    pub fn training_figures(&self) -> Option<Figures> {
        Figures::all(self.training.iter().map(|comparison| &comparison.mil))
    }

    /// Reference errors over all that was held out.
    pub fn held_out_figures(&self) -> Option<Figures> {
        Figures::all(self.held_out.iter().map(|comparison| &comparison.mil))
    }
}

fn table(problem: &Problem, parameters: Parameters, setting: &Setting) -> Result<Table> {
    let recipe = &setting.recipe;
    let limits = problem.limits(&parameters).map_err(|cause| {
        anyhow!("no admissible candidate was found ({cause}): search longer (--generations, --rounds, --evaluations, --budget) or raise --limit")
    })?;
    let room = ROUNDING * limits.span();
    let limits = Range { min: limits.min - room, max: limits.max + room };
    let voltage = problem.voltage_range();
    let (adc, dac) = setting.calibration.calibration(voltage, recipe.voltage_zero_v, limits);
    let single = |range: Range<f64>| Range { min: range.min as f32, max: range.max as f32 };
    let mut table = Table {
        sample_period_us: recipe.tick_us,
        scheme: if parameters.model().is_voigt() { problem.scheme } else { Scheme::ForwardEuler },
        deadband_v: problem.deadband as f32,
        voltage_zero_v: recipe.voltage_zero_v as f32,
        displacement_zero_um: recipe.displacement_zero_um as f32,
        voltage_range_v: single(voltage),
        displacement_limits_um: single(limits),
        parameters,
        adc,
        dac,
        drive: None,
        provenance: Provenance {
            logs: setting.logs,
            seed: setting.seed,
            tool_version: version(),
            train_mae_um: 0.0,
            validation_mae_um: None,
            validation_max_um: None,
        },
    };
    let full_scale = table.dac.full_scale;
    setting.calibration.drive.apply(&mut table, full_scale);
    Ok(table)
}

/// Version of this tool.
fn version() -> [u16; 3] {
    let mut numbers = env!("CARGO_PKG_VERSION").split('.').map(|number| number.parse().unwrap_or(0));
    std::array::from_fn(|_| numbers.next().unwrap_or(0))
}
