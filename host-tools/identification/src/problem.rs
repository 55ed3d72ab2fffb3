//! What an identification works on: prepared sessions, their extent, and the cost of a candidate (Eq. 4.1).
//!
//! What is reported of a result is never this cost alone but the error of the finished table.

use crate::cost::Cost;
use crate::search::space::Extent;
use crate::trial::Trial;
use crate::validate::{Baseline, statistics};
use calibration::CalibrationOptions;
use calibration::drive::RANGE_MARGIN;
use estimator_core::extremum::between_codes;
use estimator_core::{Discretisation, Inadmissible, Process, Range, Scheme};
use log_survey::settled::settled;
use model_error::{errors_from, mean_error, mean_size};
use recordings::session::Session;

/// What the user fixes before the search starts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conditions {
    /// How the continuous equations become ticks.
    pub scheme: Scheme,
    /// Retreat that counts as a reversal, V; `None` for what the voltage's noise asks for, 0.083 % of its
    /// span at least.
    pub deadband: Option<f64>,
    /// How wide the displacement limits may be, as a multiple of the training stroke.
    pub limit: f64,
    /// What the displacement as it is read lags behind the voltage, s, where a data sheet or a step says so.
    pub lag_s: Option<f64>,
    /// What a log's [flaws](log_survey::Flaw) hold is left out of what is fitted to and judged by.
    pub repair: bool,
}

impl Default for Conditions {
    /// The thesis's scheme, limits of three times the stroke, logs as they are.
    fn default() -> Self {
        Self { scheme: Scheme::ForwardEuler, deadband: None, limit: 3.0, lag_s: None, repair: false }
    }
}

/// Sessions and what is fixed before the search starts.
#[derive(Clone, Debug)]
pub struct Problem {
    /// How the continuous equations become ticks.
    pub scheme: Scheme,
    /// Retreat that counts as a reversal, V.
    pub deadband: f64,
    /// What the displacement as it is read lags behind the voltage, s, where somebody says so.
    pub lag_s: Option<f64>,
    training: Vec<Session>,
    validation: Vec<Session>,
    limit: f64,
    voltage: Range<f64>,
    voltage_range: Range<f64>,
    stroke: Range<f64>,
    extent: Extent,
}

/// Displacement limits that are tried besides the widest that are allowed, as multiples of the training stroke.
const LIMITS: [f64; 7] = [1.05, 1.1, 1.25, 1.5, 1.75, 2.0, 2.5];

impl Problem {
    /// A problem. What is held out is shown beside the training error and decides nothing here.
    pub fn new(training: Vec<Session>, validation: Vec<Session>, conditions: Conditions) -> Self {
        let voltage = Range::of_values(training.iter().flat_map(|session| session.voltage.iter().copied()));
        let stroke = Range::of_values(training.iter().flat_map(|session| session.displacement.iter().copied()));
        let voltage_range = expanded(voltage, 1.0 + 2.0 * RANGE_MARGIN);
        let largest = |range: Range<f64>| range.min.abs().max(range.max.abs());
        Self {
            scheme: conditions.scheme,
            deadband: conditions.deadband.unwrap_or_else(|| log_survey::deadband(&training, voltage.span())),
            lag_s: conditions.lag_s,
            extent: Extent {
                voltage: largest(voltage),
                displacement: largest(stroke),
                tick: training.first().map_or(0.0, |session| session.tick_s),
            },
            training,
            validation,
            limit: conditions.limit,
            voltage,
            voltage_range,
            stroke,
        }
    }

    /// With the retreat that its table will count as a reversal: between two numbers of codes of the ADC, as
    /// [`Table::retreat_v`](estimator_core::Table::retreat_v) has it, so that what is fitted is what runs.
    /// `voltage_zero`: what the sessions' voltages are measured from, V.
    #[must_use]
    pub fn read_by(self, calibration: &CalibrationOptions, voltage_zero: f64) -> Self {
        let (adc, _) = calibration.calibration(self.voltage_range, voltage_zero, self.stroke);
        let between = between_codes(self.deadband as f32, adc.gain_v_per_code);
        // A span without a width is refused with the table.
        if between.is_finite() { Self { deadband: between.into(), ..self } } else { self }
    }

    /// The same conditions with other sessions, at the same tick.
    #[must_use]
    pub fn of(&self, training: Vec<Session>, validation: Vec<Session>) -> Self {
        let conditions = Conditions {
            scheme: self.scheme,
            deadband: Some(self.deadband),
            limit: self.limit,
            lag_s: self.lag_s,
            ..Conditions::default()
        };
        Self::new(training, validation, conditions)
    }

    /// Cost of parameters: their training error (µm), infinite where they are not admissible.
    pub fn cost(&self, trial: &impl Trial, cost: impl Into<Cost>) -> f64 {
        let model = trial.model(&self.discretisation());
        if self.admits(&model, self.voltage_range) { error(&self.training, &model, cost.into()) } else { f64::INFINITY }
    }

    /// Simulation error on what was held out in the norm of a cost, µm; `None` where nothing was.
    pub fn held_out(&self, trial: &impl Trial, cost: Cost) -> Option<f64> {
        (!self.validation.is_empty())
            .then(|| error(&self.validation, &trial.model(&self.discretisation()), cost.in_simulation()))
    }

    /// Simulation error on the training sessions in the norm of a cost, µm, of what follows once each voltage has
    /// been near both ends of its range, beside each session's own constant: the sensor's zero may differ from one
    /// log to the next.
    pub fn error_once_settled(&self, trial: &impl Trial, cost: Cost) -> f64 {
        let model = trial.model(&self.discretisation());
        let of = |session: &Session| {
            let errors = errors_once_settled(session, &model);
            mean_size(&errors, statistics::mean(&errors), cost.norm)
        };
        mean(&self.training, cost, of)
    }

    /// The tightest displacement limits (µm) within which parameters are proven to stay.
    ///
    /// # Errors
    /// There are none within the widest that the conditions allow.
    pub fn limits(&self, trial: &impl Trial) -> Result<Range<f64>, Inadmissible<f64>> {
        let model = trial.model(&self.discretisation());
        let bound = |limits| model.bound(self.voltage_range, limits);
        self.tried_limits().find_map(|limits| bound(limits).ok()).map_or_else(|| bound(self.stretched(self.limit)), Ok)
    }

    /// Tick, scheme and deadband.
    pub fn discretisation(&self) -> Discretisation<f64> {
        Discretisation { sample_period: self.extent.tick, scheme: self.scheme, deadband: self.deadband }
    }

    /// The sessions that are fitted to.
    pub fn training(&self) -> impl Iterator<Item = &Session> + Clone {
        self.training.iter()
    }

    /// The sessions that were held out.
    pub fn validation(&self) -> impl Iterator<Item = &Session> {
        self.validation.iter()
    }

    /// The straight line through the training; `None` where its voltage does not move.
    pub fn baseline(&self) -> Option<Baseline> {
        Baseline::of(self.training(), self.validation())
    }

    /// Voltages of the training sessions and a margin, V.
    pub fn voltage_range(&self) -> Range<f64> {
        self.voltage_range
    }

    /// Voltages of the training sessions, V.
    pub fn training_voltages(&self) -> Range<f64> {
        self.voltage
    }

    /// Displacements of the training sessions, µm.
    pub fn stroke(&self) -> Range<f64> {
        self.stroke
    }

    /// The tightest displacement limits that are tried, rounded inwards, µm.
    pub fn tight_limits(&self) -> Range {
        let [tightest, ..] = LIMITS;
        let Range { min, max } = self.stretched(tightest.min(self.limit));
        Range { min: (min as f32).next_up(), max: (max as f32).next_down() }
    }

    /// V* and Y* of the search coordinates.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Displacement limits that are tried, the tightest first, µm.
    fn tried_limits(&self) -> impl DoubleEndedIterator<Item = Range<f64>> {
        let tighter = LIMITS.into_iter().filter(|limit| *limit < self.limit);
        tighter.chain([self.limit]).map(|limit| self.stretched(limit))
    }

    /// So many times the training stroke, about its middle, µm.
    fn stretched(&self, limit: f64) -> Range<f64> {
        expanded(self.stroke, limit)
    }

    /// Whether a model is proven to stay within any of the limits at voltages of a range (V).
    fn admits(&self, model: &impl Process<f64>, voltage: Range<f64>) -> bool {
        self.admits_by(|limits| model.bound(voltage, limits).is_ok())
    }

    /// Whether any of the limits (µm) is one that a model is proven to stay within.
    pub(crate) fn admits_by(&self, proven: impl Fn(Range<f64>) -> bool) -> bool {
        // The widest limits first: nearly every set that has any has those.
        self.tried_limits().rev().any(proven)
    }
}

/// A model's errors (µm) on what follows a session's start.
pub fn errors_once_settled(session: &Session, model: &impl Process<f64>) -> Vec<f64> {
    errors_from(session.lead_in.max(settled(session)), session, model.clone())
}

/// A model's error (µm) over sessions, each weighing the same whatever its length.
fn error(sessions: &[Session], model: &impl Process<f64>, cost: Cost) -> f64 {
    mean(sessions, cost, |session| mean_error(session, model.clone(), cost))
}

/// Of a size that each session has.
fn mean(sessions: &[Session], cost: Cost, size: impl Fn(&Session) -> f64) -> f64 {
    cost.norm.error(sessions.iter().map(size).sum::<f64>() / sessions.len().max(1) as f64)
}

/// The interval stretched about its middle.
fn expanded(range: Range<f64>, factor: f64) -> Range<f64> {
    let (middle, half) = ((range.max + range.min) / 2.0, (range.max - range.min) / 2.0);
    Range { min: middle - factor * half, max: middle + factor * half }
}
