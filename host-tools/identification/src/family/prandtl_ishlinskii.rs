//! Prandtl–Ishlinskii operators: lateness and the slopes of the superposition's dead zones are searched; the weights of
//! the plays and the offset are projected on the sensor seen through the inverse superposition.

use super::model_family::{lag_s, lateness, lateness_burden};
use super::projection::Projection;
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::{List, Parameters, PrandtlIshlinskiiParameters, Published, Range, Superposition};
use least_squares::Sign;

/// Play operators of a model.
const PLAYS: usize = 16;
/// Dead zones besides the one of width 0, as fractions of the stroke from its lower end.
const DEAD_ZONES: [(f64, &str); 4] = [(0.15, "slope 1"), (0.4, "slope 2"), (0.6, "slope 3"), (0.85, "slope 4")];

/// What is fixed before the search.
pub struct Family {
    widest: f64,
    memory: Range,
    stroke: Range<f64>,
    tick: f64,
}

impl Family {
    /// From the extent of the training logs.
    pub fn new(problem: &Problem) -> Self {
        let voltages = problem.training_voltages();
        let half = 0.5 * voltages.span();
        Self {
            widest: half * (PLAYS - 1) as f64 / PLAYS as f64,
            memory: Range { min: voltages.min as f32, max: voltages.max as f32 },
            stroke: problem.stroke(),
            tick: problem.extent().tick,
        }
    }

    /// Where the dead zones end and their slopes, in order, the one of width 0 among them.
    fn superposition(&self, slopes: &[f64]) -> (Vec<f32>, Vec<f32>) {
        let at = |part: f64| self.stroke.min + part * self.stroke.span();
        let mut zones: Vec<(f64, f64)> =
            DEAD_ZONES.iter().zip(slopes).map(|(&(part, _), &slope)| (at(part), slope)).collect();
        // Two that are alike would be one.
        zones.retain(|(end, _)| end.abs() > 0.02 * self.stroke.span());
        zones.push((0.0, 1.0));
        zones.sort_by(|a, b| a.0.total_cmp(&b.0));
        zones.into_iter().map(|(end, slope)| (end as f32, slope as f32)).unzip()
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        let slope = |&(_, name): &(f64, &'static str)| Gene::linear(name, "slope beyond a dead zone", "", -0.3, 0.3);
        std::iter::once(lateness()).chain(DEAD_ZONES.iter().map(slope)).collect()
    }

    fn burden(&self, values: &[f64]) -> f64 {
        lateness_burden(values.first().copied().unwrap_or(0.0))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let (&late, slopes) = values.split_first()?;
        let (zones, slopes) = self.superposition(slopes);
        let threshold = |i: usize| (self.widest * i as f64 / (PLAYS - 1) as f64) as f32;
        let base = PrandtlIshlinskiiParameters {
            lag_s: lag_s(late, self.tick),
            thresholds_v: List::collect((0..PLAYS).map(threshold))?,
            weights_um_per_v: List::collect([1.0; PLAYS])?,
            offset_um: 0.0,
            dead_zones_um: List::collect(zones.iter().copied())?,
            dead_zone_slopes: List::collect(slopes.iter().copied())?,
            memory_v: self.memory,
        };
        if base.check().is_err() {
            return None;
        }
        let inverse = Superposition::<f64>::build(&zones, &slopes).inverse();
        let unknowns: Vec<usize> = (0..PLAYS).collect();
        let projection = Projection {
            problem,
            model: &base.build(&problem.discretisation()),
            unknowns: &unknowns,
            signs: &[Sign::NonNegative; PLAYS],
        };
        let (found, offset) = projection.solve(|y| inverse.apply(y))?;
        let parameters = PrandtlIshlinskiiParameters {
            weights_um_per_v: List::collect(found.iter().map(|&weight| weight as f32))?,
            offset_um: offset as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::PrandtlIshlinskii(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        PLAYS + ["offset"].len()
    }
}
