//! What a table says of its interval, and its rules.

use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// Plays that tell where the voltage has been.
pub const PLAYS: usize = 6;
/// Spans at which the memory of the start is given: eighths of the table's voltage range, from 0 to all of it.
pub const SPANS: usize = 9;
/// Prototypes of where the training's plays stood.
pub const PROTOTYPES: usize = 24;
/// None of a table's numbers may be larger: their squares are then numbers of an `f32`, too, whatever the voltage does.
pub const LARGEST: f32 = 1e6;
/// Numbers of a lower triangle of as many rows as there are plays.
pub const TRIANGLE: usize = PLAYS * (PLAYS + 1) / 2;

/// What a table says of its interval.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct IntervalParameters {
    /// m, µm: what the memory of a start in the middle of the range may still be off by once the voltage has swept so
    /// many eighths of it.
    pub memory_um: [f32; SPANS],
    /// e, 0 … 1: what of m a start at an end of the range leaves open.
    pub memory_at_ends: f32,
    /// Half-width where nothing else counts, µm.
    pub misfit_um: f32,
    /// Ticks of the estimate's fastest change that the half-width has.
    pub rate_ticks: f32,
    /// L, µm for plays in half voltage ranges, row by row of its lower triangle.
    pub spread_um: [f32; TRIANGLE],
    /// c_k: Lᵀp of the training, in units of `prototype_um`.
    pub prototypes: [[i8; PLAYS]; PROTOTYPES],
    /// The unit of the prototypes, µm.
    pub prototype_um: f32,
    /// n beyond which [`Status::UNTRAINED`](crate::Status::UNTRAINED) is raised, µm.
    pub untrained_um: f32,
    /// Half-width for each µm that the estimate has gone since the displacement was told.
    pub gain: f32,
    /// Half-width for each decade of time since the start, µm.
    pub drift_um: f32,
    /// Least time from the start to where a displacement may be told, s: earlier, an actuator that moves is still
    /// on its way.
    pub earliest_s: f32,
}

impl IntervalParameters {
    /// The same half-width (µm) whatever the voltage does, and however long ago the displacement was told.
    #[must_use]
    pub const fn constant(misfit_um: f32) -> Self {
        Self {
            memory_um: [0.0; SPANS],
            memory_at_ends: 0.0,
            misfit_um,
            rate_ticks: 0.0,
            spread_um: [0.0; TRIANGLE],
            prototypes: [[0; PLAYS]; PROTOTYPES],
            prototype_um: 0.0,
            untrained_um: 0.0,
            gain: 0.0,
            drift_um: 0.0,
            earliest_s: 0.0,
        }
    }

    /// Whether every number is finite, none is negative that may not be, and none is beyond [`LARGEST`].
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn check(&self) -> Result<(), Rule> {
        let positive = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite() && *number >= 0.0);
        let finite = |numbers: &[f32]| numbers.iter().all(|number| number.is_finite());
        let small = |numbers: &[f32]| numbers.iter().all(|number| number.abs() <= LARGEST);
        let Self { misfit_um, rate_ticks, prototype_um, untrained_um, gain, drift_um, earliest_s, .. } = *self;
        rule::check([
            ("interval.memory_um must be 0 or positive", positive(&self.memory_um)),
            ("interval.memory_at_ends must lie between 0 and 1", (0.0..=1.0).contains(&self.memory_at_ends)),
            ("interval.misfit_um must be positive", positive(&[self.misfit_um]) && self.misfit_um > 0.0),
            ("interval.rate_ticks must be 0 or positive", positive(&[self.rate_ticks])),
            ("interval.spread_um must be finite", finite(&self.spread_um)),
            ("interval.prototype_um must be 0 or positive", positive(&[self.prototype_um])),
            ("interval.untrained_um must be 0 or positive", positive(&[self.untrained_um])),
            ("interval.gain must be 0 or positive", positive(&[self.gain])),
            ("interval.drift_um must be 0 or positive", positive(&[self.drift_um])),
            ("interval.earliest_s must be 0 or positive", positive(&[self.earliest_s])),
            ("interval: no number may lie beyond a million", {
                small(&self.memory_um)
                    && small(&self.spread_um)
                    && small(&[misfit_um, rate_ticks, prototype_um, untrained_um, gain, drift_um, earliest_s])
            }),
        ])
    }
}
