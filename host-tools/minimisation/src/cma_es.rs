//! Covariance matrix adaptation (Hansen, The CMA Evolution Strategy: A Tutorial, 2016, positive weights only), with
//! restarts of a doubled population (Auger and Hansen, 2005).
//!
//! Points are m + σ·B·D·z, z normal, C = B·D²·Bᵀ. The cost is continued beyond the cube by mirroring, so that the
//! distribution knows no bounds and a minimum on a face is one inside. The first run starts at the best start or the
//! centre, a restart anywhere. Where no point of a generation is admissible, σ is halved around the best known point.
//!
//! `nalgebra` is built on `libm` and without machine-dependent kernels, so that a seed means the same
//! on every platform.

use super::state::{COLLAPSED, Search, reflect};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand::Rng;
use rand_distr::{Distribution, StandardNormal};
use std::collections::VecDeque;

/// First σ, of the cube's edge.
const SIGMA: f64 = 0.3;
/// Condition of C at which a run ends.
const ILL_CONDITIONED: f64 = 1e14;
/// Sweeps for an eigenvalue; a few suffice.
const SWEEPS: usize = 1000;

/// Spends the budget of a search.
pub fn run(search: &mut Search<'_>) {
    let default = 4 + (3.0 * libm::log(search.dimension as f64)) as usize;
    let mut mean = search.best.at.clone();
    let mut size = default;
    while search.left() > 0 {
        converge(search, mean, size);
        mean = search.anywhere();
        // A population that the rest of the budget has less than ten generations for adapts to nothing.
        size = (2 * size).min((search.left() / 10).max(default));
    }
}

/// One run, to its end or the budget's.
fn converge(search: &mut Search<'_>, mean: Vec<f64>, size: usize) {
    let rates = Rates::new(search.dimension, size);
    let mut state = State::new(mean);
    let remembered = 10 + 30 * search.dimension / size;
    let mut costs = VecDeque::new();
    loop {
        let Some(basis) = state.basis() else { return };
        let drawn: Vec<Draw> = (0..size).map(|_| Draw::new(&basis, &mut search.random)).collect();
        let points = drawn.iter().map(|draw| state.point(draw)).collect();
        let scored = search.evaluate(points);
        if scored.len() < size {
            return;
        }
        let mut order: Vec<usize> = (0..size).collect();
        order.sort_by(|&a, &b| scored[a].cost.total_cmp(&scored[b].cost));
        let (best, worst) = (scored[order[0]].cost, scored[order[size - 1]].cost);
        if best == f64::INFINITY {
            if search.best.cost == f64::INFINITY || state.sigma < COLLAPSED {
                return;
            }
            state.mean = DVector::from_column_slice(&search.best.at);
            state.sigma /= 2.0;
            continue;
        }
        let order: Vec<&Draw> = order.iter().map(|&i| &drawn[i]).collect();
        state.update(&rates, &order);
        costs.push_back(best);
        if costs.len() > remembered {
            costs.pop_front();
            let (low, high) = costs.iter().fold((best, worst), |(low, high), &c| (low.min(c), high.max(c)));
            if high - low <= 1e-12 * low.abs() {
                return;
            }
        }
        let reach = state.sigma * basis.scale.max();
        if !(COLLAPSED..1e3).contains(&reach) {
            return;
        }
    }
}

/// Weights and learning rates (Table 1 of the tutorial).
struct Rates {
    weights: Vec<f64>,
    /// Variance-effective selection mass.
    mass: f64,
    /// Of the path of σ and of the path of C.
    sigma_path: f64,
    covariance_path: f64,
    rank_one: f64,
    rank_mu: f64,
    damping: f64,
    /// Expected length of a normal vector.
    length: f64,
}

impl Rates {
    fn new(dimension: usize, size: usize) -> Self {
        let n = dimension as f64;
        let middle = (size as f64 + 1.0) / 2.0;
        let weights: Vec<f64> = (1..=size / 2).map(|i| libm::log(middle) - libm::log(i as f64)).collect();
        let sum: f64 = weights.iter().sum();
        let weights: Vec<f64> = weights.iter().map(|weight| weight / sum).collect();
        let mass = 1.0 / weights.iter().map(|weight| weight * weight).sum::<f64>();
        let sigma_path = (mass + 2.0) / (n + mass + 5.0);
        let rank_one = 2.0 / ((n + 1.3) * (n + 1.3) + mass);
        Self {
            weights,
            mass,
            sigma_path,
            covariance_path: (4.0 + mass / n) / (n + 4.0 + 2.0 * mass / n),
            rank_one,
            rank_mu: (2.0 * (0.25 + mass + 1.0 / mass - 2.0) / ((n + 2.0) * (n + 2.0) + mass)).min(1.0 - rank_one),
            damping: 1.0 + 2.0 * (((mass - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + sigma_path,
            length: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
        }
    }
}

/// B and D.
struct Basis {
    axes: DMatrix<f64>,
    scale: DVector<f64>,
}

/// One draw: B·z, and the step B·D·z.
struct Draw {
    white: DVector<f64>,
    step: DVector<f64>,
}

impl Draw {
    fn new(basis: &Basis, random: &mut impl Rng) -> Self {
        let z = DVector::from_fn(basis.scale.len(), |_, _| StandardNormal.sample(random));
        Self { step: &basis.axes * basis.scale.component_mul(&z), white: &basis.axes * z }
    }
}

/// The distribution and the two evolution paths.
struct State {
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    sigma_path: DVector<f64>,
    covariance_path: DVector<f64>,
    generation: i32,
}

impl State {
    fn new(mean: Vec<f64>) -> Self {
        let n = mean.len();
        Self {
            mean: DVector::from_vec(mean),
            sigma: SIGMA,
            covariance: DMatrix::identity(n, n),
            sigma_path: DVector::zeros(n),
            covariance_path: DVector::zeros(n),
            generation: 0,
        }
    }

    /// `None` when C is no longer a covariance worth going on with.
    fn basis(&self) -> Option<Basis> {
        let finite = |x: &f64| x.is_finite();
        if !(self.covariance.iter().all(finite) && self.mean.iter().all(finite) && self.sigma.is_finite()) {
            return None;
        }
        let eigen = SymmetricEigen::try_new(self.covariance.clone(), f64::EPSILON, SWEEPS)?;
        let (low, high) = (eigen.eigenvalues.min(), eigen.eigenvalues.max());
        let sound = low > 0.0 && high < ILL_CONDITIONED * low;
        sound.then(|| Basis { axes: eigen.eigenvectors, scale: eigen.eigenvalues.map(f64::sqrt) })
    }

    fn point(&self, draw: &Draw) -> Vec<f64> {
        self.mean.iter().zip(&draw.step).map(|(mean, step)| reflect(mean + self.sigma * step)).collect()
    }

    /// Equations (42) … (47) of the tutorial, with the draws of a generation, the cheapest first.
    fn update(&mut self, rates: &Rates, order: &[&Draw]) {
        let n = self.mean.len();
        let (mut white, mut step) = (DVector::zeros(n), DVector::zeros(n));
        for (&weight, draw) in rates.weights.iter().zip(order) {
            white.axpy(weight, &draw.white, 1.0);
            step.axpy(weight, &draw.step, 1.0);
        }
        self.mean.axpy(self.sigma, &step, 1.0);
        self.generation = self.generation.saturating_add(1);
        let Rates { mass, sigma_path: cs, covariance_path: cc, rank_one, rank_mu, .. } = *rates;
        self.sigma_path.axpy((cs * (2.0 - cs) * mass).sqrt(), &white, 1.0 - cs);
        let length = self.sigma_path.norm();
        let settled = 1.0 - libm::pow(1.0 - cs, f64::from(self.generation) * 2.0);
        // h_σ: C does not follow its path while σ is much too small.
        let follows = length / settled.sqrt() < (1.4 + 2.0 / (n as f64 + 1.0)) * rates.length;
        let gain = if follows { (cc * (2.0 - cc) * mass).sqrt() } else { 0.0 };
        self.covariance_path.axpy(gain, &step, 1.0 - cc);
        let lost = if follows { 0.0 } else { rank_one * cc * (2.0 - cc) };
        self.covariance *= 1.0 - rank_one - rank_mu + lost;
        self.covariance.ger(rank_one, &self.covariance_path, &self.covariance_path, 1.0);
        for (&weight, draw) in rates.weights.iter().zip(order) {
            self.covariance.ger(rank_mu * weight, &draw.step, &draw.step, 1.0);
        }
        self.sigma *= libm::exp((cs / rates.damping * (length / rates.length - 1.0)).min(1.0));
    }
}
