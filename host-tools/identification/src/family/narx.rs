//! NARX polynomials: for each structure the coefficients follow from one-step prediction by least squares; the
//! structure that simulates best counts.

use super::AnyFamily;
use crate::problem::Problem;
use crate::search::Gene;
use estimator_core::{List, Narx, NarxParameters, Parameters, Published, Recursion};
use least_squares::{Normal, Sign, Waiting};
use recordings::session::Session;
use std::sync::{Arc, OnceLock};

/// One of the structures that are tried.
pub struct Family {
    /// Orders, degree, inputs and scales; its coefficients are none yet.
    base: NarxParameters,
    ridge: f64,
    /// Of all ticks of the problem that the structure was laid out for, without a ridge: the dear part of a candidate,
    /// and the same for every ridge.
    normal: Arc<OnceLock<Normal>>,
}

/// What a black box of Table 5.1 looks at.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BlackBoxInputs {
    /// r_y, which is r_u too: 1 to 3.
    pub output_order: u8,
    /// Whether V_ext is an input.
    pub with_voltage_extremum: bool,
    /// Whether y_ext is an input.
    pub with_displacement_extremum: bool,
}

/// Those of Table 5.1, of degrees 1 to 3.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    let extrema = [(false, false), (true, false), (true, true)];
    let orders = (1..=3).flat_map(|order| (1..=3).map(move |degree| (order, degree)));
    let all = orders.flat_map(|orders| extrema.map(|extrema| (orders, extrema)));
    all.flat_map(|((output_order, degree), (with_voltage_extremum, with_displacement_extremum))| {
        let inputs = BlackBoxInputs { output_order, with_voltage_extremum, with_displacement_extremum };
        of(inputs, degree, problem)
    })
    .collect()
}

/// Those with these inputs, of degrees 1 to 3.
pub fn structures_with(inputs: BlackBoxInputs, problem: &Problem) -> Vec<AnyFamily> {
    (1..=3).flat_map(|degree| of(inputs, degree, problem)).collect()
}

fn of(inputs: BlackBoxInputs, degree: u8, problem: &Problem) -> [AnyFamily; RIDGES.len()] {
    let BlackBoxInputs { output_order, with_voltage_extremum, with_displacement_extremum } = inputs;
    let (voltage, stroke) = (problem.training_voltages(), problem.stroke());
    let base = NarxParameters {
        output_order,
        input_order: output_order,
        degree,
        with_voltage_extremum,
        with_displacement_extremum,
        voltage_centre_v: (0.5 * (voltage.min + voltage.max)) as f32,
        voltage_scale_v: (0.5 * voltage.span()) as f32,
        displacement_centre_um: (0.5 * (stroke.min + stroke.max)) as f32,
        displacement_scale_um: (0.5 * stroke.span()) as f32,
        deadband_v: problem.deadband as f32,
        coefficients: List::of([]),
        limits_um: problem.tight_limits(),
    };
    let normal = Arc::default();
    RIDGES.map(|ridge| Box::new(Family { base, ridge, normal: Arc::clone(&normal) }) as AnyFamily)
}

/// The regressors of a slow movement are nearly alike, and what predicts one step best is often unstable, or not
/// proven to contract.
const RIDGES: [f64; 6] = [1e-9, 1e-6, 1e-4, 1e-2, 0.1, 1.0];

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        Vec::new()
    }

    fn project(&self, _values: &[f64], problem: &Problem) -> Option<Parameters> {
        let normal = self.normal.get_or_init(|| normal(&self.base, problem)).clone().ridge(self.ridge);
        let found = normal.solve(&vec![Sign::Free; normal.columns()])?;
        let coefficients = List::collect(found.iter().map(|&x| x as f32))?;
        let parameters = NarxParameters { coefficients, ..self.base };
        parameters.check().is_ok().then_some(Parameters::Narx(parameters))
    }

    fn solved(&self, found: &Parameters) -> usize {
        let Parameters::Narx(of) = found else { return 0 };
        of.coefficients.len()
    }
}

/// The normal equations of one-step prediction over all training sessions.
fn normal(base: &NarxParameters, problem: &Problem) -> Normal {
    let model = Narx::<f64>::build(base, problem.extent().tick);
    let mut normal = Normal::new(base.count());
    for session in problem.training() {
        add(&model, session, &mut normal);
    }
    normal
}

/// One row a tick. Between two measurements of a log slower than the tick the displacement is interpolated.
fn add(model: &Narx<f64>, session: &Session, normal: &mut Normal) {
    let weight = 1.0 / session.voltage.len().max(1) as f64;
    let (Some(&voltage), Some(&displacement)) = (session.voltage.first(), session.displacement.first()) else { return };
    let mut state = model.begin(voltage, Some(displacement));
    let (mut row, mut waiting) = (Vec::with_capacity(normal.columns()), Waiting::of_weight(weight));
    for (instants, values) in session.instants.windows(2).zip(session.displacement.windows(2)) {
        let (&[from, to], &[first, last]) = (instants, values) else { continue };
        for tick in from..to {
            let at = |tick: u32| first + (last - first) * f64::from(tick - from) / f64::from(to - from);
            model.observe(&mut state, session.voltage[tick as usize], at(tick));
            row.clear();
            model.row(&state, |x| row.push(x));
            waiting.add(normal, &row, model.normalise(at(tick + 1)));
        }
    }
    waiting.finish(normal);
}
