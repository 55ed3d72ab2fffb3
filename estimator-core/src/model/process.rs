//! A model together with its memory: what the estimator, the inverse and the identification run, whichever model it is.

use super::recursion::Recursion;
use super::remanence::Remanence;
use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;

/// A model that runs. One model is a [`Running`]; any model of a table is an [`Engine`](super::Engine).
pub trait Process<T: Real>: Clone {
    /// One tick: takes this tick's voltage (V), returns the displacement (µm) a tick later. The first tick begins long
    /// at rest at its voltage, with the displacement (µm) that is `known` there.
    fn step(&mut self, voltage: T, known: Option<T>) -> T;

    /// As [`Recursion::bound`].
    ///
    /// # Errors
    /// Those of the method it names.
    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>>;

    /// As [`Recursion::set_displacement`]; `false` before the first tick, too.
    fn set_displacement(&mut self, displacement: T) -> bool;
}

/// A model with its memory, once it has begun.
#[derive(Clone, PartialEq, Debug)]
pub struct Running<M, S> {
    model: M,
    remanence: Remanence,
    state: Option<S>,
}

impl<M, S> Running<M, S> {
    /// A model that has not begun.
    pub fn new(model: M) -> Self {
        Self { model, remanence: Remanence::default(), state: None }
    }

    /// The same, with nothing remembered, of an actuator that rests so where nothing is known.
    #[must_use]
    pub fn resting(self, remanence: Remanence) -> Self {
        Self { remanence, state: None, ..self }
    }

    /// Forgets everything: the next tick is the first.
    pub fn forget(&mut self) {
        self.state = None;
    }

    /// What the next [`step`](Process::step) would return.
    pub fn peek<T: Real>(&self, voltage: T) -> T
    where
        M: Recursion<T, State = S> + Clone,
        S: Clone,
    {
        match &self.state {
            Some(state) => self.model.peek(state, voltage),
            None => self.clone().begin(voltage, None),
        }
    }

    /// The first tick, as [`Recursion::first`]; where no displacement is known, of an actuator that rests as the
    /// remanence says. A function of its own, for the model's begin is large.
    #[inline(never)]
    fn begin<T: Real>(&mut self, voltage: T, mut known: Option<T>) -> T
    where
        M: Recursion<T, State = S>,
    {
        loop {
            let (state, displacement) = self.model.first(voltage, known);
            match self.remanence.at(voltage) {
                Some(off) if M::REMEMBERS && known.is_none() => known = Some(displacement + off),
                _ => {
                    self.state = Some(state);
                    return displacement;
                }
            }
        }
    }

    /// As [`Recursion::of_held_voltage`], with nothing remembered.
    #[must_use]
    pub fn of_held_voltage<T: Real>(&self) -> Self
    where
        M: Recursion<T, State = S> + Clone,
    {
        Self::new(self.model.of_held_voltage()).resting(self.remanence)
    }

    /// As [`Recursion::monotone_part`], with nothing remembered.
    pub fn monotone_part<T: Real>(&self) -> Option<Self>
    where
        M: Recursion<T, State = S>,
    {
        Some(Self::new(self.model.monotone_part()?).resting(self.remanence))
    }
}

impl<T: Real, M: Recursion<T> + Clone> Process<T> for Running<M, M::State> {
    #[inline]
    fn step(&mut self, voltage: T, known: Option<T>) -> T {
        if let Some(state) = &mut self.state {
            return self.model.step(state, voltage);
        }
        self.begin(voltage, known)
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        self.model.bound(voltage, limits)
    }

    fn set_displacement(&mut self, displacement: T) -> bool {
        self.state.as_mut().is_some_and(|state| self.model.set_displacement(state, displacement))
    }
}
