//! Published parameters of the generalised Prandtl–Ishlinskii model, and the rules that they obey.

use super::GeneralisedPrandtlIshlinskii;
use crate::list::List;
use crate::math::Real;
use crate::model::{Discretisation, Published};
use crate::range::Range;
use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// Most play operators.
pub const PLAYS: usize = 10;
/// Most weights: those of the plays' functions.
pub const WEIGHTS: usize = 30;
/// Most creep elements.
pub const CREEPS: usize = 4;
/// Longest delay, ticks.
const LONGEST_DELAY: f32 = 14.0;

/// Published parameters.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeneralisedPrandtlIshlinskiiParameters {
    /// Voltages over which the functions of the plays are laid out, V.
    pub span_v: Range,
    /// From voltage to actuator, ticks, −1 … 14; a fraction is interpolated. Below 0 the actuator's input is extrapolated, as
    /// far as the tick that the estimate is for.
    pub delay_ticks: f32,
    /// Fastest change behind the amplifier, V/s; 0 for no limit.
    pub slew_v_per_s: f32,
    /// Time constant of the first-order lag, s; 0 for none.
    pub lag_s: f32,
    /// Half-widths of the play operators, increasing from 0, V.
    pub half_widths_v: List<PLAYS>,
    /// Natural frequency of the mechanism, Hz; 0 for none, else below half the tick rate.
    pub resonance_hz: f32,
    /// Its damping ζ, between 0 and 1; 0 without a resonance.
    pub damping: f32,
    /// Weights of each play's functions (as many a play, 1 to 3), at least 0: what each adds from one end of the play's travel
    /// to the other, µm.
    pub weights_um: List<WEIGHTS>,
    /// Time constants of creep, s; 0.001 … 10,000.
    pub creep_times_s: List<CREEPS>,
    /// Creep, at least 0, µm/V.
    pub creep_um_per_v: List<CREEPS>,
    /// κ of y = w + κ·w², 1/µm.
    pub curvature_per_um: f32,
    /// What is added to the sum w, µm.
    pub offset_um: f32,
}

impl Published for GeneralisedPrandtlIshlinskiiParameters {
    type Coefficients<T: Real> = GeneralisedPrandtlIshlinskii<T>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> GeneralisedPrandtlIshlinskii<T> {
        GeneralisedPrandtlIshlinskii::build(self, discretisation.sample_period)
    }

    fn delay_ticks(&self) -> f32 {
        self.delay_ticks.max(0.0)
    }

    fn check(&self) -> Result<(), Rule> {
        let count = self.half_widths_v.len();
        let all = |numbers: &[f32], rule: fn(f32) -> bool| numbers.iter().all(|&x| x.is_finite() && rule(x));
        rule::check([
            (
                "span_v must be ordered",
                self.span_v.min.is_finite() && self.span_v.max.is_finite() && self.span_v.min < self.span_v.max,
            ),
            ("delay_ticks must lie between -1 and 14", (-1.0..=LONGEST_DELAY).contains(&self.delay_ticks)),
            ("slew_v_per_s must be 0 or positive", self.slew_v_per_s >= 0.0 && self.slew_v_per_s.is_finite()),
            ("lag_s must lie between 0 and 10", (0.0..=10.0).contains(&self.lag_s)),
            ("resonance_hz must be 0, or damping must lie between 0 and 1", {
                let some = self.resonance_hz > 0.0
                    && self.resonance_hz.is_finite()
                    && self.damping > 0.0
                    && self.damping < 1.0;
                some || (self.resonance_hz == 0.0 && self.damping == 0.0)
            }),
            ("half_widths_v must begin with 0", self.half_widths_v.first() == Some(&0.0)),
            ("half_widths_v must increase, and stay below half of span_v", {
                let below = self.half_widths_v.iter().all(|&r| 2.0 * r < self.span_v.span());
                below && self.half_widths_v.windows(2).all(|pair| matches!(pair, [a, b] if a < b))
            }),
            ("weights_um must be one, two or three for each half-width, and not negative", {
                let degree = self.weights_um.len().checked_div(count).unwrap_or(0);
                (1..=3).contains(&degree)
                    && degree * count == self.weights_um.len()
                    && all(&self.weights_um, |w| w >= 0.0)
            }),
            ("creep_times_s must lie between 0.001 and 10000", all(&self.creep_times_s, |t| (1e-3..=1e4).contains(&t))),
            ("creep_um_per_v must be as many as creep_times_s, and not negative", {
                self.creep_um_per_v.len() == self.creep_times_s.len() && all(&self.creep_um_per_v, |c| c >= 0.0)
            }),
            ("curvature_per_um and offset_um must be numbers", all(&[self.curvature_per_um, self.offset_um], |_| true)),
        ])
    }
}
