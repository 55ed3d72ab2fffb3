//! A model together with its memory: what the estimator, the inverse and the identification run, whichever model it is.

use super::recursion::Recursion;
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
    state: Option<S>,
}

impl<M, S> Running<M, S> {
    /// A model that has not begun.
    pub fn new(model: M) -> Self {
        Self { model, state: None }
    }

    /// Forgets everything: the next tick is the first.
    pub fn forget(&mut self) {
        self.state = None;
    }

    /// What the next [`step`](Process::step) would return.
    pub fn peek<T: Real>(&self, voltage: T) -> T
    where
        M: Recursion<T, State = S>,
        S: Clone,
    {
        match &self.state {
            Some(state) => self.model.peek(state, voltage),
            None => self.model.first(voltage, None).1,
        }
    }

    /// As [`Recursion::of_held_voltage`], with nothing remembered.
    #[must_use]
    pub fn of_held_voltage<T: Real>(&self) -> Self
    where
        M: Recursion<T, State = S> + Clone,
    {
        Self::new(self.model.of_held_voltage())
    }

    /// As [`Recursion::monotone_part`], with nothing remembered.
    pub fn monotone_part<T: Real>(&self) -> Option<Self>
    where
        M: Recursion<T, State = S>,
    {
        self.model.monotone_part().map(Self::new)
    }
}

impl<T: Real, M: Recursion<T> + Clone> Process<T> for Running<M, M::State> {
    #[inline]
    fn step(&mut self, voltage: T, known: Option<T>) -> T {
        if let Some(state) = &mut self.state {
            return self.model.step(state, voltage);
        }
        let (state, displacement) = self.model.first(voltage, known);
        self.state = Some(state);
        displacement
    }

    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        self.model.bound(voltage, limits)
    }

    fn set_displacement(&mut self, displacement: T) -> bool {
        self.state.as_mut().is_some_and(|state| self.model.set_displacement(state, displacement))
    }
}
