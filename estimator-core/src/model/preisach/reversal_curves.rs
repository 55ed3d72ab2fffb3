//! Densities of the Preisach model from first-order reversal curves, Eq. (3.17)–(3.19) (thesis 3.3).
//!
//! From negative saturation the voltage rises to `α`, where the displacement is `y_α`, and falls to `β`, where it is
//! `y_αβ`:
//!
//! ```text
//! E(α, β) = y_α − y_αβ                                             the mass of the triangle β…α
//! m_ij    = E(i+1, j) − E(i, j) − E(i+1, j+1) + E(i, j+1)          µm, j < i
//! m_ii    = 2·E(i+1, i)                                            µm, of which half is there
//! ```
//!
//! in nodes of a grid of equal intervals. Eq. (3.17) halves the difference because its relays give ±1; these give 0 and
//! their mass. The second difference amplifies the error of the displacements by up to 4, so a density may be negative:
//! clip it, or fit the densities to the whole recording instead.

use super::everett::{CELLS, SIDE};
use crate::list::List;
use crate::math::Real;

/// Masses of whole cells (µm), in the order of `densities_um`, of a grid of `side` × `side` cells. `None` unless `side`
/// is 1 to 10.
///
/// `curve(a, b)`, `b ≤ a ≤ side`, is the displacement (µm) at node b of the curve that has turned at node a; node 0 is
/// the lowest voltage. `curve(a, a)` is the displacement at the reversal. Each is asked for more than once.
pub fn densities_from_reversal_curves<T: Real>(
    side: usize,
    curve: impl Fn(usize, usize) -> T,
) -> Option<List<CELLS, T>> {
    if !(1..=SIDE).contains(&side) {
        return None;
    }
    // The Everett function (µm), Eq. (3.17).
    let everett = |a: usize, b: usize| curve(a, a) - curve(a, b);
    let cells = (0..side).flat_map(|row| (0..=row).map(move |column| (row, column)));
    List::collect(cells.map(|(row, column)| {
        if row == column {
            T::of(2.0) * everett(row + 1, row)
        } else {
            let upper = everett(row + 1, column) - everett(row + 1, column + 1);
            upper - (everett(row, column) - everett(row, column + 1))
        }
    }))
}
