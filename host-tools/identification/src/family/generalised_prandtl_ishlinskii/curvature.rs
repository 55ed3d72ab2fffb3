//! How the cost changes with the searched numbers, by Gauss and Newton: along straight lines with them, and less what
//! the coefficients of the columns make up for (variable projection; L. Kaufman, *A variable projection method for
//! solving separable nonlinear least squares problems*, BIT 15, 1975).
//!
//! ```text
//! D_j = (y(x + δ·e_j, c) − y(x, c))/δ            change of the displacement with number j; c what fits best at x
//! ```
//!
//! A descent takes some ten such slopes, where one by costs alone takes hundreds of candidates (the test
//! `slopes_take_a_fraction_of_the_candidates_that_costs_alone_take`).

use super::candidate::{Family, Values};
use crate::problem::Problem;
use crate::search::Quadratic;
use nalgebra::{DMatrix, DVector};
use play_columns::{Blocks, Course, FUNCTIONS, creep};
use rayon::prelude::*;
use recordings::session::Session;

/// Part of a gene's range over which a difference is taken.
const STEP: f64 = 1e-3;

/// The readings of a session as one candidate has them.
struct Readings {
    /// Of the reversible part and of the hysteretic one.
    columns: Vec<[[f64; FUNCTIONS]; 2]>,
    /// What the columns are to make, µm.
    targets: Vec<f64>,
}

impl Readings {
    /// What coefficients leave, µm.
    fn errors(&self, coefficients: &[f64]) -> Vec<f64> {
        let sum = |columns: &[f64]| columns.iter().zip(coefficients).map(|(a, x)| a * x).sum::<f64>();
        self.columns.iter().zip(&self.targets).map(|(columns, target)| target - sum(columns.as_flattened())).collect()
    }
}

/// The cost near a point, in parts of the genes' ranges; `None` where there is no solution.
pub fn quadratic(family: &Family, at: &[f64], problem: &Problem) -> Option<Quadratic> {
    let sessions = family.sessions(problem);
    let genes = family.searched();
    let values = |at: &[f64]| family.values(&genes.iter().zip(at).map(|(gene, &x)| gene.value(x)).collect::<Vec<_>>());
    let here = read(family, &values(at)?, &sessions);
    let found = blocks(family, &sessions, &here, &[]).balanced(&[])?;
    let change = |along: usize| {
        let by = if at[along] > 0.5 { -STEP } else { STEP };
        let there = read(family, &values(&moved(at, &[(along, by)]))?, &sessions);
        let of_session = |(here, there): (&Readings, &Readings)| {
            let errors = here.errors(found.common()).into_iter().zip(there.errors(found.common()));
            errors.map(|(before, after)| (before - after) / by).collect()
        };
        Some(here.iter().zip(&there).map(of_session).collect())
    };
    let changes: Vec<Vec<Vec<f64>>> = (0..at.len()).into_par_iter().map(change).collect::<Option<_>>()?;
    let (slope, curvature) = blocks(family, &sessions, &here, &changes).along(&found, at.len())?;
    let unlikely = |at: &[f64]| Some(values(at)?.unlikely(family.tick, problem.lag_s));
    let (prior_slope, prior_curvature) = by_differences(unlikely, at)?;
    let half = 0.5 * libm::exp(0.5 * (found.total + unlikely(at)?));
    Some(Quadratic { slope: half * (slope + prior_slope), curvature: half * (curvature + prior_curvature) })
}

/// Every session's readings, a walk each.
fn read(family: &Family, values: &Values, sessions: &[(&Session, &Course)]) -> Vec<Readings> {
    let (plays, creep) = (family.weighed(values.law), creep(values.gains));
    let stages = family.stages(values, &plays, &creep);
    let of = |(session, course): &(&Session, &Course)| {
        let count = course.readings.len();
        let mut readings = Readings { columns: Vec::with_capacity(count), targets: Vec::with_capacity(count) };
        stages.walk(session, course, |index, columns, input| {
            readings.columns.push(*columns);
            readings.targets.push(session.displacement[index] - family.least_slope() * (input - family.span.min));
        });
        readings
    };
    sessions.iter().map(of).collect()
}

/// The least squares of the readings' columns and, behind those, of changes: one list a session for each.
fn blocks(family: &Family, sessions: &[(&Session, &Course)], read: &[Readings], changes: &[Vec<Vec<f64>>]) -> Blocks {
    let mut blocks = Blocks::new(2, changes.len(), sessions, family.scale);
    let mut row = Vec::new();
    for (number, ((session, course), read)) in sessions.iter().zip(read).enumerate() {
        let mut rows = blocks.of(number);
        for (reading, &index) in course.readings.iter().enumerate() {
            row.clear();
            row.extend_from_slice(read.columns[reading].as_flattened());
            row.extend(changes.iter().map(|change| change[number][reading]));
            rows.add(session.instants[index], index < course.settled, &row, read.targets[reading]);
        }
        rows.finish();
    }
    blocks
}

/// Slope and curvature of a function that is cheap, by central differences; along the directions in which it is concave
/// its curvature is taken for 0.
fn by_differences(of: impl Fn(&[f64]) -> Option<f64>, at: &[f64]) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let n = at.len();
    let (mut slope, mut curvature) = (DVector::zeros(n), DMatrix::zeros(n, n));
    for i in 0..n {
        slope[i] = (of(&moved(at, &[(i, STEP)]))? - of(&moved(at, &[(i, -STEP)]))?) / (2.0 * STEP);
        for j in 0..=i {
            let corner = |a: f64, b: f64| of(&moved(at, &[(i, a * STEP), (j, b * STEP)]));
            let mixed = corner(1.0, 1.0)? - corner(1.0, -1.0)? - corner(-1.0, 1.0)? + corner(-1.0, -1.0)?;
            curvature[(i, j)] = mixed / (4.0 * STEP * STEP);
            curvature[(j, i)] = curvature[(i, j)];
        }
    }
    let mut directions = curvature.symmetric_eigen();
    directions.eigenvalues.apply(|curved| *curved = curved.max(0.0));
    Some((slope, directions.recompose()))
}

/// A point with some of its coordinates moved.
fn moved(at: &[f64], by: &[(usize, f64)]) -> Vec<f64> {
    let mut to = at.to_vec();
    by.iter().for_each(|&(i, by)| to[i] += by);
    to
}
