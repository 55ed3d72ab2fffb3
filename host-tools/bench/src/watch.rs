//! What is watched beside a drive, so that no session goes on that records nothing: the sensor. That the amplifier does
//! what it is told is watched by the device itself, which goes to rest where it does not.

use crate::wiring::Wiring;
use protocol::Sample;

/// Saturated samples, less those that are not, that end a session.
const SATURATED: u32 = 200;
/// The voltage has gone over this part of what is to be driven before the sensor must have moved.
const OF_RANGE: f64 = 0.5;
/// What it must have moved by then, of its span.
const OF_SPAN: f64 = 0.002;

/// What is wrong beside the drive.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum Complaint {
    /// The samples have no second channel.
    #[error("the device reads no sensor: its samples have no second channel")]
    NoSensor,
    /// The sensor stands at an end of its span.
    #[error("the sensor's channel stands at an end of its range ({um:.2} µm by its span), at {volts:.1} V")]
    Saturated {
        /// What that end stands for, µm.
        um: f64,
        /// The amplifier's voltage, V.
        volts: f64,
    },
    /// The sensor does not answer the voltage.
    #[error("the sensor has moved by {moved_um:.4} µm only while the voltage went over {over_v:.1} V")]
    Still {
        /// By how much it has moved, µm.
        moved_um: f64,
        /// Over what the voltage went meanwhile, V.
        over_v: f64,
    },
}

/// What has been seen so far.
pub struct Watch<'w> {
    wiring: &'w Wiring,
    /// From the lowest to the highest voltage that is to be driven, V.
    span_v: f64,
    saturated: u32,
    volts: (f64, f64),
    um: (f64, f64),
}

impl<'w> Watch<'w> {
    /// Of a session that begins and is to go over so many V.
    pub fn new(wiring: &'w Wiring, span_v: f64) -> Self {
        let nothing = (f64::INFINITY, f64::NEG_INFINITY);
        Self { wiring, span_v, saturated: 0, volts: nothing, um: nothing }
    }

    /// What is wrong with a sample at a voltage (V), if something is.
    pub fn complaint(&mut self, sample: &Sample, volts: f64) -> Option<Complaint> {
        let sensor = &self.wiring.sensor;
        let Some(um) = sensor.um(sample) else { return Some(Complaint::NoSensor) };
        self.saturated = if sensor.saturated(sample) { self.saturated + 1 } else { self.saturated.saturating_sub(1) };
        if self.saturated >= SATURATED {
            return Some(Complaint::Saturated { um, volts });
        }
        let wider = |(low, high): (f64, f64), x: f64| (low.min(x), high.max(x));
        (self.volts, self.um) = (wider(self.volts, volts), wider(self.um, um));
        let (over_v, moved_um) = (self.volts.1 - self.volts.0, self.um.1 - self.um.0);
        let still = moved_um < OF_SPAN * (sensor.full_um - sensor.zero_um).abs();
        (still && over_v > OF_RANGE * self.span_v).then_some(Complaint::Still { moved_um, over_v })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::FACTS;

    /// What is complained of while the voltage rises by 0.1 V a tick and the sensor's code goes by so many a tick.
    fn complaint(code: impl Fn(u32) -> Option<u16>) -> Option<(u32, Complaint)> {
        let wiring = Wiring::new(&FACTS, 500).unwrap();
        let mut watch = Watch::new(&wiring, 80.0);
        (0..1000).find_map(|tick| {
            let sample = Sample {
                code: 1,
                sensor: code(tick),
                displacement: 0.0,
                half_width: None,
                dac: 0,
                status: Default::default(),
                faults: Default::default(),
            };
            watch.complaint(&sample, 0.1 * f64::from(tick)).map(|complaint| (tick, complaint))
        })
    }

    #[test]
    fn a_sensor_that_answers_is_left_alone_and_one_that_does_not_is_found() {
        assert_eq!(complaint(|tick| Some(11_000 + 30 * tick as u16)), None);
        assert_eq!(complaint(|_| None), Some((0, Complaint::NoSensor)));
        let still = complaint(|tick| Some(11_000 + (tick % 3) as u16));
        assert!(matches!(still, Some((401, Complaint::Still { .. }))), "{still:?}");
        let saturated = complaint(|tick| Some((60_000 + 60 * tick).min(65_520) as u16));
        assert!(matches!(saturated, Some((283, Complaint::Saturated { um, .. })) if um == 25.0), "{saturated:?}");
    }
}
