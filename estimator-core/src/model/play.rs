//! The play (backlash) operator, Eq. (3.7) and (3.8) (thesis 3.1.2), and its complement, the stop.
//!
//! ```text
//! play(i) = max(x − r, min(x + r, play(i−1)))
//! stop(i) = x − play(i)                          within ±r
//! ```
//!
//! Input, half-width and output have one unit: V in the Prandtl-Ishlinskii model, µm in the Maxwell-slip model, where
//! the play is the position of an element's block and the stop the stretch of its spring.

use crate::math::Real;

/// One tick of the play operator: what `memory` becomes at this input. A NaN input leaves it as it is.
#[inline]
pub fn play<T: Real>(memory: T, input: T, half_width: T) -> T {
    let (low, high) = (input - half_width, input + half_width);
    if memory < low {
        low
    } else if memory > high {
        high
    } else {
        memory
    }
}

/// An elasto-slide element of unit stiffness, Eq. (3.10): what its spring is stretched by.
///
/// With the yield displacements fixed, the voltage of the Maxwell-slip model is a weighted sum of such elements'
/// stretches, of the displacement and of 1; the weights are the stiffnesses. It is what they are identified with.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Stop<T> {
    yield_um: T,
    block_um: T,
}

impl<T: Real> Stop<T> {
    /// An element that yields at this stretch (µm, `W/k`), with its block at this position (µm).
    pub fn new(yield_um: T, block_um: T) -> Self {
        Self { yield_um, block_um }
    }

    /// Takes this tick's displacement (µm); returns the stretch `y − y_b` (µm), within ±`yield_um`.
    #[inline]
    pub fn step(&mut self, displacement: T) -> T {
        self.block_um = play(self.block_um, displacement, self.yield_um);
        displacement - self.block_um
    }

    /// Where the block stands, µm.
    pub fn block(&self) -> T {
        self.block_um
    }
}
