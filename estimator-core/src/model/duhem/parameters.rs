//! Published parameters of the Duhem model, and the rules that they obey.

use super::super::lagged;
use super::conditions::{DuhemCondition, unmet_condition};
use crate::rule::Rule;
use serde::{Deserialize, Serialize};

/// Parameters of Eq. (3.12), with the polynomials f and g about a centre.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DuhemParameters {
    /// Time constant of the input lag, s; 0 is none. Below 0 the time by which the displacement is ahead of a tick
    /// after its voltage: at most a tick of it counts.
    pub lag_s: f32,
    /// α of Eq. (3.12), 1/V, above 0: the memory of a reversal falls to 1/e over 1/α volts.
    pub alpha_per_v: f32,
    /// Distance from the centre beyond which f' = g, V; above 0, best beyond all voltages that occur.
    pub saturation_v: f32,
    /// Where f is odd and g even about, V.
    pub voltage_centre_v: f32,
    /// Displacement without hysteresis at the centre, µm.
    pub offset_um: f32,
    /// f1, µm/V, at least 0: slope of f at the centre.
    pub f1_um_per_v: f32,
    /// f3, µm/V³, signed: f is f1·v + f3·v³ up to saturation, where it must not fall.
    pub f3_um_per_v3: f32,
    /// g0, µm/V: g at the centre, below f1 where the displacement lags.
    pub g0_um_per_v: f32,
    /// g2, µm/V³, signed: g is g0 + g2·v² up to saturation.
    pub g2_um_per_v3: f32,
}

impl DuhemParameters {
    /// The first of the conditions of Section 3.3 that the set does not meet.
    pub fn unmet_condition(&self) -> Option<DuhemCondition> {
        let limit = self.slope(self.saturation_v);
        let within = |v: f32| v.abs() < self.saturation_v;
        unmet_condition(
            self.alpha_per_v,
            self.saturation_v,
            |v| if within(v) { self.slope(v) } else { limit },
            |v| if within(v) { self.g0_um_per_v + self.g2_um_per_v3 * v * v } else { limit },
        )
    }

    /// f' within saturation, µm/V.
    fn slope(&self, v: f32) -> f32 {
        self.f1_um_per_v + 3.0 * self.f3_um_per_v3 * v * v
    }

    /// [`Published::check`](crate::Published::check), but for the bound, which the coefficients say.
    pub(super) fn check_numbers(&self) -> Result<(), Rule> {
        let weights = [self.f1_um_per_v, self.f3_um_per_v3, self.g0_um_per_v, self.g2_um_per_v3, self.offset_um];
        lagged::check(self.lag_s)?;
        let others = [self.alpha_per_v, self.saturation_v, self.voltage_centre_v];
        if !weights.iter().chain(&others).all(|number| number.is_finite()) {
            return Err("every parameter must be finite");
        }
        if self.alpha_per_v <= 0.0 || self.saturation_v <= 0.0 {
            return Err("alpha_per_v and saturation_v must be above 0");
        }
        if self.alpha_per_v * self.saturation_v > 1e4 {
            return Err("alpha_per_v times saturation_v must be at most 10000");
        }
        if self.f1_um_per_v < 0.0 || self.slope(self.saturation_v) < 0.0 {
            return Err("f must not fall: f1 and f1 + 3 f3 saturation^2 must be at least 0");
        }
        Ok(())
    }
}
