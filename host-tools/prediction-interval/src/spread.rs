//! Where the training's voltages have been, and how little is known of what lies elsewhere.
//!
//! ```text
//! φ_i = w_i·p_i                     p plays of the voltage in half ranges, w their share of the displacement, µm
//! S   = (I/α² + n·Σ cov(φ)/s₀²)⁻¹    covariance of a model's errors in the weights; cov over a log, summed over the logs
//! L   = W·C,  C·Cᵀ = S              so that |Lᵀp|² is the error's variance, µm²
//! ```
//!
//! s₀ is the error that is there always, and n the samples of it that a log counts as. So Lᵀ makes a metric in which
//! what the training moved much counts little; how far plays stand from all that the training did is measured in it.

use crate::prototypes::{Plays, nearest, prototypes};
use estimator_core::interval::{HALF_WIDTHS, PLAYS, TRIANGLE};
use estimator_core::model::play;
use estimator_core::{IntervalParameters, Range};
use identification::Problem;
use nalgebra::SMatrix;
use recordings::session::one_of_each;

/// α: how far a weight may be off where nothing is known of it, of itself.
const PRIOR: f64 = 0.3;
/// n: samples that a log counts as. On simulated devices left out, 300 to 3000 are as likely; 10 is much less so.
const WORTH: f64 = 1000.0;
/// Half-width at which the plays weigh 1/e, of half the voltage range; and what they weigh in all, of the stroke.
const LAW: f64 = 0.45;
const HYSTERETIC: f64 = 0.5;
/// Of so many ticks one is a sample of where the voltage has been.
const EVERY: usize = 10;
/// Of where the training has been no more places are looked at.
const MOST: usize = 20_000;
/// Room beyond the farthest that the training has been from a prototype, of that.
const ROOM: f64 = 1.15;

/// What of the interval says where the training has been, in place of what `parameters` has. `voltages` is
/// the table's range.
pub fn learnt(
    parameters: IntervalParameters,
    problem: &Problem,
    voltages: Range<f64>,
    misfit_um: f64,
) -> IntervalParameters {
    let weights = weights(problem.stroke().span());
    let mut information = SMatrix::<f64, PLAYS, PLAYS>::identity() / (PRIOR * PRIOR);
    let mut been: Vec<Plays> = Vec::new();
    for session in problem.training() {
        let places = places(&session.voltage, voltages);
        let count = places.len().max(1) as f64;
        let mean = places.iter().sum::<Plays>() / count;
        let weighed = |place: &Plays| (place - mean).component_mul(&weights);
        let spread = places.iter().map(|place| weighed(place) * weighed(place).transpose());
        information += spread.sum::<SMatrix<f64, PLAYS, PLAYS>>() / count * (WORTH / (misfit_um * misfit_um));
        been.extend(places);
    }
    // Positive definite: it is the identity and squares.
    let covariance = information.try_inverse().unwrap_or_default();
    let factor = covariance.cholesky().map_or(SMatrix::zeros(), |cholesky| cholesky.l());
    let spread = SMatrix::<f64, PLAYS, PLAYS>::from_diagonal(&weights) * factor;
    let step = been.len().div_ceil(MOST).max(1);
    let seen: Vec<Plays> = one_of_each(step, been.len()).map(|at| spread.transpose() * been[at]).collect();
    let centres = prototypes(&seen);
    let reach = centres.iter().map(|centre| centre.amax()).fold(0.0, f64::max);
    let unit = if reach > 0.0 { reach / f64::from(i8::MAX) } else { 1.0 };
    let rounded = centres.map(|centre| (centre / unit).map(f64::round));
    let in_table = rounded.map(|centre| centre * unit);
    let off = |place: &Plays| nearest(&in_table, &(spread.transpose() * place)).1;
    let farthest = been.iter().map(off).fold(0.0, f64::max).sqrt();
    let mut triangle = [0.0; TRIANGLE];
    let lower = (0..PLAYS).flat_map(|row| (0..=row).map(move |column| (row, column)));
    triangle.iter_mut().zip(lower).for_each(|(to, at)| *to = spread[at] as f32);
    IntervalParameters {
        spread_um: triangle,
        prototypes: rounded.map(|centre| std::array::from_fn(|row| centre[row] as i8)),
        prototype_um: unit as f32,
        untrained_um: (ROOM * farthest) as f32,
        ..parameters
    }
}

/// What each play moves, µm for a play that goes from the middle to an end.
fn weights(stroke: f64) -> Plays {
    let law = Plays::from_iterator(HALF_WIDTHS.iter().enumerate().map(|(index, &r)| {
        let before = if index == 0 { 0.0 } else { f64::from(HALF_WIDTHS[index - 1]) };
        libm::exp(-f64::from(r) / LAW) * (f64::from(r) - before)
    }));
    law * (0.5 * HYSTERETIC * stroke / law.sum())
}

/// Where the plays stand now and then, in half voltage ranges from the middle.
fn places(voltage: &[f64], range: Range<f64>) -> Vec<Plays> {
    let half = 0.5 * range.span();
    let at = |volts: f64| (volts - range.middle()) / half;
    let Some(&first) = voltage.first() else { return Vec::new() };
    let mut plays = HALF_WIDTHS.map(|r| play(0.0, at(first), f64::from(r)));
    let mut places = Vec::with_capacity(voltage.len() / EVERY + 1);
    let mut counted = one_of_each(EVERY, voltage.len()).peekable();
    for (tick, &volts) in voltage.iter().enumerate() {
        for (memory, r) in plays.iter_mut().zip(HALF_WIDTHS) {
            *memory = play(*memory, at(volts), f64::from(r));
        }
        if counted.next_if_eq(&tick).is_some() {
            places.push(Plays::from(plays));
        }
    }
    places
}
