//! How a model begins where nothing is known: as an actuator rests that was driven before, if a table says how.

use crate::math::Real;
use crate::range::Range;

/// What an actuator that rests stands above where its model by itself begins, in proportion between the lowest
/// voltage and the highest ([`Table::remanence_um`](crate::Table)).
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Remanence {
    /// At an end of a range of voltages, V, and what that is there, µm; `None` where it is 0.
    ends: Option<(Range, [f32; 2])>,
}

impl Remanence {
    /// At the lowest and the highest of the voltages (V), µm.
    pub fn new(voltages: Range, um: [f32; 2]) -> Self {
        Self { ends: (um != [0.0; 2]).then_some((voltages, um)) }
    }

    /// At a voltage (V), µm; `None` where it is 0 everywhere.
    pub fn at<T: Real>(&self, voltage: T) -> Option<T> {
        let (voltages, um) = self.ends?;
        let (voltages, [low, high]): (Range<T>, _) = (voltages.of(), um.map(T::of));
        let part = (voltages.clamp(voltage) - voltages.min) / voltages.span();
        Some(low + part * (high - low))
    }
}
