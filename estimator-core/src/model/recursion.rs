//! What every model is: a memory that takes a voltage each tick and gives the displacement a tick later.

use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;

/// A model's per-tick coefficients. Its memory is a type of its own; [`Running`](super::Running) joins the two.
pub trait Recursion<T: Real>: Sized {
    /// What it remembers from tick to tick.
    type State: Clone + PartialEq + core::fmt::Debug;

    /// Whether the model remembers how its voltage has gone, how an actuator rests is none of its parameters, and a
    /// memory for a displacement is found in a few steps: a table may then say it
    /// ([`Table::remanence_um`](crate::Table)). The first tick of one that has to search takes four times as long.
    const REMEMBERS: bool = false;

    /// The memory of an actuator that has long rested at this voltage (V). Where its displacement (µm) is known, the
    /// memory is the one that gives it, or comes nearest; where it is not, the one in the middle of all that it may be.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State;

    /// One tick: takes this tick's voltage (V), returns the displacement (µm) a tick later.
    fn step(&self, state: &mut Self::State, voltage: T) -> T;

    /// What the next [`step`](Self::step) would return, for whoever tries many voltages.
    #[inline]
    fn peek(&self, state: &Self::State, voltage: T) -> T {
        self.step(&mut state.clone(), voltage)
    }

    /// The first tick: [`begin`](Self::begin) and [`step`](Self::step) at one voltage, with what both need computed
    /// once where a model can.
    #[inline]
    fn first(&self, voltage: T, displacement: Option<T>) -> (Self::State, T) {
        let mut state = self.begin(voltage, displacement);
        let displacement = self.step(&mut state, voltage);
        (state, displacement)
    }

    /// Displacements (µm) out of which no sequence of voltages of this range (V) leads: what the model's structure can
    /// reach, whatever `limits` are; or, where its memory is the displacement itself, `limits` if they are proven to
    /// hold for every start within them. What a resonance swings beyond `limits`, or a look-ahead extrapolates, is left
    /// to the clamp.
    ///
    /// # Errors
    /// The recursion is unstable or has no bound, or the bound is not within `limits`.
    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>>;

    /// The same model for a voltage that stands for a tick, as a converter gives it, where the model takes that of a
    /// log to run straight from sample to sample: of voltages that it gives itself, what it predicts is not a tick
    /// ahead of them.
    fn of_held_voltage(&self) -> Self
    where
        Self: Clone,
    {
        self.clone()
    }

    /// Of a voltage that stands for a tick, the model without delay and resonance, whose displacement a tick later
    /// rises with this tick's voltage. `None` where the model has no such part. Parameters that bend it until it falls
    /// are found by [`Inverse::build`](crate::Inverse::build).
    fn monotone_part(&self) -> Option<Self>;

    /// Replaces the displacement that the memory holds by a measured one (µm), as one-step prediction (Eq. 4.3) does.
    /// Returns `false`, and changes nothing, where the memory is another: most hysteresis memories do not follow
    /// from a displacement.
    fn set_displacement(&self, _state: &mut Self::State, _displacement: T) -> bool {
        false
    }
}

/// A model whose displacement is a weighted sum, with everything else fixed: what variable projection needs.
pub trait Linear<T: Real>: Recursion<T> {
    /// Goes on by one tick without summing up.
    fn advance(&self, state: &mut Self::State, voltage: T);

    /// Hands over what the weights weigh, in their order, as it is after [`advance`](Self::advance).
    fn columns(&self, state: &Self::State, each: impl FnMut(T));
}

/// Steps of [`solve`]: as many as an f32's mantissa has bits, and a few more for the ends.
const BISECTIONS: usize = 28;
/// Steps of [`solve_in_time`]: to four millionths of where it begins.
const FEW: usize = 18;

/// The lowest argument between `low` and `high` at which a non-decreasing function has at least this value; `high`
/// itself where it has not. Always the same number of steps, so that it takes as long on every tick.
pub fn solve<T: Real>(value: T, low: T, high: T, function: impl Fn(T) -> T) -> T {
    halve(BISECTIONS, value, low, high, function)
}

/// The same to four millionths of the way from `low` to `high`, for a function that takes long.
pub(super) fn solve_in_time<T: Real>(value: T, low: T, high: T, function: impl Fn(T) -> T) -> T {
    halve(FEW, value, low, high, function)
}

fn halve<T: Real>(steps: usize, value: T, mut low: T, mut high: T, function: impl Fn(T) -> T) -> T {
    let half = T::of(0.5);
    for _ in 0..steps {
        let middle = low + (high - low) * half;
        if function(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
