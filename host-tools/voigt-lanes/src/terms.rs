//! What a tick does at the knots: the points of each candidate, all exponentials at once, and of some candidates side
//! by side the affine maps between which a tick's is interpolated.

use crate::branchless::exp;
use crate::knots::{KNOTS, Knots};
use estimator_core::{Voigt, VoigtPoint, VoigtTerms};
use pulp::{Arch, NullaryFnOnce};

/// A number of each candidate that runs side by side with others.
pub type Lanes<const N: usize> = [f64; N];

/// The knots' voltages, and what no candidate changes of them.
pub struct Voltages {
    /// The voltage of each knot, V.
    pub at: [f64; KNOTS],
    /// ln|V|; 0 at 0 V.
    ln: [f64; KNOTS],
}

impl Voltages {
    /// Of these knots; the logarithms are taken once for all candidates.
    pub fn of(knots: &Knots) -> Self {
        let at = std::array::from_fn(|knot| knots.voltage(knot));
        Self { at, ln: at.map(|voltage| if voltage == 0.0 { 0.0 } else { libm::log(voltage.abs()) }) }
    }
}

/// Rate and drive of a candidate at every knot.
pub struct Points {
    rate: [f64; KNOTS],
    drive: [f64; KNOTS],
}

impl Points {
    /// Computes them for a candidate, all knots at once.
    pub fn of(model: &Voigt<f64>, voltages: &Voltages) -> Self {
        // Wider instructions where the machine has them; each point's are the same.
        Arch::new().dispatch(Pointwise { model, voltages })
    }

    /// One after the other, from the lowest voltage up.
    pub fn each<'p>(&'p self, voltages: &'p Voltages) -> impl Iterator<Item = VoigtPoint<f64>> + 'p {
        (0..KNOTS).map(|knot| self.at(knot, voltages))
    }

    fn at(&self, knot: usize, voltages: &Voltages) -> VoigtPoint<f64> {
        VoigtPoint { voltage: voltages.at[knot], rate: self.rate[knot], drive: self.drive[knot] }
    }
}

struct Pointwise<'a> {
    model: &'a Voigt<f64>,
    voltages: &'a Voltages,
}

impl NullaryFnOnce for Pointwise<'_> {
    type Output = Points;

    #[inline(always)]
    fn call(self) -> Points {
        let Self { model, voltages } = self;
        let mut points = Points { rate: [0.0; KNOTS], drive: [0.0; KNOTS] };
        for (rate, voltage) in points.rate.iter_mut().zip(&voltages.at) {
            let x = exp(model.lambda_beta - model.lambda * voltage);
            *rate = model.rate_scale * (2.0 + x + 1.0 / x);
        }
        for ((drive, voltage), ln) in points.drive.iter_mut().zip(&voltages.at).zip(&voltages.ln) {
            let magnitude = exp(model.p * ln + model.ln_drive_scale);
            let signed = if *voltage < 0.0 { -magnitude } else { magnitude };
            *drive = if *voltage == 0.0 { 0.0 } else { signed };
        }
        points
    }
}

/// A term at a knot, and how much more it is at the next.
pub struct Term<const N: usize> {
    here: Lanes<N>,
    more: Lanes<N>,
}

impl<const N: usize> Term<N> {
    fn between(left: Lanes<N>, right: Lanes<N>) -> Self {
        Self { here: left, more: std::array::from_fn(|lane| right[lane] - left[lane]) }
    }

    /// In a lane, a weight's way to the next knot.
    #[inline(always)]
    pub fn at(&self, lane: usize, weight: f64) -> f64 {
        self.here[lane] + weight * self.more[lane]
    }
}

/// The affine map `y ← a·y + c + m·ext` between a knot and the next, each term a weight's way from the knot's.
pub struct Interval<const N: usize> {
    /// What of the displacement is left after a tick, no unit.
    pub a: Term<N>,
    /// What the drive adds in a tick, µm.
    pub c: Term<N>,
}

/// The intervals of some candidates.
pub struct Intervals<const N: usize> {
    /// Between each knot and the next.
    pub each: Vec<Interval<N>>,
    /// The same of `m`; nothing where it is one number for all voltages, as by forward Euler.
    pub m: Vec<Term<N>>,
    /// `m` at the first knot.
    pub first_m: Lanes<N>,
}

impl<const N: usize> Intervals<N> {
    /// Of candidates side by side; `constant`: `m` is one number for all voltages.
    pub fn of(models: [&Voigt<f64>; N], points: [&Points; N], voltages: &Voltages, constant: bool) -> Self {
        let at = |knot| -> [VoigtTerms<f64>; N] {
            std::array::from_fn(|lane| models[lane].terms_at(points[lane].at(knot, voltages)))
        };
        let (mut each, mut m) = (Vec::with_capacity(KNOTS - 1), Vec::new());
        let first = at(0);
        let mut left = first;
        for knot in 1..KNOTS {
            let right = at(knot);
            each.push(Interval {
                a: Term::between(left.map(|of| of.a), right.map(|of| of.a)),
                c: Term::between(left.map(|of| of.c), right.map(|of| of.c)),
            });
            if !constant {
                m.push(Term::between(left.map(|of| of.m), right.map(|of| of.m)));
            }
            left = right;
        }
        Self { each, m, first_m: first.map(|of| of.m) }
    }
}
