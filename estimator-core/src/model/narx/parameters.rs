//! Published parameters of the NARX model, and what makes its linear part stable.

use crate::list::List;
use crate::range::Range;
use crate::rule::Rule;
use serde::{Deserialize, Serialize};

/// Most coefficients that a table has.
pub(super) const COEFFICIENTS: usize = 40;
/// Largest order of output and input.
pub(super) const ORDER: usize = 3;
/// Largest degree of a monomial.
const DEGREE: u8 = 3;

/// Orders, scales and coefficients of the polynomial of Table 5.1; its letters have no unit.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NarxParameters {
    /// r_y: displacements looked back at, 1 to 3.
    pub output_order: u8,
    /// r_u: voltages looked back at, 1 to 3.
    pub input_order: u8,
    /// Degree of the polynomial, 1 to 3.
    pub degree: u8,
    /// Whether V_ext is an input.
    pub with_voltage_extremum: bool,
    /// Whether y_ext is an input.
    pub with_displacement_extremum: bool,
    /// Voltage that counts as 0, V.
    pub voltage_centre_v: f32,
    /// Voltage from there that counts as 1, V; above 0.
    pub voltage_scale_v: f32,
    /// Displacement that counts as 0, µm.
    pub displacement_centre_um: f32,
    /// Displacement from there that counts as 1, µm; above 0.
    pub displacement_scale_um: f32,
    /// Deadband of the reversal tracker, V; at least 0.
    pub deadband_v: f32,
    /// Weights of the monomials, in their order.
    pub coefficients: List<COEFFICIENTS>,
    /// Displacements that a run is clamped to, µm.
    pub limits_um: Range,
}

impl NarxParameters {
    /// How many monomials, and so coefficients, a set of these orders, degree and inputs has.
    pub fn count(&self) -> usize {
        let extrema = usize::from(self.with_voltage_extremum) + usize::from(self.with_displacement_extremum);
        let linear = usize::from(self.output_order) + usize::from(self.input_order) + extrema;
        let letters = 2 + extrema;
        let pairs = letters * (letters + 1) / 2;
        linear
            + if self.degree >= 2 { pairs } else { 0 }
            + if self.degree >= 3 { pairs * (letters + 2) / 3 } else { 0 }
            + 1
    }

    /// Jury's criterion for z^r − a1·z^(r−1) − … − a_r, as a cubic: further roots at 0 change nothing. In f32,
    /// which the target has: a root within some 10⁻⁷ of the circle may be taken for either side, and the clamp
    /// holds all the same.
    fn is_stable(&self) -> bool {
        let mut b = [0.0f32; ORDER];
        for (b, a) in b.iter_mut().zip(self.coefficients.iter().take(self.output_order.into())) {
            *b = -a;
        }
        let [b1, b2, b3] = b;
        1.0 + b1 + b2 + b3 > 0.0 && 1.0 - b1 + b2 - b3 > 0.0 && b3 * b3 < 1.0 && 1.0 - b3 * b3 > (b2 - b1 * b3).abs()
    }

    /// Does what [`Published::check`](crate::Published::check) says.
    pub(super) fn check_numbers(&self) -> Result<(), Rule> {
        let orders = [self.output_order, self.input_order];
        if orders.iter().any(|order| !(1..=ORDER).contains(&usize::from(*order))) {
            return Err("output_order and input_order must be from 1 to 3");
        }
        if !(1..=DEGREE).contains(&self.degree) {
            return Err("degree must be from 1 to 3");
        }
        let limits = self.limits_um;
        let others = [self.voltage_centre_v, self.displacement_centre_um, self.deadband_v, limits.min, limits.max];
        let scales = [self.voltage_scale_v, self.displacement_scale_um];
        if !others.iter().chain(&scales).chain(self.coefficients.iter()).all(|number| number.is_finite()) {
            return Err("every parameter must be finite");
        }
        if scales.iter().any(|scale| *scale < f32::MIN_POSITIVE || !(1.0 / scale).is_finite()) {
            return Err("voltage_scale_v and displacement_scale_um must be above 0");
        }
        if self.deadband_v < 0.0 {
            return Err("deadband_v must be at least 0");
        }
        if limits.min >= limits.max {
            return Err("limits_um must rise");
        }
        if self.coefficients.len() != self.count() {
            return Err("coefficients must be as many as the orders, the degree and the inputs have monomials");
        }
        if !self.is_stable() {
            return Err("the linear part must be stable: the roots of its output polynomial inside the unit circle");
        }
        Ok(())
    }
}
