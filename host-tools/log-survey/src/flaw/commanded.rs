//! Short movements of the displacement that the voltage commands: it leaps there, too, as far as the
//! actuator's gain says.

use super::leaps::{EXPLAINED, ROWS, least_leap, spikes};
use super::voltage::without;
use crate::implausible::Implausible;
use crate::noise::noise_of;
use crate::signal::range;

/// A range within this many deviations of the noise is no movement.
const DEVIATIONS: f64 = 10.0;

/// The pulses of a voltage, and what they may move the displacement by.
pub(crate) struct Commanded {
    /// First and last row of each pulse, and how far it goes, V.
    pulses: Vec<(usize, usize, f64)>,
    /// What the rest of the log says that a volt gives, µm; `None` where it stands.
    um_per_v: Option<f64>,
}

impl Commanded {
    /// Of a voltage, V, and the displacement at the same instants, µm, whose range is `stroke`.
    pub fn of(voltage: &[f64], displacement: &[f64], stroke: f64) -> Self {
        if voltage.len() < 2 {
            return Self { pulses: Vec::new(), um_per_v: None };
        }
        let found = spikes(voltage, least_leap(voltage, range(voltage)));
        let between = without(voltage, found.iter().map(|&(first, last, _)| (first, last)));
        let (volts, noise) = (range(&between), |of: &[f64]| DEVIATIONS * noise_of(of).unwrap_or(0.0));
        let moves = volts > noise(&between) && stroke > noise(displacement);
        let pulse = |(first, last, _): (usize, usize, f64)| {
            let leap = voltage[first..=last].iter().map(|v| (v - voltage[first - 1]).abs()).fold(0.0, f64::max);
            (first, last, leap)
        };
        Self { pulses: found.into_iter().map(pulse).collect(), um_per_v: moves.then(|| stroke / volts) }
    }

    /// Whether a displacement that leaps by so many µm from the first of these rows to the last follows a pulse.
    pub fn explains(&self, first: usize, last: usize, leap_um: f64) -> bool {
        // A displacement is late by some rows.
        let begun = self.pulses.partition_point(|pulse| pulse.0 <= last);
        let near = self.pulses[..begun].iter().rev().take_while(|pulse| pulse.1 + ROWS >= first);
        let follows = |leap_v: f64| match self.um_per_v {
            Some(um_per_v) => leap_um <= EXPLAINED * um_per_v * leap_v,
            None => Implausible::of(leap_um, leap_v).is_none(),
        };
        near.map(|pulse| pulse.2).any(follows)
    }
}
