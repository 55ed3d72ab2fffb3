//! The memory of a rate-independent equation, held while its input stays within a deadband.
//!
//! ```text
//! p ← play(p, u; ¾·δ)                                   δ the table's deadband, in the input's unit
//! shown: the equation's answer, from the memory where it stands, to a monotone move to u
//! where p has moved, what is shown becomes the memory, and stands at u
//! ```
//!
//! Duhem's and Bouc-Wen's equations advance with |du|. The noise of a converter is a path without end: at rest it would
//! make them forget all that there is to remember. A play does not move while the input stays within ±¾·δ of it, and
//! then nothing is kept: the displacement follows the input to and fro on one curve. A retreat of more than 1.5·δ moves
//! it. With δ midway between two numbers of codes ([`between_codes`](crate::extremum::between_codes)) that is no whole
//! number of them, by a quarter at least, so that no rounding decides what a code is.
//!
//! The memory does not take the play's way but the input's, so that no loop is shifted, nor cut short: of an input
//! whose reversals are more than 1.5·δ apart the answer is the equation's own. What is shown is continuous, for what
//! becomes the memory has been shown before.

use super::play::play;
use crate::math::Real;

/// The half-width of the play that decides when a memory moves, by a table's deadband; both in the unit of the input.
pub fn half_width<T: Real>(deadband: T) -> T {
    T::of(0.75) * deadband
}

/// A memory, and where it stands.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Held<T, M> {
    play: T,
    at: T,
    memory: M,
}

impl<T: Real, M: Copy> Held<T, M> {
    /// A memory of an input that has long stood at this value.
    pub fn new(at: T, memory: M) -> Self {
        Self { play: at, at, memory }
    }

    /// One tick: takes the input, returns the memory as it is shown there. `follow` is the equation's answer, from a
    /// memory, to a monotone move from one input to another; `half_width` is ¾·δ.
    #[inline]
    pub fn step(&mut self, input: T, half_width: T, follow: impl FnOnce(M, T, T) -> M) -> M {
        let shown = self.shown(input, follow);
        let moved = play(self.play, input, half_width);
        if moved != self.play {
            *self = Self { play: moved, at: input, memory: shown };
        }
        shown
    }

    /// What a [`step`](Self::step) would return.
    #[inline]
    pub fn shown(&self, input: T, follow: impl FnOnce(M, T, T) -> M) -> M {
        follow(self.memory, self.at, input)
    }
}
