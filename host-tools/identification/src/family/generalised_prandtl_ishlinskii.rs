//! Generalised Prandtl–Ishlinskii models: delay, lag and curvature, and where the logs are fast enough slew limit and resonance, are
//! searched; the weights of the plays' functions, creep and offset are projected.

use super::AnyFamily;
use super::projection::Projection;
use crate::character::Character;
use crate::problem::Problem;
use crate::search::space::Gene;
use estimator_core::{
    GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiParameters, List, Parameters, Published, Range,
};
use least_squares::Sign;

/// Play operators.
const PLAYS: usize = 8;
/// Functions a play.
const DEGREE: usize = 2;
/// Time constants of creep, s. All share one gain, which is log-time creep: a slow one that the logs are too short for would
/// grow without bounds, and a fast one would be taken for hysteresis, or hysteresis for it.
const CREEP_TIMES: [f64; 4] = [0.01, 0.1, 1.0, 10.0];

/// What the model has besides hysteresis, creep and lag.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Extra {
    Nothing,
    Slew,
    Resonance,
}

/// What is fixed before the search.
struct Family {
    extra: Extra,
    span: Range<f64>,
    widest: f64,
    stroke: f64,
    tick: f64,
    /// Steepest voltage, V/s.
    steepest: f64,
}

/// Simplest first. A log slower than the tick shows neither slew nor resonance, and a single frequency cannot tell them from
/// hysteresis.
pub fn structures(problem: &Problem) -> Vec<AnyFamily> {
    let fast = problem.training().any(|session| session.instants.len() == session.voltage.len())
        && !Character::of(problem.training(), problem.deadband).single_frequency();
    let extras: &[Extra] = if fast { &[Extra::Nothing, Extra::Slew, Extra::Resonance] } else { &[Extra::Nothing] };
    extras.iter().map(|&extra| Box::new(Family::new(extra, problem)) as AnyFamily).collect()
}

impl Family {
    fn new(extra: Extra, problem: &Problem) -> Self {
        let tick = problem.extent().tick;
        let steps = problem.training().flat_map(|session| session.voltage.windows(2));
        let largest = steps.filter_map(|pair| Some((pair.last()? - pair.first()?).abs())).fold(0.0, f64::max);
        Self {
            extra,
            span: problem.training_voltages(),
            widest: 0.5 * problem.training_voltages().span() * (PLAYS - 1) as f64 / PLAYS as f64,
            stroke: problem.stroke().span(),
            tick,
            steepest: (largest / tick).max(f64::MIN_POSITIVE),
        }
    }

    /// The set with nothing projected yet.
    fn base(&self, values: &[f64]) -> Option<GeneralisedPrandtlIshlinskiiParameters> {
        let mut values = values.iter().copied();
        let (delay, lag, curvature) = (values.next()?, values.next()?, values.next()?);
        let slew = if self.extra == Extra::Nothing { 0.0 } else { values.next()? * self.steepest };
        let (hertz, damping) =
            if self.extra == Extra::Resonance { (values.next()?, values.next()?) } else { (0.0, 0.0) };
        let half_width = |i: usize| (self.widest * i as f64 / (PLAYS - 1) as f64) as f32;
        Some(GeneralisedPrandtlIshlinskiiParameters {
            span_v: Range { min: self.span.min as f32, max: self.span.max as f32 },
            delay_ticks: delay as f32,
            slew_v_per_s: slew as f32,
            lag_s: (lag * self.tick) as f32,
            half_widths_v: List::collect((0..PLAYS).map(half_width))?,
            resonance_hz: hertz as f32,
            damping: damping as f32,
            weights_um: List::collect([0.0; PLAYS * DEGREE])?,
            creep_times_s: List::collect(CREEP_TIMES.map(|time| time as f32))?,
            creep_um_per_v: List::collect([0.0; CREEP_TIMES.len()])?,
            curvature_per_um: (curvature / self.stroke) as f32,
            offset_um: 0.0,
        })
    }
}

impl super::Family for Family {
    type Found = Parameters;

    fn genes(&self) -> Vec<Gene> {
        let mut genes = vec![
            Gene::linear("delay", "delay from voltage to actuator", "ticks", -1.0, 14.0),
            Gene::logarithmic("lag", "first-order lag", "ticks", 0.1, 100.0),
            Gene::linear("kappa", "κ times the stroke", "", -0.4, 0.4),
        ];
        if self.extra != Extra::Nothing {
            genes.push(Gene::logarithmic("slew", "slew limit, of the steepest voltage", "", 0.05, 20.0));
        }
        if self.extra == Extra::Resonance {
            let most = 0.45 / self.tick;
            genes.push(Gene::logarithmic("resonance", "natural frequency", "Hz", 0.02 * most, most));
            genes.push(Gene::logarithmic("damping", "ζ of the resonance", "", 0.003, 0.7));
        }
        genes
    }

    fn burden(&self, values: &[f64]) -> f64 {
        1.0 + super::DELAYED * values.iter().take(2).map(|ticks| ticks.abs()).sum::<f64>()
    }

    /// The cost has two basins in κ, one of either sign.
    fn starts(&self) -> Vec<Vec<f64>> {
        [0.35, 0.65].map(|curvature| vec![0.1, 0.4, curvature]).to_vec()
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<Parameters> {
        let base = self.base(values)?;
        let model = GeneralisedPrandtlIshlinskii::<f64>::build(&base, self.tick);
        let functions = PLAYS * DEGREE;
        let unknowns: Vec<usize> = (0..functions).chain(CREEP_TIMES.map(|_| functions)).collect();
        let curvature = f64::from(base.curvature_per_um);
        let projection = Projection {
            problem,
            model: &model,
            unknowns: &unknowns,
            signs: &[Sign::NonNegative; PLAYS * DEGREE + 1],
            resonance: model.resonance(),
        };
        let (found, offset) = projection.solve(|y| straightened(y, curvature))?;
        let mut weights = unknowns.iter().filter_map(|&unknown| found.get(unknown)).map(|&weight| weight as f32);
        let parameters = GeneralisedPrandtlIshlinskiiParameters {
            weights_um: List::collect(weights.by_ref().take(functions))?,
            creep_um_per_v: List::collect(weights)?,
            offset_um: offset as f32,
            ..base
        };
        parameters.check().is_ok().then_some(Parameters::GeneralisedPrandtlIshlinskii(parameters))
    }

    fn solved(&self, _found: &Parameters) -> usize {
        PLAYS * DEGREE + ["creep", "offset"].len()
    }
}

/// w of y = w + κ·w², without cancellation for small κ.
fn straightened(y: f64, curvature: f64) -> f64 {
    2.0 * y / (1.0 + (1.0 + 4.0 * curvature * y).max(0.0).sqrt())
}
