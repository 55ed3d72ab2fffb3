//! A table at another tick than the one it was made for, where that changes nothing but how finely time is cut.
//!
//! | model | |
//! |---|---|
//! | the Voigt family | a differential equation: its parameters say nothing of a tick |
//! | the generalised Prandtl-Ishlinskii operator | times are in s and Hz, but for its delay, which is kept as a time: the estimate of a tick comes [`delay_ticks`](crate::GeneralisedPrandtlIshlinskiiParameters::delay_ticks) + 1 ticks after its voltage |
//! | all others | bound to their tick: what a voltage does at once they show at the next tick, and the fit has made that time part of what it found |
//!
//! A voltage is taken to be held, or to run straight, within a tick: at another the estimate is another by what
//! it does there.

use super::Table;
use crate::interval::IntervalParameters;
use crate::model::{Model, Parameters};

/// A table's model is bound to the tick that it was identified at.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error(
    "the model {} is bound to the tick that it was identified at, {tick_us} µs: how late it answers is part of what was found",
    .model.name()
)]
pub struct BoundToTick {
    /// The model that is bound to its tick.
    pub model: Model,
    /// Tick that the table was identified at, µs.
    pub tick_us: u32,
}

impl Table {
    /// The table at a tick of so many µs; as it is where that is its own. It has to be admitted anew.
    ///
    /// # Errors
    /// Its model is bound to its tick.
    pub const fn at_tick(self, tick_us: u32) -> Result<Self, BoundToTick> {
        if tick_us == self.sample_period_us || tick_us == 0 {
            return Ok(self);
        }
        let ratio = self.sample_period_us as f32 / tick_us as f32;
        let parameters = match self.parameters {
            Parameters::GeneralisedPrandtlIshlinskii(mut of) => {
                of.delay_ticks = (of.delay_ticks + 1.0) * ratio - 1.0;
                Parameters::GeneralisedPrandtlIshlinskii(of)
            }
            voigt if voigt.model().is_voigt() => voigt,
            other => return Err(BoundToTick { model: other.model(), tick_us: self.sample_period_us }),
        };
        let interval = match self.interval {
            Some(of) => Some(IntervalParameters { rate_ticks: of.rate_ticks * ratio, ..of }),
            None => None,
        };
        Ok(Self { sample_period_us: tick_us, parameters, interval, ..self })
    }
}
