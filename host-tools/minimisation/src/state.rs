//! What the methods share: the cost with its budget, the best point so far, the random numbers.

use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// What a search may spend.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct Budget {
    /// Evaluations of the cost at most, the starts' among them.
    pub evaluations: usize,
    /// Of the random numbers.
    pub seed: u64,
}

/// The best point of a search.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Minimum {
    /// Where, within the unit cube. The first start, or else the centre, when no admissible point was found.
    pub at: Vec<f64>,
    /// The cost there; infinite when no admissible point was found.
    pub cost: f64,
    /// Evaluations that the search has made.
    pub evaluations: usize,
}

/// The costs of some points, one each in their order.
pub type Costs<'a> = &'a (dyn Fn(&[Vec<f64>]) -> Vec<f64> + Sync);

/// What a cost is near a point.
#[derive(Clone, PartialEq, Debug)]
pub struct Quadratic {
    /// Its slope along each coordinate.
    pub slope: DVector<f64>,
    /// Its curvature, positive semidefinite.
    pub curvature: DMatrix<f64>,
}

/// What the cost is near a point; `None` where nobody can say.
pub type Quadratics<'a> = &'a (dyn Fn(&[f64]) -> Option<Quadratic> + Sync);

/// What is minimised.
#[derive(Clone, Copy)]
pub struct Objective<'a> {
    /// What costs its candidates have.
    pub costs: Costs<'a>,
    /// What it is near a point, for the methods that make use of it.
    pub quadratic: Quadratics<'a>,
}

impl<'a, F: Fn(&[Vec<f64>]) -> Vec<f64> + Sync> From<&'a F> for Objective<'a> {
    /// Of costs alone.
    fn from(costs: &'a F) -> Self {
        Self { costs, quadratic: &|_| None }
    }
}

/// An evaluated point.
#[derive(Clone, PartialEq, Debug)]
pub struct Scored {
    /// Where, within the unit cube.
    pub at: Vec<f64>,
    /// Its cost, never NaN.
    pub cost: f64,
}

/// A search under way.
pub struct Search<'a> {
    /// Coordinates of a point, at least 1 once a method runs.
    pub dimension: usize,
    /// The best point and the evaluations so far.
    pub best: Minimum,
    /// Seeded by the budget.
    pub random: ChaCha8Rng,
    objective: Objective<'a>,
    limit: usize,
    watch: &'a mut dyn FnMut(usize, &Minimum),
}

impl<'a> Search<'a> {
    /// Nothing evaluated yet.
    pub fn new(
        dimension: usize,
        budget: Budget,
        objective: Objective<'a>,
        watch: &'a mut dyn FnMut(usize, &Minimum),
    ) -> Self {
        Self {
            dimension,
            best: Minimum { at: vec![0.5; dimension], cost: f64::INFINITY, evaluations: 0 },
            random: ChaCha8Rng::seed_from_u64(budget.seed),
            objective,
            limit: budget.evaluations,
            watch,
        }
    }

    /// Evaluations that the budget still has.
    pub fn left(&self) -> usize {
        self.limit.saturating_sub(self.best.evaluations)
    }

    /// What is minimised, for a method that evaluates by itself and then calls [`Self::note`].
    pub fn objective(&self) -> Objective<'a> {
        self.objective
    }

    /// Evaluates points of the unit cube, as many of the first as the budget has left; returns those.
    pub fn evaluate(&mut self, mut points: Vec<Vec<f64>>) -> Vec<Scored> {
        points.truncate(self.left());
        if points.is_empty() {
            return Vec::new();
        }
        let costs = (self.objective.costs)(&points);
        let scored = points.into_iter().zip(costs).map(|(at, cost)| Scored { cost: admissible(cost), at });
        let scored: Vec<Scored> = scored.collect();
        self.note(scored.len(), &scored);
        scored
    }

    /// Counts evaluations and keeps the best of some points.
    pub fn note(&mut self, evaluations: usize, points: &[Scored]) {
        if evaluations == 0 {
            return;
        }
        self.best.evaluations += evaluations;
        for point in points {
            if point.cost < self.best.cost {
                self.best.at.clone_from(&point.at);
                self.best.cost = point.cost;
            }
        }
        (self.watch)(self.best.evaluations, &self.best);
    }

    /// Evaluates the given starts; the cheapest first.
    pub fn starts(&mut self, starts: &[Vec<f64>]) -> Vec<Scored> {
        let inside =
            |start: &Vec<f64>| start.iter().map(|&x| if x.is_nan() { 0.5 } else { x.clamp(0.0, 1.0) }).collect();
        let starts: Vec<Vec<f64>> = starts.iter().filter(|start| start.len() == self.dimension).map(inside).collect();
        if let Some(first) = starts.first() {
            self.best.at.clone_from(first);
        }
        let mut scored = self.evaluate(starts);
        sort(&mut scored);
        scored
    }

    /// A point anywhere in the cube.
    pub fn anywhere(&mut self) -> Vec<f64> {
        (0..self.dimension).map(|_| self.random.random()).collect()
    }

    /// Fills a population up to a size with points anywhere in the cube. It stays smaller when the budget ends.
    pub fn fill(&mut self, population: &mut Vec<Scored>, size: usize) {
        population.truncate(size);
        let points = (population.len()..size).map(|_| self.anywhere()).collect();
        population.extend(self.evaluate(points));
    }
}

/// NaN is infinite.
pub fn admissible(cost: f64) -> f64 {
    if cost.is_nan() { f64::INFINITY } else { cost }
}

/// The cheapest first, equals in their order.
pub fn sort(points: &mut [Scored]) {
    points.sort_by(|a, b| a.cost.total_cmp(&b.cost));
}

/// A coordinate mirrored at 0 and 1 until it lies between.
pub fn reflect(x: f64) -> f64 {
    let x = x.rem_euclid(2.0);
    if x > 1.0 { 2.0 - x } else { x }
}

/// The largest extent of some points along a coordinate.
pub fn extent<'p>(points: impl Iterator<Item = &'p [f64]> + Clone, dimension: usize) -> f64 {
    let along = |i: usize| {
        let coordinate = points.clone().filter_map(|point| point.get(i).copied());
        let (low, high) =
            coordinate.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        high - low
    };
    (0..dimension).map(along).fold(0.0, f64::max)
}

/// So close together, as a fraction of the cube's edge, a population finds nothing new.
pub const COLLAPSED: f64 = 1e-9;
