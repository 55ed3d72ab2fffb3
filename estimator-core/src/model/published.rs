//! What the published parameters of every model can do, and how they become ticks.

use super::recursion::Recursion;
use crate::math::Real;
use crate::rule::Rule;
use core::fmt;
use serde::{Deserialize, Serialize};

/// How the differential equation becomes a recursion.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Forward Euler, Eq. (4.7): the displacement goes on by its rate at the tick times t_s; unstable where that is too
    /// large.
    #[default]
    ForwardEuler,
    /// Exact for a voltage held over the tick; stable for any rate.
    ZeroOrderHold,
}

impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::ForwardEuler => "forward Euler",
            Self::ZeroOrderHold => "zero-order hold",
        })
    }
}

/// How a model's equations become ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Discretisation<T> {
    /// t_s, from one tick to the next, s, above 0.
    pub sample_period: T,
    /// How the Voigt family's differential equation becomes a recursion.
    pub scheme: Scheme,
    /// Retreat of the voltage from its running extreme that counts as a reversal, V; Duhem's and Bouc-Wen's memory is
    /// held while the voltage stays within so much either way ([`Held`](super::Held)).
    pub deadband: T,
}

/// The parameters of a model as they are published, in the literature's units.
pub trait Published: Copy {
    /// What a tick computes with: these parameters at one sample period, in the number type `T`.
    type Coefficients<T: Real>: Recursion<T> + Clone + PartialEq + fmt::Debug;

    /// The coefficients for this discretisation. Numbers that [`check`](Self::check) refuses give coefficients that
    /// mean nothing.
    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Self::Coefficients<T>;

    /// The same where the voltage comes from a converter whose codes are `step` volts apart: a deadband among the
    /// parameters is taken [between two numbers of codes](crate::extremum::between_codes).
    #[must_use]
    fn between_codes(self, _step: f32) -> Self {
        self
    }

    /// Checks every parameter by itself and beside the others; whether the recursion is stable and bounded is
    /// [`Recursion::bound`]'s.
    ///
    /// # Errors
    /// The rule that they break.
    fn check(&self) -> Result<(), Rule>;

    /// Ticks by which the displacement comes later than the monotone part of the model has it
    /// ([`Recursion::monotone_part`]), for a voltage that stands for a tick: what whoever knows a reference ahead of
    /// time can make up for.
    fn delay_ticks(&self) -> f32 {
        0.0
    }

    /// Time constant of the first-order lag that the model stands behind, s; 0 of one that has none, below 0 of one
    /// that is [seen ahead](super::LookAhead).
    fn lag_s(&self) -> f32 {
        0.0
    }

    /// The same with another lag, s; a model that has none stays as it is.
    #[must_use]
    fn with_lag(self, _lag_s: f32) -> Self {
        self
    }
}
