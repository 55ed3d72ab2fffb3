//! The three conditions on f and g of the Duhem model, Eq. (3.12); thesis Section 3.3.
//!
//! ```text
//! (a) f increases, and f' has a finite limit for V → ∞
//! (b) g is even and has the same limit
//! (c) f'(V) > g(V) > α·exp(α·V)·∫_V^∞ |f'(ζ) − g(ζ)|·exp(−α·ζ) dζ  for all V > 0
//! ```
//!
//! The thesis prints `exp(+α·ζ)` in (c). The integral is what the falling limit branch lies above f, so (c) says that
//! the displacement lags (f' > g) and that, at V > 0, it rises with the voltage even just after a reversal from that
//! branch, where its slope is `g − α·(y − f)`; that needs the minus sign. Where f' = g from some voltage on, as in
//! Hodgdon's own choice (IEEE Trans. Magn. 24 (1988) 218), there is no hysteresis there, and (c) is asked only below
//! it.
//!
//! Bouc-Wen with n = 1, γ = δ = d2 = 0 is of this form: f' = d1, g = d1 + c·A, α = β.

use crate::math::Real;
use serde::Serialize;

/// A condition of Section 3.3.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum DuhemCondition {
    /// (a): f increases, with a finite slope.
    Increasing,
    /// (b): g is even and ends at the slope of f.
    Even,
    /// (c), left: g is less than the slope of f, so that the displacement lags.
    Lagging,
    /// (c), right: the displacement rises with the voltage after a reversal from the falling limit branch.
    Rising,
}

impl core::fmt::Display for DuhemCondition {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Increasing => "(a): f must increase, with a finite slope",
            Self::Even => "(b): g must be even and have the limit of the slope of f",
            Self::Lagging => "(c): g must be less than the slope of f",
            Self::Rising => "(c): g must exceed what the memory of a reversal takes from the slope",
        })
    }
}

/// Cells between 0 and the tail.
const CELLS: u16 = 512;

/// The first condition that the slope f' and g (µm/V, functions of the voltage in V) do not meet, on a grid of 512
/// cells from 0 to `tail`, the voltage from which both are constant; `alpha` in 1/V.
pub fn unmet_condition<T: Real>(
    alpha: T,
    tail: T,
    slope: impl Fn(T) -> T,
    g: impl Fn(T) -> T,
) -> Option<DuhemCondition> {
    let width = tail / T::of(f32::from(CELLS));
    let middle = |cell: u16| (T::of(f32::from(cell)) + T::of(0.5)) * width;
    let equal = |a: T, b: T| (a - b).abs() <= T::of(1e-5) * (a.abs() + b.abs());
    let ends = [tail, -tail];
    let points = || (0..CELLS).map(middle).chain([tail]);
    if points().any(|v| [slope(v), slope(-v)].iter().any(|s| !(s.is_finite() && *s >= T::zero()))) {
        return Some(DuhemCondition::Increasing);
    }
    if points().any(|v| !equal(g(v), g(-v))) || ends.iter().any(|&v| !equal(g(v), slope(v))) {
        return Some(DuhemCondition::Even);
    }
    if (0..CELLS).map(middle).any(|v| slope(v) <= g(v)) {
        return Some(DuhemCondition::Lagging);
    }
    // α·exp(αV)·∫_V^∞ …, from the tail (where it is 0) down to V, each cell with the difference in its middle.
    let covered = -(-alpha * width).exp_m1();
    let mut memory = T::zero();
    for cell in (0..CELLS).rev() {
        let v = middle(cell);
        memory = memory + ((slope(v) - g(v)).abs() - memory) * covered;
        if g(v) <= memory {
            return Some(DuhemCondition::Rising);
        }
    }
    None
}
