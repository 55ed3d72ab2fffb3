//! Maxwell-slip models: the lateness, the largest yield displacement and the spacing of the others are searched; the
//! stiffnesses are projected. For a given displacement the voltage is linear in them (Eq. 3.10), so they are fitted to
//! the voltage.

use super::model_family::{lag_s, lateness, lateness_burden};
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::model::Lagged;
use estimator_core::{List, MaxwellSlipParameters, Parameters, Published, Stop};
use least_squares::{Normal, Sign};

/// Elasto-slide elements of a model.
const ELEMENTS: usize = 10;

/// What is fixed before the search.
pub struct Family {
    stroke: f64,
    tick: f64,
}

impl Family {
    /// From the extent of the training logs.
    pub fn new(problem: &Problem) -> Self {
        Self { stroke: problem.stroke().span(), tick: problem.extent().tick }
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        vec![
            lateness(),
            Gene::linear("yield", "largest displacement before an element slips, of the stroke", "", 0.02, 0.7),
            Gene::linear("spacing", "exponent of the spacing of the others", "", 0.7, 3.0),
        ]
    }

    fn burden(&self, values: &[f64]) -> f64 {
        lateness_burden(values.first().copied().unwrap_or(0.0))
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let &[late, largest, spacing] = values else { return None };
        let lag_s = lag_s(late, self.tick);
        let (lag, ahead) = (Lagged::<f64, _>::build(lag_s, self.tick, ()), (1.0 - late).max(0.0));
        let part = |i: usize| libm::pow(i as f64 / ELEMENTS as f64, spacing);
        let yields: Vec<f64> = (1..=ELEMENTS).map(|i| self.stroke * largest * part(i)).collect();
        let sessions = problem.training().count();
        let mut normal = Normal::new(1 + ELEMENTS + sessions);
        for (number, session) in problem.training().enumerate() {
            let &first = session.displacement.first()?;
            let mut stops: Vec<Stop<f64>> = yields.iter().map(|&y| Stop::new(y, first)).collect();
            let weight = 1.0 / session.instants.len() as f64;
            let mut input = lag.at_rest(*session.voltage.first()?);
            let inputs: Vec<f64> = session.voltage.iter().map(|&voltage| lag.input(&mut input, voltage)).collect();
            let mut row = vec![0.0; normal.columns()];
            for (&instant, &measured) in session.instants.iter().zip(&session.displacement) {
                row.fill(0.0);
                let forces = stops.iter_mut().map(|stop| stop.step(measured));
                for (column, force) in row.iter_mut().zip(std::iter::once(measured).chain(forces)) {
                    *column = force;
                }
                row[1 + ELEMENTS + number] = 1.0;
                // The recursion gives a displacement a tick after its voltage, or, seen ahead, less.
                let Some(tick) = (instant as usize).checked_sub(1) else { continue };
                if let Some(&voltage) = inputs.get(tick) {
                    let next = inputs.get(tick + 1).copied().unwrap_or(voltage);
                    normal.add(&row, voltage + ahead * (next - voltage), weight);
                }
            }
        }
        let mut signs = vec![Sign::NonNegative; 1 + ELEMENTS];
        signs.resize(1 + ELEMENTS + sessions, Sign::Free);
        let found = normal.solve(&signs)?;
        let (base, rest) = found.split_first()?;
        let (stiffness, offsets) = rest.split_at_checked(ELEMENTS)?;
        // An element without stiffness is none.
        let used = || stiffness.iter().zip(&yields).filter(|&(&k, _)| k as f32 > 0.0);
        let parameters = MaxwellSlipParameters {
            lag_s,
            stiffness_v_per_um: List::collect(used().map(|(&k, _)| k as f32))?,
            saturation_v: List::collect(used().map(|(&k, &y)| (k * y) as f32))?,
            base_stiffness_v_per_um: *base as f32,
            offset_v: (offsets.iter().sum::<f64>() / sessions.max(1) as f64) as f32,
        };
        parameters.check().is_ok().then_some(Parameters::MaxwellSlip(parameters))
    }

    /// Elements without stiffness are left out of what is found.
    fn solved(&self, found: &Parameters) -> usize {
        let Parameters::MaxwellSlip(of) = found else { return 0 };
        of.stiffness_v_per_um.len() + ["base stiffness", "offset"].len()
    }
}
