//! A device's frames of samples as ticks with a time.

use device_link::sensor::Sensor;
use device_link::streamed::estimate_at;
use device_link::window::{Continuity, Numbers};
use estimator_core::{AdcCalibration, AdcCode};
use protocol::{Sample, Samples};

/// What was measured and estimated of one instant.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Tick {
    /// Which, counted from the feed's first.
    pub number: u64,
    /// Ticks from one that is streamed to the next.
    pub every: u8,
    /// Since the feed's first tick, s.
    pub seconds: f64,
    /// Whether the tick before it is missing.
    pub after_gap: bool,
    /// The amplifier's voltage, V.
    pub voltage_v: f32,
    /// The estimated displacement, µm.
    pub displacement_um: f32,
    /// Half-width of the estimate's 95 % interval, µm, where it has one.
    pub half_width_um: Option<f32>,
    /// What the sensor showed, µm, where there is one.
    pub sensor_um: Option<f32>,
}

/// Makes ticks of frames. As in a recording, a sample's displacement is that of the next tick, beside whose voltage it
/// belongs; so the first tick of all, and the first after a gap, are none.
#[derive(Clone, Debug)]
pub struct Feed {
    calibration: AdcCalibration,
    sensor: Option<Sensor>,
    tick_us: u32,
    numbers: Numbers,
    /// Number of the next tick.
    next: u64,
    /// The last sample, whose displacement and half-width are those of the tick after it.
    before: Option<Sample>,
    after_gap: bool,
}

impl Feed {
    /// A feed of a device with this calibration of its ADC, this sensor, and a tick of `tick_us` µs.
    pub fn new(calibration: AdcCalibration, sensor: Option<Sensor>, tick_us: u32) -> Self {
        Self { calibration, sensor, tick_us, numbers: Numbers::default(), next: 0, before: None, after_gap: true }
    }

    /// Hands the ticks of the next frame on, one after the other. Where samples were lost, numbers and times leap;
    /// where the device counts from 0 again, they go on.
    pub fn take(&mut self, samples: &Samples, mut each: impl FnMut(&Tick)) {
        match self.numbers.take(samples) {
            Continuity::Contiguous => {}
            Continuity::Gap(ticks) => {
                self.next += u64::from(ticks);
                self.before = None;
            }
            Continuity::Restarted => self.before = None,
        }
        for sample in &samples.samples {
            let number = self.next;
            self.next += u64::from(samples.every.get());
            let Some(before) = self.before.replace(*sample) else {
                self.after_gap = true;
                continue;
            };
            each(&Tick {
                number,
                every: samples.every.get(),
                // Whole µs over 10⁶ is the double nearest to the true time, and so prints short.
                seconds: (number * u64::from(self.tick_us)) as f64 / 1e6,
                after_gap: std::mem::take(&mut self.after_gap),
                voltage_v: self.calibration.voltage(AdcCode(sample.code)),
                displacement_um: estimate_at(&before, sample, samples.every),
                half_width_um: before.half_width,
                sensor_um: self.sensor.and_then(|sensor| sensor.um(sample)).map(|um| um as f32),
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroU8;

    const CALIBRATION: AdcCalibration =
        AdcCalibration { gain_v_per_code: 0.01, offset_v: -2.0, invert: false, full_scale: 4095 };

    fn frame(first: u32, displacements: &[f32]) -> Samples {
        let sample = |&displacement| Sample {
            code: 300,
            sensor: Some(4095),
            displacement,
            half_width: Some(0.5),
            dac: 7,
            status: Default::default(),
            faults: Default::default(),
        };
        Samples { first, every: NonZeroU8::MIN, samples: displacements.iter().map(sample).collect() }
    }

    fn taken(feed: &mut Feed, frame: &Samples) -> Vec<Tick> {
        let mut ticks = Vec::new();
        feed.take(frame, |tick| ticks.push(*tick));
        ticks
    }

    #[test]
    fn a_displacement_stands_beside_the_voltage_of_its_own_tick() {
        let sensor = Sensor { zero_um: 0.0, full_um: 20.0, full_scale: 4095 };
        let mut feed = Feed::new(CALIBRATION, Some(sensor), 500);
        let ticks = taken(&mut feed, &frame(10, &[1.0, 2.0, 3.0]));
        let found: Vec<_> = ticks.iter().map(|tick| (tick.seconds, tick.displacement_um, tick.after_gap)).collect();
        assert_eq!(found, [(0.0005, 1.0, true), (0.001, 2.0, false)]);
        assert_eq!((ticks[0].voltage_v, ticks[0].half_width_um, ticks[0].sensor_um), (1.0, Some(0.5), Some(20.0)));
    }

    #[test]
    fn time_leaps_over_a_gap_and_goes_on_after_a_restart() {
        let mut feed = Feed::new(CALIBRATION, None, 500);
        taken(&mut feed, &frame(10, &[1.0, 2.0]));
        let after = taken(&mut feed, &frame(20, &[3.0, 4.0]));
        assert_eq!(after.iter().map(|tick| (tick.number, tick.after_gap)).collect::<Vec<_>>(), [(11, true)]);
        let anew = taken(&mut feed, &frame(0, &[5.0, 6.0, 7.0]));
        assert_eq!(anew.iter().map(|tick| tick.number).collect::<Vec<_>>(), [13, 14]);
        assert_eq!((anew[0].after_gap, anew[0].sensor_um), (true, None));
    }

    #[test]
    fn of_every_fourth_tick_time_counts_all_and_the_estimate_is_of_the_voltage_s() {
        let mut feed = Feed::new(CALIBRATION, None, 100);
        let every = NonZeroU8::new(4).unwrap();
        // A µm a tick; each says what is a tick later.
        let ticks = taken(&mut feed, &Samples { every, ..frame(8, &[9.0, 13.0, 17.0]) });
        let found: Vec<_> = ticks.iter().map(|tick| (tick.seconds, tick.displacement_um)).collect();
        assert_eq!(found, [(0.0004, 12.0), (0.0008, 16.0)]);
    }
}
