//! Preisach models: nothing is searched; the densities and the offset are projected. Where the logs have first-order
//! reversal curves, the densities that follow from these alone come first, and least squares over all samples must better
//! them.

use super::AnyFamily;
use super::projection::Projection;
use crate::least_squares::Sign;
use crate::problem::Problem;
use crate::search::space::Gene;
use estimator_core::model::CELLS;
use estimator_core::{List, Parameters, Preisach, PreisachParameters, Published};

/// The model on a grid over the table's voltages.
pub struct Family;

/// Simplest first.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    let curves = super::reversal_curves::Family::new(problem).map(|family| Box::new(family) as AnyFamily);
    curves.into_iter().chain([Box::new(Family) as AnyFamily]).collect()
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        Vec::new()
    }

    fn project(&self, _values: &[f64], problem: &Problem) -> Option<Parameters> {
        let range = problem.voltage_range();
        let base = PreisachParameters {
            lower_v: range.min as f32,
            upper_v: range.max as f32,
            densities_um: List::collect([0.0; CELLS])?,
            offset_um: 0.0,
        };
        let unknowns: Vec<usize> = (0..CELLS).collect();
        let projection = Projection {
            problem,
            model: &Preisach::<f64>::build(&base, problem.extent().tick),
            unknowns: &unknowns,
            signs: &[Sign::NonNegative; CELLS],
            resonance: None,
        };
        let (found, offset) = projection.solve(|y| y)?;
        let parameters = PreisachParameters {
            densities_um: List::collect(found.iter().map(|&mass| mass as f32))?,
            offset_um: offset as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::Preisach(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        CELLS + ["offset"].len()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Family as _;
    use super::*;
    use crate::Conditions;
    use estimator_core::Recursion;
    use recordings::session::Session;

    /// What a model gives along corners of voltage, a volt a tick, from long at rest at 0 V.
    fn session(truth: &PreisachParameters, corners: &[f64]) -> Session {
        let mut voltage = vec![0.0];
        for &corner in corners {
            let from = voltage.last().copied().unwrap_or(0.0);
            let ticks = (corner - from).abs().round().max(1.0);
            voltage.extend((1..=ticks as u32).map(|tick| from + (corner - from) * f64::from(tick) / ticks));
        }
        let model = Preisach::<f64>::build(truth, 5e-4);
        // From negative saturation, as a rise to the top and a fall leave it.
        let mut state = model.begin(truth.lower_v.into(), None);
        model.step(&mut state, truth.lower_v.into());
        let mut displacement = vec![model.step(&mut state, 0.0)];
        displacement.extend(voltage.iter().map(|&volts| model.step(&mut state, volts)));
        displacement.pop();
        let instants = (0..voltage.len() as u32).collect();
        Session::new("curves".to_owned(), voltage, instants, displacement, 5e-4)
    }

    /// Eq. (3.17–3.19): a log of them is a log like any other.
    #[test]
    fn a_log_of_first_order_reversal_curves_gives_the_model() {
        let truth = PreisachParameters {
            lower_v: -5.0,
            upper_v: 105.0,
            densities_um: List::collect((0..CELLS).map(|cell| 0.1 + 0.05 * (cell % 7) as f32)).unwrap(),
            offset_um: -2.0,
        };
        let curves: Vec<f64> = (1..=20).flat_map(|k| [5.0 * f64::from(k), 0.0]).collect();
        let nested = [90.0, 20.0, 70.0, 35.0, 60.0, 10.0, 95.0, 0.0];
        let problem =
            Problem::new(vec![session(&truth, &curves)], vec![session(&truth, &nested)], Conditions::default());
        let found = Family.project(&[], &problem).unwrap();
        let stroke = problem.stroke().span();
        let error = problem.held_out(&found, crate::cost::Feedback::Simulation.into()).unwrap();
        assert!(stroke > 5.0 && error < 0.01 * stroke, "{error} of {stroke} µm on loops within loops");
        // The densities from the curves alone, before any least squares.
        let structures = structures(&problem);
        assert_eq!(structures.len(), 2, "the curves are recognised");
        let found = structures[0].project(&[], &problem).unwrap();
        let error = problem.held_out(&found, crate::cost::Feedback::Simulation.into()).unwrap();
        assert!(
            error < 0.02 * stroke,
            "{error} of {stroke} µm from the curves alone, on a grid that is not the truth's"
        );
    }

    #[test]
    fn a_sine_is_no_reversal_curve() {
        let voltage: Vec<f64> = (0..4000).map(|k| 50.0 - 50.0 * (f64::from(k) * 0.01).cos()).collect();
        let displacement = voltage.clone();
        let session = Session::new("sine".to_owned(), voltage, (0..4000).collect(), displacement, 5e-4);
        assert_eq!(structures(&Problem::new(vec![session], Vec::new(), Conditions::default())).len(), 1);
    }
}
