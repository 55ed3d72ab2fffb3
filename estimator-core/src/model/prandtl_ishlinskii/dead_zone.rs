//! Superposition of one-sided dead zones: the memoryless, strictly increasing, piecewise linear curve that makes a
//! hysteresis model's loops asymmetric (Kuhnen, "Modeling, identification and compensation of complex hysteretic
//! nonlinearities: a modified Prandtl-Ishlinskii approach", Eur. J. Control 9, 2003).
//!
//! ```text
//! S(x) = Σ s_j·S_j(x),   S_j(x) = x                 for d_j = 0
//!                               = max(x − d_j, 0)   for d_j > 0
//!                               = min(x − d_j, 0)   for d_j < 0
//! ```
//!
//! `S(0) = 0`. Beyond `d_j`, away from 0, the slope is the sum of the slopes of all dead zones from 0 to `d_j`. The
//! inverse is a superposition too: `d'_j = S(d_j)`, and the sums of its slopes are the reciprocals of these sums.

use crate::math::Real;
use crate::rule::{self, Rule};

/// Most dead zones of a superposition, the one at 0 included.
pub const DEAD_ZONES: usize = 8;

/// A strictly increasing curve through the origin.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Superposition<T> {
    count: usize,
    dead_zones: [T; DEAD_ZONES],
    slopes: [T; DEAD_ZONES],
}

/// Checks dead zones (µm) and their slopes; none at all are the identity.
///
/// # Errors
/// The rule that they break.
pub(super) fn check(dead_zones: &[f32], slopes: &[f32]) -> Result<(), Rule> {
    if dead_zones.len() != slopes.len() {
        return Err("dead_zone_slopes must be as many as dead_zones_um");
    }
    if !dead_zones.iter().chain(slopes).all(|number| number.is_finite()) {
        return Err("dead_zones_um and dead_zone_slopes must be finite");
    }
    if dead_zones.is_empty() {
        return Ok(());
    }
    if !dead_zones.windows(2).all(|pair| matches!(pair, [a, b] if a < b)) {
        return Err("dead_zones_um must increase");
    }
    if !dead_zones.contains(&0.0) {
        return Err("dead_zones_um must contain 0");
    }
    let zones = || dead_zones.iter().zip(slopes);
    let stays_positive = |sum: &mut f32, (_, slope): (&f32, &f32)| {
        *sum += slope;
        Some(*sum > 0.0)
    };
    let right = zones().filter(|(dead_zone, _)| **dead_zone >= 0.0).scan(0.0, stays_positive).all(|positive| positive);
    let left =
        zones().rev().filter(|(dead_zone, _)| **dead_zone <= 0.0).scan(0.0, stays_positive).all(|positive| positive);
    rule::check([("dead_zone_slopes must sum to more than 0 from 0 to every dead zone", right && left)])
}

impl<T: Real> Superposition<T> {
    /// The superposition of these dead zones (increasing) with these slopes; the identity where there are none.
    pub fn build(dead_zones: &[f32], slopes: &[f32]) -> Self {
        let mut built = Self { count: 1, dead_zones: [T::zero(); DEAD_ZONES], slopes: [T::zero(); DEAD_ZONES] };
        if dead_zones.is_empty() {
            built.slopes.iter_mut().take(1).for_each(|slope| *slope = T::one());
            return built;
        }
        built.count = dead_zones.len().min(slopes.len()).min(DEAD_ZONES);
        built.dead_zones.iter_mut().zip(dead_zones).for_each(|(to, &from)| *to = T::of(from));
        built.slopes.iter_mut().zip(slopes).for_each(|(to, &from)| *to = T::of(from));
        built
    }

    /// S(x), µm, of a weighted sum of plays x, µm.
    #[inline]
    pub fn apply(&self, x: T) -> T {
        let mut y = T::zero();
        for (&dead_zone, &slope) in self.dead_zones.iter().zip(&self.slopes).take(self.count) {
            let beyond = if x > dead_zone { dead_zone >= T::zero() } else { x < dead_zone && dead_zone <= T::zero() };
            if beyond {
                y = y + slope * (x - dead_zone);
            }
        }
        y
    }

    /// S⁻¹, made of dead zones, too: from µm back to the weighted sum of plays, µm.
    pub fn inverse(&self) -> Self {
        let mut inverse = *self;
        let at_zero = self.dead_zones.iter().zip(&self.slopes).take(self.count).find(|(zone, _)| **zone == T::zero());
        let first = at_zero.map_or(T::zero(), |(_, &slope)| slope);
        let beyond = |sum: &mut T, dead_zone: &mut T, slope: &mut T| {
            let before = *sum;
            *sum = before + *slope;
            *dead_zone = self.apply(*dead_zone);
            *slope = T::one() / *sum - T::one() / before;
        };
        let (mut right, mut left) = (first, first);
        for (dead_zone, slope) in inverse.dead_zones.iter_mut().zip(inverse.slopes.iter_mut()).take(self.count) {
            if *dead_zone > T::zero() {
                beyond(&mut right, dead_zone, slope);
            }
        }
        for (dead_zone, slope) in inverse.dead_zones.iter_mut().zip(inverse.slopes.iter_mut()).take(self.count).rev() {
            if *dead_zone < T::zero() {
                beyond(&mut left, dead_zone, slope);
            } else if *dead_zone == T::zero() {
                *slope = T::one() / first;
            }
        }
        inverse
    }

    /// The sum of the magnitudes that [`apply`](Self::apply) adds up, which its rounding is proportional to.
    pub(super) fn magnitude(&self, x: T) -> T {
        let zones = self.dead_zones.iter().zip(&self.slopes).take(self.count);
        zones.fold(T::zero(), |sum, (&dead_zone, &slope)| sum + slope.abs() * (x.abs() + dead_zone.abs()))
    }
}
