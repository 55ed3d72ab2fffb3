//! Published parameters of the generalised Prandtl–Ishlinskii model, and the rules that they obey.

use crate::list::List;
use crate::range::Range;
use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// Play operators that a set has at most.
pub const PLAYS: usize = 15;
/// Most knots of a tabulated function.
pub const KNOTS: usize = 9;
/// Most slopes of the envelopes: a function of each play.
pub const SLOPES: usize = PLAYS * KNOTS;
/// First-order creep elements that a set has at most.
pub const CREEPS: usize = 5;
/// Longest delay, ticks.
const LONGEST_DELAY: f32 = 14.0;

/// Parameters of the chain in V, µm, s, Hz and ticks, each as its field says; laws over the voltages as values at
/// knots.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GeneralisedPrandtlIshlinskiiParameters {
    /// Voltages over which the functions are laid out, V.
    pub span_v: Range,
    /// From voltage to actuator, ticks, −1 … 14; a fraction is interpolated. Below 0 the actuator's input is
    /// extrapolated, as far as the tick that the estimate is for.
    pub delay_ticks: f32,
    /// Fastest change behind the amplifier, V/s; 0 for no limit.
    pub slew_v_per_s: f32,
    /// Time constant T of the first-order lag, s; 0 for none.
    pub lag_s: f32,
    /// Natural frequency of the mechanism, Hz; 0 for none, else below half the tick rate.
    pub resonance_hz: f32,
    /// Its damping ζ, between 0 and 1; 0 without a resonance.
    pub damping: f32,
    /// Slope of the reversible part q at knots that lie evenly over the span, at least 0, µm/V; two to nine.
    pub reversible_um_per_v: List<KNOTS>,
    /// Slope of the envelope g of the plays likewise: two to nine of one for all of them, or more, and then as many for
    /// each play, one play after the other.
    pub envelope_um_per_v: List<SLOPES>,
    /// Half-widths r_i of the play operators, increasing, up to half the span, V.
    pub half_widths_v: List<PLAYS>,
    /// Weight a_i of each play, at least 0.
    pub weights: List<PLAYS>,
    /// Time constants of creep, s; 0.001 … 10,000.
    pub creep_times_s: List<CREEPS>,
    /// What each adds in the end to the hysteretic part that drives it, as a part of it, at least 0.
    pub creep_gains: List<CREEPS>,
    /// Memory of an actuator at rest, −2 … 1: 0 as if it had never left that voltage, 1 as if it had come there from
    /// the middle of the span, −1 as if from its lowest voltage, −2 as if it had fallen to that before.
    pub rest_memory: f32,
    /// Displacement at the lower end of the span without memory and creep, µm.
    pub offset_um: f32,
}

impl GeneralisedPrandtlIshlinskiiParameters {
    /// How many envelopes there are: one for all plays, or one for each where there are more slopes than one has.
    fn envelopes(&self) -> usize {
        if self.envelope_um_per_v.len() > KNOTS { self.half_widths_v.len().max(1) } else { 1 }
    }

    /// How many knots an envelope has.
    pub(super) fn knots(&self) -> usize {
        self.envelope_um_per_v.len() / self.envelopes()
    }

    /// Slopes of the envelope of each play, in their order, µm/V.
    pub(super) fn envelope_of_each(&self) -> impl Iterator<Item = &[f32]> {
        self.envelope_um_per_v.chunks(self.knots().max(1)).cycle()
    }

    /// Does what [`Published::check`](crate::Published::check) says.
    pub(super) fn check_numbers(&self) -> Result<(), Rule> {
        let positive = |numbers: &[f32]| numbers.iter().all(|&x| x >= 0.0 && x.is_finite());
        let slopes = |slopes: &List<KNOTS>| slopes.len() >= 2 && positive(slopes);
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
            ("reversible_um_per_v must be two to nine slopes, and not negative", slopes(&self.reversible_um_per_v)),
            (
                "envelope_um_per_v must be two to nine slopes for all plays, or more, and then as many for each, and not negative",
                self.envelope_um_per_v.len().is_multiple_of(self.envelopes())
                    && (2..=KNOTS).contains(&self.knots())
                    && positive(&self.envelope_um_per_v),
            ),
            ("half_widths_v must increase from above 0 to at most half of span_v", {
                let inside = self.half_widths_v.iter().all(|&r| r > 0.0 && 2.0 * r <= self.span_v.span());
                inside && self.half_widths_v.windows(2).all(|pair| matches!(pair, [a, b] if a < b))
            }),
            (
                "weights must be as many as half_widths_v, and not negative",
                self.weights.len() == self.half_widths_v.len() && positive(&self.weights),
            ),
            (
                "creep_times_s must lie between 0.001 and 10000",
                self.creep_times_s.iter().all(|t| (1e-3..=1e4).contains(t)),
            ),
            (
                "creep_gains must be as many as creep_times_s, and not negative",
                self.creep_gains.len() == self.creep_times_s.len() && positive(&self.creep_gains),
            ),
            ("rest_memory must lie between -2 and 1", (-2.0..=1.0).contains(&self.rest_memory)),
            ("offset_um must be a number", self.offset_um.is_finite()),
        ])
    }
}
