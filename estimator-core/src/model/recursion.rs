//! What every model is: a memory that takes a voltage each tick and gives the displacement a tick later.

use crate::math::Real;
use crate::range::Range;

/// A model's per-tick coefficients.
pub trait Recursion<T: Real>: Sized {
    /// What it remembers from tick to tick.
    type State: Clone + PartialEq + core::fmt::Debug;

    /// The memory of an actuator that has long rested at this voltage (V). Where its displacement (µm) is known, the
    /// memory is the one that gives it, or comes nearest; where it is not, the one in the middle of all that it may be.
    fn begin(&self, voltage: T, displacement: Option<T>) -> Self::State;

    /// One tick: takes this tick's voltage (V), returns the displacement (µm) a tick later.
    fn step(&self, state: &mut Self::State, voltage: T) -> T;

    /// The displacements (µm) that some sequence of voltages of this range (V) can reach; `None` where the recursion is
    /// unstable or has no bound.
    fn reach(&self, voltage: Range<T>) -> Option<Range<T>>;

    /// The model without what no inverse can undo within a tick (a delay, a resonance): its displacement a tick later rises
    /// with this tick's voltage, but for a jump at a reversal. `None` where it need not; that parameters which bend it make it
    /// fall is the inverse's to find out.
    fn prompt(&self) -> Option<Self>;
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

/// The lowest argument between `low` and `high` at which a non-decreasing function has at least this value; `high` itself where
/// it has not. Always the same number of steps, so that it takes as long on every tick.
pub fn solve<T: Real>(value: T, mut low: T, mut high: T, function: impl Fn(T) -> T) -> T {
    let half = T::of(0.5);
    for _ in 0..BISECTIONS {
        let middle = low + (high - low) * half;
        if function(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}
