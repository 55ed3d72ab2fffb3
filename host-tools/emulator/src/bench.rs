//! A bench behind an emulated device's converters: amplifier, actuator and displacement sensor.
//!
//! ```text
//! DAC code ─► command V ─► slew, lag ─► voltage V ─► ADC code, with noise             the amplifier's monitor
//!                                          └─► hysteresis, creep ─► µm ─► ADC code, with noise    the sensor
//! ```
//!
//! The actuator is one of [`plants`], at rest and virgin where the amplifier rests. It counts from there: its full voltage is the
//! end of the drive's range that is farther away.

use crate::plant::Plant;
use estimator_core::{AdcCalibration, AdcCode, DacCode, DriveCalibration, Range};
use firmware::Conversion;
use firmware::rate::TICK_US;
use plants::{Running, STEP_S};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Steps of the actuator in a tick.
const STEPS: u32 = (TICK_US as f64 * 1e-6 / STEP_S + 0.5) as u32;

/// What a bench is made of.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bench {
    /// The actuator and the amplifier's lag.
    pub actuator: plants::Plant,
    /// Displacement from the rest to the end of the drive's range that is farther away, first time and without creep, µm.
    pub stroke_um: f64,
    /// What the monitor's codes stand for.
    pub monitor: AdcCalibration,
    /// What the DAC's codes drive the amplifier to, and its rest.
    pub drive: DriveCalibration,
    /// Displacement at the sensor's code 0 and at full scale, µm; `None` where no sensor is connected.
    pub sensor_um: Option<(f64, f64)>,
    /// Noise of the monitor's reading, V rms.
    pub monitor_noise_v: f64,
    /// Noise of the sensor's reading, nm rms.
    pub sensor_noise_nm: f64,
    /// Draws the noise.
    pub seed: u64,
}

/// Instruments on the bench: what is, whatever the board's converters make of it.
#[derive(Debug, Default)]
pub struct Meters {
    /// Bits of an f64, V.
    voltage: AtomicU64,
    /// Bits of an f64, µm.
    displacement: AtomicU64,
}

impl Meters {
    /// Voltage at the amplifier's output, V.
    pub fn voltage(&self) -> f64 {
        f64::from_bits(self.voltage.load(Ordering::Relaxed))
    }

    /// Displacement from the rest, µm.
    pub fn displacement(&self) -> f64 {
        f64::from_bits(self.displacement.load(Ordering::Relaxed))
    }
}

impl Bench {
    /// Connects it to a device.
    pub fn connected(self) -> impl Plant {
        self.metered().0
    }

    /// Connects it to a device, with instruments beside it.
    pub fn metered(self) -> (impl Plant, Arc<Meters>) {
        let meters = Arc::new(Meters::default());
        let (rest, range) = (f64::from(self.drive.limits.rest_v), self.drive.limits.range_v);
        let Range { min, max } = range;
        let farther = [f64::from(max) - rest, f64::from(min) - rest];
        let reach = if farther[0] >= -farther[1] { farther[0] } else { farther[1] };
        let full_v = self.actuator.full_v;
        let slew_v_per_s = self.actuator.slew_v_per_s.map(|slew| slew * full_v / reach.abs());
        let actuator = plants::Plant { slew_v_per_s, ..self.actuator };
        let um = self.stroke_um / first_stroke(&actuator);
        let connected = Connected {
            bench: self,
            rest,
            volts: full_v / reach.abs(),
            um,
            running: actuator.running(),
            noise: ChaCha8Rng::seed_from_u64(self.seed),
            meters: meters.clone(),
        };
        (connected, meters)
    }
}

/// From rest to the full voltage for the first time, slowly enough for the amplifier, µm.
fn first_stroke(actuator: &plants::Plant) -> f64 {
    let quick = plants::Plant { creep: 0.0, lag_s: 0.0, slew_v_per_s: None, ..*actuator };
    let rise: Vec<f64> = (0..=10_000).map(|k| actuator.full_v * f64::from(k) / 10_000.0).collect();
    let reached = quick.respond(&rise);
    // A way of ten thousand steps has a first and a last.
    reached.last().zip(reached.first()).map_or(1.0, |(last, first)| last - first)
}

/// A bench that runs.
struct Connected {
    bench: Bench,
    rest: f64,
    /// The actuator's own volts a volt.
    volts: f64,
    /// µm at the sensor a µm of the actuator's own.
    um: f64,
    running: Running,
    noise: ChaCha8Rng,
    meters: Arc<Meters>,
}

impl Connected {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.noise)
    }
}

impl Plant for Connected {
    fn sample(&mut self, dac: DacCode) -> Conversion {
        let command = (self.bench.drive.voltage::<f64>(dac) - self.rest) * self.volts;
        let mut position = 0.0;
        for _ in 0..STEPS {
            position = self.um * self.running.step(command);
        }
        let voltage = self.rest + self.running.voltage() / self.volts;
        self.meters.voltage.store(voltage.to_bits(), Ordering::Relaxed);
        self.meters.displacement.store(position.to_bits(), Ordering::Relaxed);
        let voltage = voltage + self.bench.monitor_noise_v * self.normal();
        let monitor = self.bench.monitor.code(voltage);
        let sensor = self.bench.sensor_um.map(|(zero, full)| {
            let reading = position + 1e-3 * self.bench.sensor_noise_nm * self.normal();
            let scale = f64::from(self.bench.monitor.full_scale);
            // Limited to the converter's range, which fits.
            AdcCode(((reading - zero) / (full - zero) * scale).round().clamp(0.0, scale) as u16)
        });
        Conversion { monitor, sensor, setpoint: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::DriveLimits;
    use plants::{CATALOGUE, Kind};

    fn bench(kind: Kind) -> Bench {
        let limits = DriveLimits { range_v: Range { min: 0.0, max: 100.0 }, rest_v: 0.0, slew_v_per_s: 500.0 };
        Bench {
            actuator: plants::Plant::drawn(kind, 3),
            stroke_um: 15.0,
            monitor: AdcCalibration {
                gain_v_per_code: 170.0 / 65_520.0,
                offset_v: -35.0,
                invert: false,
                full_scale: 65_520,
            },
            drive: DriveCalibration {
                gain_codes_per_v: 4095.0 / 160.0,
                offset_code: 30.0 * 4095.0 / 160.0,
                limits,
                setpoint: None,
            },
            sensor_um: Some((-5.0, 25.0)),
            monitor_noise_v: 0.02,
            sensor_noise_nm: 5.0,
            seed: 1,
        }
    }

    /// Volts and µm that the codes stand for, after so many ticks at a commanded voltage.
    fn reads(bench: &Bench, plant: &mut impl Plant, command: f64, ticks: u32) -> (f64, f64) {
        let dac = bench.drive.code(command, 4095);
        let read = (0..ticks).map(|_| plant.sample(dac)).last().unwrap();
        (bench.monitor.voltage(read.monitor), -5.0 + 30.0 * f64::from(read.sensor.unwrap().0) / 65_520.0)
    }

    #[test]
    fn every_kind_rests_at_its_rest_and_goes_its_stroke() {
        for kind in CATALOGUE {
            let bench = bench(kind);
            let mut plant = bench.connected();
            let (volts, um) = reads(&bench, &mut plant, 0.0, 100);
            assert!(volts.abs() < 0.15 && um.abs() < 0.03, "{kind:?}: {volts} V, {um} µm");
            let (volts, um) = reads(&bench, &mut plant, 100.0, 100);
            // A step does what a slow way does, but for creep and a threshold that grows with the rate.
            assert!((volts - 100.0).abs() < 0.15 && (14.0..17.5).contains(&um), "{kind:?}: {volts} V, {um} µm");
            let (volts, back) = reads(&bench, &mut plant, 0.0, 100);
            assert!(volts.abs() < 0.15 && (0.2..4.0).contains(&back), "{kind:?}: {volts} V, {back} µm: no hysteresis");
        }
    }

    #[test]
    fn without_a_sensor_there_is_no_code_and_beyond_its_span_it_saturates() {
        let blind = Bench { sensor_um: None, ..bench(Kind::BoucWen) };
        assert_eq!(blind.connected().sample(DacCode(0)).sensor, None);
        let short = Bench { sensor_um: Some((-1.0, 5.0)), ..bench(Kind::BoucWen) };
        let mut plant = short.connected();
        let dac = short.drive.code(100.0, 4095);
        let read = (0..100).map(|_| plant.sample(dac)).last().unwrap();
        assert_eq!(read.sensor, Some(AdcCode(65_520)));
    }
}
