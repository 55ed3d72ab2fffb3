//! An identified model made into an admitted table, and run over every session.

use crate::fit::Fit;
use crate::problem::Problem;
use crate::validate::{Comparison, Figures, Trace, compare};
use calibration::CalibrationOptions;
use calibration::drive::FullScales;
use estimator_core::{
    Admitted, Digest, Inadmissible, IntervalParameters, Parameters, Provenance, Range, Scheme, Table, TableError,
};
use recordings::prepare::Recipe;
use remanence::remanence;

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

/// Why no table can be made of a fit.
#[derive(Clone, Debug, thiserror::Error)]
pub enum CandidateError {
    /// The search met nothing admissible.
    #[error("no admissible candidate was found")]
    NothingFound,
    /// Of the best that the search met no limits can be proven.
    #[error("no admissible candidate was found ({0})")]
    Unbounded(Inadmissible<f64>),
    /// The table breaks a rule.
    #[error("the identified table is refused")]
    Refused(#[from] TableError),
}

/// What a table holds besides what was identified.
#[derive(Clone, Debug)]
pub struct TableContext {
    /// How the logs were prepared.
    pub recipe: Recipe,
    /// What the board's converters stand for.
    pub calibration: CalibrationOptions,
    /// Over the training logs' digests.
    pub logs: Digest,
    /// Seed of the search.
    pub seed: u32,
}

/// The admissibility of an optimum that lies on its own constraint must survive rounding to f32.
const ROUNDING: f64 = 1e-3;

impl Candidate {
    /// By how much the displacement is behind the voltage, delay and lag together, s; 0 of models that
    /// have neither, or look ahead.
    pub fn late_s(&self) -> f64 {
        let parameters = &self.table.parameters;
        f64::from(parameters.delay_ticks()) * self.table.sample_period::<f64>() + f64::from(parameters.lag_s().max(0.0))
    }

    /// Makes the table and runs it over the sessions of its problem.
    ///
    /// # Errors
    /// The fit has no parameters, or they are not admissible.
    pub fn new(problem: &Problem, fit: Fit, context: &TableContext) -> Result<Self, CandidateError> {
        let parameters = fit.parameters.ok_or(CandidateError::NothingFound)?;
        let table = table(problem, parameters, context)?;
        let remanence_um = remanence(&table.admit()?, problem.training());
        let first = Table { remanence_um, ..table }.admit()?;
        let candidate = Self {
            training: problem.training().map(|session| compare(&first, session)).collect(),
            held_out: problem.validation().map(|session| compare(&first, session)).collect(),
            fit,
            table: first,
        };
        let held_out = candidate.held_out_figures();
        let provenance = Provenance {
            train_mae_um: candidate.training_figures().map_or(0.0, |figures| figures.mae_without_offset_um as f32),
            validation_mae_um: held_out.map(|figures| figures.mae_um as f32),
            validation_max_um: held_out.map(|figures| figures.max_um as f32),
            ..table.provenance
        };
        Ok(Self { table: Table { provenance, ..*first }.admit()?, ..candidate })
    }

    /// The same without its estimates, of which only the errors are kept: of a long log they are much.
    #[must_use]
    pub fn without_traces(mut self) -> Self {
        for comparison in self.training.iter_mut().chain(&mut self.held_out) {
            comparison.trace = Trace::default();
        }
        self
    }

    /// The same with this interval beside its estimate, or none.
    ///
    /// # Errors
    /// The interval breaks a rule.
    pub fn with_interval(self, interval: Option<IntervalParameters>) -> Result<Self, CandidateError> {
        Ok(Self { table: Table { interval, ..*self.table }.admit()?, ..self })
    }

    /// Reference errors over all training logs ([`Comparison::figures`]).
    pub fn training_figures(&self) -> Option<Figures> {
        figures(&self.training)
    }

    /// Mean error over all training logs, each without its offset ([`Comparison::from_its_start`]), µm.
    pub fn training_off_um(&self) -> Option<f64> {
        Some(self.training_figures()?.mae_without_offset_um)
    }

    /// The same over all that was held out.
    pub fn held_out_off_um(&self) -> Option<f64> {
        Some(self.held_out_figures()?.mae_without_offset_um)
    }

    /// Reference errors over all that was held out, likewise.
    pub fn held_out_figures(&self) -> Option<Figures> {
        figures(&self.held_out)
    }
}

fn figures(logs: &[Comparison]) -> Option<Figures> {
    Figures::all(logs.iter().map(Comparison::figures).collect::<Vec<_>>().iter())
}

fn table(problem: &Problem, parameters: Parameters, context: &TableContext) -> Result<Table, CandidateError> {
    let recipe = &context.recipe;
    let limits = problem.limits(&parameters).map_err(CandidateError::Unbounded)?;
    let margin = ROUNDING * limits.span();
    let limits = Range { min: limits.min - margin, max: limits.max + margin };
    let voltage = problem.voltage_range();
    let (adc, dac) = context.calibration.calibration(voltage, recipe.voltage_zero_v, limits);
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
        remanence_um: [0.0; 2],
        adc,
        amplifier_slew_v_per_s: context.calibration.amplifier_slew(),
        dac,
        drive: None,
        interval: None,
        provenance: Provenance {
            logs: context.logs,
            seed: context.seed,
            tool_version: version(),
            train_mae_um: 0.0,
            validation_mae_um: None,
            validation_max_um: None,
        },
    };
    let full_scales = FullScales::of(&table);
    context.calibration.drive.apply(&mut table, full_scales);
    Ok(table)
}

/// Version of this tool.
fn version() -> [u16; 3] {
    let mut numbers = env!("CARGO_PKG_VERSION").split('.').map(|number| number.parse().unwrap_or(0));
    std::array::from_fn(|_| numbers.next().unwrap_or(0))
}
