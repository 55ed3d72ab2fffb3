//! What an identification works on: prepared sessions, their extent, and the cost of a candidate (Eq. 4.1).
//!
//! The search runs the core's tabulated form, some five times faster than the direct one: where each tick's voltage lies
//! between the knots is the same for every candidate. What is reported of a result is never this cost alone but the error
//! of the finished table in its own form.

use crate::cost::Cost;
use crate::search::space::Extent;
use crate::session_error::{mean_error, mean_error_of};
use estimator_core::lookup::{Grid, Position};
use estimator_core::{
    Engine, Inadmissible, Lookup, Parameters, Range, Scheme, Voigt, VoigtParameters, admissible, lookup,
};
use recordings::session::Session;

/// What the user fixes before the search starts.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Conditions {
    /// Discretisation.
    pub scheme: Scheme,
    /// Retreat that counts as a reversal, V; `None` for 0.083 % of the voltage span.
    pub deadband: Option<f64>,
    /// How wide the displacement limits may be, as a multiple of the training stroke.
    pub limit: f64,
}

impl Default for Conditions {
    /// The thesis's scheme, limits of twice the stroke.
    fn default() -> Self {
        Self { scheme: Scheme::ForwardEuler, deadband: None, limit: 2.0 }
    }
}

/// Sessions and what is fixed before the search starts.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Discretisation.
    pub scheme: Scheme,
    /// Retreat that counts as a reversal, V.
    pub deadband: f64,
    training: Vec<Located>,
    validation: Vec<Located>,
    limit: f64,
    voltage: Range<f64>,
    voltage_range: Range<f64>,
    stroke: Range<f64>,
    extent: Extent,
}

/// A session whose voltages have been located between the knots.
#[derive(Clone, Debug)]
struct Located {
    session: Session,
    positions: Vec<Position<f64>>,
}

/// Deadband where none is given, as a fraction of the voltage span: a few steps of a 12-bit converter. No round fraction,
/// so that a generated ramp does not retreat by exactly the deadband in a tick, which f32 and f64 would see differently.
const DEADBAND: f64 = 0.83e-3;
/// Room beyond the training voltages that a table still covers, as a fraction of their span.
const VOLTAGE_MARGIN: f64 = 0.05;
/// Displacement limits that are tried, as fractions of the way from the training stroke to the largest allowed.
const LIMIT_STEPS: [f64; 6] = [0.05, 0.1, 0.25, 0.5, 0.75, 1.0];

impl Problem {
    /// A problem. What is held out is shown beside the training error and never decides anything.
    pub fn new(training: Vec<Session>, validation: Vec<Session>, conditions: Conditions) -> Self {
        let voltage = hull(training.iter().flat_map(|session| &session.voltage));
        let stroke = hull(training.iter().flat_map(|session| &session.displacement));
        let voltage_range = expanded(voltage, 1.0 + 2.0 * VOLTAGE_MARGIN);
        let largest = |range: Range<f64>| range.min.abs().max(range.max.abs());
        let grid = Grid::of(voltage_range);
        let located = |sessions: Vec<Session>| -> Vec<Located> {
            let locate = |session: Session| Located {
                positions: session.voltage.iter().map(|&v| grid.locate(v)).collect(),
                session,
            };
            sessions.into_iter().map(locate).collect()
        };
        Self {
            scheme: conditions.scheme,
            deadband: conditions.deadband.unwrap_or(DEADBAND * voltage.span()),
            extent: Extent {
                voltage: largest(voltage),
                displacement: largest(stroke),
                tick: training.first().map_or(0.0, |session| session.tick_s),
            },
            training: located(training),
            validation: located(validation),
            limit: conditions.limit,
            voltage,
            voltage_range,
            stroke,
        }
    }

    /// Cost of a parameter set: its training error (µm), infinite where it is not admissible.
    pub fn cost(&self, parameters: &VoigtParameters<f64>, cost: impl Into<Cost>) -> f64 {
        self.cost_of_voigt(&self.model(parameters), cost.into())
    }

    /// Simulation error on what was held out in the norm of a cost, µm; `None` where nothing was.
    pub fn held_out(&self, parameters: &VoigtParameters<f64>, cost: Cost) -> Option<f64> {
        let error = || self.error(&self.validation, &self.model(parameters), cost.in_simulation());
        (!self.validation.is_empty()).then(error)
    }

    /// As [`cost`](Self::cost), of any model.
    pub fn cost_of(&self, parameters: &Parameters, cost: Cost) -> f64 {
        match parameters.build(self.extent.tick, self.scheme) {
            Engine::Voigt(model) => self.cost_of_voigt(&model, cost),
            Engine::Other(_) if self.limits(parameters).is_err() => f64::INFINITY,
            Engine::Other(_) => self.error_of(&self.training, parameters, cost),
        }
    }

    fn cost_of_voigt(&self, model: &Voigt<f64>, cost: Cost) -> f64 {
        // The widest limits first: nearly every set that has any has those.
        let admissible = LIMIT_STEPS.iter().rev().any(|&step| self.check(model, step).is_ok());
        if admissible { self.error(&self.training, model, cost) } else { f64::INFINITY }
    }

    /// As [`held_out`](Self::held_out), of any model.
    pub fn held_out_of(&self, parameters: &Parameters, cost: Cost) -> Option<f64> {
        let error = || self.error_of(&self.validation, parameters, cost.in_simulation());
        (!self.validation.is_empty()).then(error)
    }

    fn error_of(&self, sessions: &[Located], parameters: &Parameters, cost: Cost) -> f64 {
        match parameters.build(self.extent.tick, self.scheme) {
            Engine::Voigt(model) => self.error(sessions, &model, cost),
            Engine::Other(model) => {
                mean(sessions, cost, |located| mean_error_of(&located.session, model.clone(), cost))
            }
        }
    }

    fn error(&self, sessions: &[Located], model: &Voigt<f64>, cost: Cost) -> f64 {
        let lookup = Lookup::tabulate(model, self.voltage_range);
        mean(sessions, cost, |located| {
            let terms = |tick: usize| lookup.at(located.positions[tick]);
            mean_error(&located.session, model, self.deadband, cost, terms)
        })
    }

    /// The tightest displacement limits (µm) within which a parameter set is proven to stay, or why there are none.
    pub fn limits(&self, parameters: &Parameters) -> Result<Range<f64>, Inadmissible<f64>> {
        let model = match parameters.build(self.extent.tick, self.scheme) {
            Engine::Voigt(model) => model,
            Engine::Other(model) => {
                return admissible::check_reach(model.reach(self.voltage_range), self.limits_at(1.0));
            }
        };
        let tightest = LIMIT_STEPS.iter().find(|&&step| self.check(&model, step).is_ok());
        match tightest {
            Some(&step) => Ok(self.limits_at(step)),
            None => self.check(&model, 1.0).map(|_| self.limits_at(1.0)),
        }
    }

    /// The sessions that are fitted to.
    pub fn training(&self) -> impl Iterator<Item = &Session> + Clone {
        self.training.iter().map(|located| &located.session)
    }

    /// The sessions that were held out.
    pub fn validation(&self) -> impl Iterator<Item = &Session> {
        self.validation.iter().map(|located| &located.session)
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

    /// The widest displacement limits that a table may have, rounded inwards, µm.
    pub fn widest_limits(&self) -> Range {
        let Range { min, max } = self.limits_at(1.0);
        Range { min: (min as f32).next_up(), max: (max as f32).next_down() }
    }

    /// V* and Y* of the search coordinates.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    fn model(&self, parameters: &VoigtParameters<f64>) -> Voigt<f64> {
        Voigt::build(parameters, self.extent.tick, self.scheme)
    }

    fn limits_at(&self, step: f64) -> Range<f64> {
        expanded(self.stroke, 1.0 + step * (self.limit - 1.0))
    }

    /// Checks on the voltages that a tabulated form covers, which include those of the direct one.
    fn check(&self, model: &Voigt<f64>, step: f64) -> Result<Range<f64>, Inadmissible<f64>> {
        admissible::check(model, lookup::covered(self.voltage_range), self.limits_at(step))
    }
}

/// The error (µm) over sessions, each weighing the same whatever its length, from each one's mean size of errors.
fn mean(sessions: &[Located], cost: Cost, size: impl Fn(&Located) -> f64) -> f64 {
    cost.norm.error(sessions.iter().map(size).sum::<f64>() / sessions.len().max(1) as f64)
}

fn hull<'a>(values: impl Iterator<Item = &'a f64>) -> Range<f64> {
    let empty = Range { min: f64::INFINITY, max: f64::NEG_INFINITY };
    values.fold(empty, |hull, &x| Range { min: hull.min.min(x), max: hull.max.max(x) })
}

/// The interval stretched about its middle.
fn expanded(range: Range<f64>, factor: f64) -> Range<f64> {
    let (middle, half) = ((range.max + range.min) / 2.0, (range.max - range.min) / 2.0);
    Range { min: middle - factor * half, max: middle + factor * half }
}
