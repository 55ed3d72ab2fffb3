//! Extremum tracker: the voltage and displacement at the last direction reversal, `V_ext` and `y_ext` of Eq. (5.3).
//!
//! The direction changes when the voltage has retreated from its running extreme by more than a deadband δ. What is
//! recorded then is the pair at the running extreme (the last tick at which the voltage stood there), not the pair at
//! the tick of detection. A constant voltage is no reversal, neither is the first movement away from the start; before
//! the first reversal both values are 0.
//!
//! A voltage that comes from a converter retreats by whole codes. A deadband of a whole number of codes would leave it
//! to the rounding whether a retreat of just so many counts, and so a table's is taken [between two](between_codes).

use crate::math::Real;
use num_traits::float::FloatCore;

/// The deadband (V) that stands midway between two numbers of codes and counts the same retreats of whole codes as
/// reversals: `(⌊deadband/step⌋ + ½)·step`, with `step` the volts of a code. An `f32` in every number type, as both of
/// them are in a table.
pub fn between_codes(deadband: f32, step: f32) -> f32 {
    (FloatCore::floor(deadband / step) + 0.5) * step
}

/// Voltage (V) and displacement (µm) at a direction reversal.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extremum<T> {
    /// `V_ext` of Eq. (5.3), V relative to the model's zero; normalised and without unit in NARX.
    pub voltage: T,
    /// `y_ext` of Eq. (5.3), µm relative to the model's zero; normalised and without unit in NARX.
    pub displacement: T,
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Direction<T> {
    /// Nothing was seen that says which way it goes.
    Start,
    /// Moved by no more than the deadband so far: lowest and highest pair.
    Unknown {
        low: Extremum<T>,
        high: Extremum<T>,
    },
    Rising {
        high: Extremum<T>,
    },
    Falling {
        low: Extremum<T>,
    },
}

/// Finds direction reversals of the voltage, a tick at a time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tracker<T> {
    deadband: T,
    direction: Direction<T>,
    last: Extremum<T>,
}

impl<T: Real> Tracker<T> {
    /// `deadband` in V: at least the noise of the voltage reading; 0 for clean logs.
    pub fn new(deadband: T) -> Self {
        Self { deadband, direction: Direction::Start, last: Extremum { voltage: T::zero(), displacement: T::zero() } }
    }

    /// Takes the voltage (V) and displacement (µm) of this tick. `true` when this tick revealed a reversal, so that
    /// [`last`](Self::last) has changed.
    #[inline]
    pub fn update(&mut self, voltage: T, displacement: T) -> bool {
        let now = Extremum { voltage, displacement };
        let reversal = match &mut self.direction {
            Direction::Start => {
                self.direction = Direction::Unknown { low: now, high: now };
                return false;
            }
            Direction::Unknown { low, high } => {
                if voltage <= low.voltage {
                    *low = now;
                }
                if voltage >= high.voltage {
                    *high = now;
                }
                if voltage > low.voltage + self.deadband {
                    self.direction = Direction::Rising { high: now };
                } else if voltage < high.voltage - self.deadband {
                    self.direction = Direction::Falling { low: now };
                }
                return false;
            }
            Direction::Rising { high } => {
                if voltage >= high.voltage {
                    *high = now;
                    return false;
                }
                if voltage >= high.voltage - self.deadband {
                    return false;
                }
                let reversal = *high;
                self.direction = Direction::Falling { low: now };
                reversal
            }
            Direction::Falling { low } => {
                if voltage <= low.voltage {
                    *low = now;
                    return false;
                }
                if voltage <= low.voltage + self.deadband {
                    return false;
                }
                let reversal = *low;
                self.direction = Direction::Rising { high: now };
                reversal
            }
        };
        self.last = reversal;
        true
    }

    /// The last reversal; zeros before the first.
    pub fn last(&self) -> Extremum<T> {
        self.last
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The reversals (voltage, index of its displacement) found in a voltage sequence whose displacement is its index.
    fn reversals(deadband: f64, voltages: &[f64]) -> impl Iterator<Item = (f64, f64)> {
        let mut tracker = Tracker::new(deadband);
        voltages.iter().enumerate().flat_map(move |(i, &v)| {
            let reversal = tracker.update(v, i as f64).then(|| tracker.last());
            reversal.map(|at| (at.voltage, at.displacement))
        })
    }

    #[test]
    fn a_deadband_between_codes_counts_the_same_retreats_at_every_voltage() {
        let step = 44.0 / 4095.0f32;
        assert_eq!([0.0, 0.9, 1.0, 3.1].map(|codes| between_codes(codes * step, step) / step), [0.5, 0.5, 1.5, 3.5]);
        // A retreat of three codes from every code, by what an f32 makes of it.
        let volts = |code: u16| -22.0f32 + step * f32::from(code);
        let seen = |deadband: f32| {
            let is_seen = |&top: &u16| {
                let mut tracker = Tracker::new(deadband);
                [top - 9, top, top - 3].map(|code| tracker.update(volts(code), 0.0)).contains(&true)
            };
            (9..4095).filter(is_seen).count()
        };
        assert_eq!(seen(between_codes(3.0 * step, step)), 0);
        assert_eq!(seen(between_codes(2.0 * step, step)), 4095 - 9);
        // As it is written, the rounding decides.
        assert!((1..4095 - 9).contains(&seen(3.0 * step)));
    }

    #[test]
    fn records_the_extreme_not_the_tick_of_detection() {
        let found = reversals(0.5, &[0.0, 1.0, 2.0, 3.0, 2.8, 2.6, 2.4, 1.0, 0.0, 0.4, 0.6]);
        assert!(found.eq([(3.0, 3.0), (0.0, 8.0)]));
    }

    #[test]
    fn first_movement_is_no_reversal() {
        assert_eq!(reversals(0.0, &[0.0, 1.0, 2.0]).count(), 0);
        assert_eq!(reversals(0.0, &[0.0, -1.0, -2.0]).count(), 0);
        assert_eq!(reversals(1.0, &[0.0, 0.9, -0.9, -2.0]).count(), 0);
    }

    #[test]
    fn a_hold_is_no_reversal_and_its_last_displacement_counts() {
        assert_eq!(reversals(0.0, &[0.0, 1.0, 1.0, 1.0, 2.0]).count(), 0);
        assert!(reversals(0.0, &[0.0, 1.0, 1.0, 1.0, 0.5]).eq([(1.0, 3.0)]));
    }

    #[test]
    fn nothing_before_the_first_reversal() {
        let tracker = Tracker::new(0.0f32);
        assert_eq!(tracker.last(), Extremum { voltage: 0.0, displacement: 0.0 });
    }

    proptest! {
        /// Noise below half the deadband on a monotone ramp never makes a reversal.
        #[test]
        fn noise_within_the_deadband_is_not_seen(noise in prop::collection::vec(-0.49f64..0.49, 2..200)) {
            let ramp: Vec<f64> = noise.iter().enumerate().map(|(i, n)| 0.01 * i as f64 + n).collect();
            prop_assert_eq!(reversals(1.0, &ramp).count(), 0);
        }

        /// With no deadband, the reversals are exactly the strict local extrema of the sequence with its holds removed.
        #[test]
        fn without_deadband_every_turning_point_is_found(steps in prop::collection::vec(-3i8..=3, 2..200)) {
            let mut voltage = 0.0;
            let voltages: Vec<f64> = steps.iter().map(|&s| { voltage += f64::from(s); voltage }).collect();
            let mut distinct = voltages.clone();
            distinct.dedup();
            let expected = distinct.windows(3).filter(|w| (w[1] - w[0]) * (w[2] - w[1]) < 0.0).map(|w| w[1]);
            prop_assert!(reversals(0.0, &voltages).map(|(v, _)| v).eq(expected));
        }
    }
}
