//! Downhill from the best start or the centre, and once more from elsewhere: by [Newton's steps](super::newton) where
//! the cost's owner says what it is near a point, else by Nelder and Mead's simplex with the coefficients for many
//! dimensions (Gao and Han, 2012), limited to the cube.
//!
//! Either finds the minimum next to where it begins, and the simplex forgets directions, above all at a face of the
//! cube. So what the first descent has found is tried by pairs of descents, which run at the same time: from the best
//! of some points anywhere, and for the simplex one around the best point. The search ends where a pair finds nothing
//! better, and need not spend its budget.

use super::newton;
use super::state::{Budget, Minimum, Objective, Scored, Search, extent, sort};
use rand::RngExt;
use rayon::prelude::*;

/// Edge of the first simplex around a point, of the cube's.
const EDGE: f64 = 0.1;
/// Extent of a simplex at which it has converged.
const CONVERGED: f64 = 1e-5;
/// Difference of a simplex's costs at which it has, as a fraction of the cost.
const LEVEL: f64 = 1e-5;
/// An improvement that a pair has to make for the search to go on, as a fraction of the cost: of simplexes, which stop
/// short of a minimum, and of Newton's steps, for which it is another minimum.
const WORTHWHILE: f64 = 1e-4;
const ANOTHER: f64 = 1e-2;

/// Searches until nothing better is found, or the budget is spent.
pub fn run(search: &mut Search<'_>) {
    if search.best.cost == f64::INFINITY {
        search.evaluate(vec![search.best.at.clone()]);
    }
    let before = search.left();
    let smooth = downhill(search);
    // A pair that the budget ends amid has seldom found anything better.
    let pair = if search.best.cost.is_finite() { 2 * (before - search.left()) } else { 0 };
    let mut helped = true;
    while helped && search.left() > pair {
        let before = search.best.cost;
        let (afar, other) = (explore(search), if smooth { explore(search) } else { best(search) });
        let half = search.left() / 2;
        let branches = [(other, search.left() - half), (afar, half)]
            .map(|(centre, evaluations)| (centre, Budget { evaluations, seed: search.random.random() }));
        let objective = search.objective();
        let branch = |(centre, budget)| descended(objective, budget, centre);
        let found: Vec<Minimum> = branches.into_par_iter().map(branch).collect();
        for Minimum { at, cost, evaluations } in found {
            search.note(evaluations, &[Scored { at, cost }]);
        }
        let worthwhile = if smooth { ANOTHER } else { WORTHWHILE };
        helped = before == f64::INFINITY || search.best.cost < before - worthwhile * before.abs();
    }
}

/// What a descent from a point finds with a budget of its own.
fn descended(objective: Objective<'_>, budget: Budget, centre: Scored) -> Minimum {
    let mut unwatched = |_: usize, _: &Minimum| ();
    let mut own = Search::new(centre.at.len(), budget, objective, &mut unwatched);
    own.best = Minimum { at: centre.at, cost: centre.cost, evaluations: 0 };
    downhill(&mut own);
    own.best
}

/// Descends from the best point; true where by Newton's steps.
fn downhill(search: &mut Search<'_>) -> bool {
    let smooth = newton::descend(search, search.objective().quadratic);
    if !smooth {
        let centre = best(search);
        if let Some(simplex) = around(search, centre) {
            descend(search, simplex);
        }
    }
    smooth
}

fn best(search: &Search<'_>) -> Scored {
    Scored { at: search.best.at.clone(), cost: search.best.cost }
}

/// The best of four points a dimension anywhere.
fn explore(search: &mut Search<'_>) -> Scored {
    let points = (0..4 * search.dimension).map(|_| search.anywhere()).collect();
    let scored = search.evaluate(points);
    scored.into_iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).unwrap_or_else(|| best(search))
}

/// A simplex with one edge along each coordinate, either way at random where there is room. `None` when the budget
/// ends or nothing of it is admissible.
fn around(search: &mut Search<'_>, centre: Scored) -> Option<Vec<Scored>> {
    let edge = if search.random.random() { EDGE } else { EDGE / 3.0 };
    let vertices = (0..search.dimension)
        .map(|i| {
            let mut at = centre.at.clone();
            let up = if search.random.random() { edge } else { -edge };
            if let Some(x) = at.get_mut(i) {
                *x += if (0.0..=1.0).contains(&(*x + up)) { up } else { -up };
            }
            at
        })
        .collect();
    let mut simplex = search.evaluate(vertices);
    simplex.push(centre);
    sort(&mut simplex);
    (simplex.len() > search.dimension && simplex.first()?.cost < f64::INFINITY).then_some(simplex)
}

/// Moves a simplex until it has converged or the budget ends. `None` is the latter.
fn descend(search: &mut Search<'_>, mut simplex: Vec<Scored>) -> Option<()> {
    let n = search.dimension.max(2) as f64;
    let (expansion, contraction, shrinkage) = (1.0 + 2.0 / n, 0.75 - 0.5 / n, 1.0 - 1.0 / n);
    while extent(simplex.iter().map(|x| x.at.as_slice()), search.dimension) > CONVERGED {
        let (low, high) = (simplex.first()?.cost, simplex.last()?.cost);
        if high - low <= LEVEL * low.abs() {
            break;
        }
        let worst = simplex.pop()?;
        let (best, second) = (simplex.first()?.cost, simplex.last()?.cost);
        let reflected = beyond(search, &simplex, &worst, 1.0)?;
        let moved = if reflected.cost < best {
            let expanded = beyond(search, &simplex, &worst, expansion)?;
            Some(if expanded.cost < reflected.cost { expanded } else { reflected })
        } else if reflected.cost < second {
            Some(reflected)
        } else if reflected.cost < worst.cost {
            let outside = beyond(search, &simplex, &worst, contraction)?;
            (outside.cost <= reflected.cost).then_some(outside)
        } else {
            let inside = beyond(search, &simplex, &worst, -contraction)?;
            (inside.cost < worst.cost).then_some(inside)
        };
        match moved {
            Some(vertex) => simplex.push(vertex),
            None => {
                simplex.push(worst);
                simplex = shrunk(search, &simplex, shrinkage)?;
            }
        }
        sort(&mut simplex);
    }
    Some(())
}

/// The point at a multiple of the way from the worst vertex to the centroid of the others, beyond that.
fn beyond(search: &mut Search<'_>, others: &[Scored], worst: &Scored, multiple: f64) -> Option<Scored> {
    let coordinate = |(i, x): (usize, &f64)| {
        let centroid = others.iter().filter_map(|vertex| vertex.at.get(i)).sum::<f64>() / others.len() as f64;
        (centroid + multiple * (centroid - x)).clamp(0.0, 1.0)
    };
    search.evaluate(vec![worst.at.iter().enumerate().map(coordinate).collect()]).pop()
}

/// All vertices drawn towards the best, which is the first.
fn shrunk(search: &mut Search<'_>, simplex: &[Scored], factor: f64) -> Option<Vec<Scored>> {
    let (best, others) = simplex.split_first()?;
    let towards = |vertex: &Scored| {
        vertex.at.iter().zip(&best.at).map(|(x, best)| (best + factor * (x - best)).clamp(0.0, 1.0)).collect()
    };
    let mut moved = search.evaluate(others.iter().map(towards).collect());
    moved.push(best.clone());
    (moved.len() == simplex.len()).then_some(moved)
}
