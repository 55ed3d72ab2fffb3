//! A bench behind an emulated device's converters: amplifier, actuator and displacement sensor.
//!
//! ```text
//! DAC code ─► command V ─► slew, lag ─► voltage V ─► ADC code, with noise                            the amplifier's monitor
//!                                          └─► hysteresis, creep ─► µm ─► lag, drift ─► ADC code, with noise    the sensor
//! ```
//!
//! Both converters have an integral nonlinearity, which two readings of a multimeter do not take away.
//!
//! The actuator is one of [`plants`], at rest and virgin where the amplifier rests. It counts from there: its full
//! voltage is the end of the drive's range that is farther away.

use crate::plant::Plant;
use estimator_core::{AdcCalibration, AdcCode, DacCode, DriveCalibration, Range};
use firmware::Conversion;
use firmware::rate::{TICK_HZ, TICK_US};
use plants::{Change, Converter, Running, STEP_S};
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
    /// Displacement from the rest to the end of the drive's range that is farther away, first time and
    /// without creep, µm.
    pub stroke_um: f64,
    /// What the monitor's codes stand for.
    pub monitor: AdcCalibration,
    /// What the DAC's codes drive the amplifier to, and its rest.
    pub drive: DriveCalibration,
    /// Displacement at the sensor's code 0 and at full scale, µm; `None` where no sensor is connected.
    pub sensor_um: Option<(f64, f64)>,
    /// The converter of monitor and sensor over its own range, 0 … 1.
    pub adc: Converter,
    /// The converter that drives, over the voltages of its codes.
    pub dac: Converter,
    /// Time constant of the sensor's electronics, s.
    pub sensor_lag_s: f64,
    /// What the sensor's zero does, nm/s.
    pub sensor_drift_nm_per_s: f64,
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
    /// The same with an actuator that is warmer, loaded or older.
    #[must_use]
    pub fn after(self, change: Change) -> Self {
        Self { actuator: self.actuator.after(change), ..self }
    }

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
            monitor_v: (self.monitor.voltage(AdcCode(0)), self.monitor.voltage(AdcCode(self.monitor.full_scale))),
            volts: full_v / reach.abs(),
            um,
            running: actuator.running(),
            sensor: Sensor { keep: libm::exp(-STEP_S / self.sensor_lag_s), ..Sensor::default() },
            noise: ChaCha8Rng::seed_from_u64(self.seed),
            meters: meters.clone(),
        };
        (connected, meters)
    }
}

/// From rest to the full voltage for the first time, slowly enough for the amplifier and as it was learnt, µm.
fn first_stroke(actuator: &plants::Plant) -> f64 {
    let quick = plants::Plant { creep: 0.0, lag_s: 0.0, slew_v_per_s: None, change: Change::NONE, ..*actuator };
    let rise: Vec<f64> = (0..=10_000).map(|k| actuator.full_v * f64::from(k) / 10_000.0).collect();
    let reached = quick.respond(&rise);
    // A way of ten thousand steps has a first and a last.
    reached.last().zip(reached.first()).map_or(1.0, |(last, first)| last - first)
}

/// A bench that runs.
struct Connected {
    bench: Bench,
    rest: f64,
    /// At the monitor's code 0 and at full scale, V.
    monitor_v: (f64, f64),
    /// The actuator's own volts a volt.
    volts: f64,
    /// µm at the sensor a µm of the actuator's own.
    um: f64,
    running: Running,
    sensor: Sensor,
    noise: ChaCha8Rng,
    meters: Arc<Meters>,
}

/// What the sensor's electronics make of a position.
#[derive(Default)]
struct Sensor {
    /// Part of what it showed that a step leaves.
    keep: f64,
    /// What its display shows, without drift, µm.
    shown: f64,
    drift: f64,
}

impl Connected {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.noise)
    }
}

impl Plant for Connected {
    fn sample(&mut self, dac: DacCode) -> Conversion {
        let command = (self.bench.dac.bent(self.bench.drive.voltage(dac)) - self.rest) * self.volts;
        let mut position = 0.0;
        for _ in 0..STEPS {
            position = self.um * self.running.step(command);
            self.sensor.shown = position + self.sensor.keep * (self.sensor.shown - position);
        }
        self.sensor.drift += 1e-3 * self.bench.sensor_drift_nm_per_s / f64::from(TICK_HZ);
        let voltage = self.rest + self.running.voltage() / self.volts;
        self.meters.voltage.store(voltage.to_bits(), Ordering::Relaxed);
        self.meters.displacement.store(position.to_bits(), Ordering::Relaxed);
        let Bench {
            monitor: AdcCalibration { full_scale, .. }, adc, monitor_noise_v, sensor_noise_nm, sensor_um, ..
        } = self.bench;
        let full = f64::from(full_scale);
        // Limited to the converter's range, which fits.
        let code = |reading: f64, (zero, end): (f64, f64)| {
            AdcCode((adc.bent((reading - zero) / (end - zero)) * full).round().clamp(0.0, full) as u16)
        };
        let monitor = code(voltage + monitor_noise_v * self.normal(), self.monitor_v);
        let sensor = sensor_um.map(|span| {
            let noise = 1e-3 * sensor_noise_nm * self.normal();
            code(self.sensor.shown + self.sensor.drift + noise, span)
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
            adc: Converter::adc(Range { min: 0.0, max: 1.0 }),
            dac: Converter::dac(Range { min: -30.0, max: 129.96 }),
            sensor_lag_s: 5e-5,
            sensor_drift_nm_per_s: 0.0,
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
            assert!(volts.abs() < 0.25 && um.abs() < 0.04, "{kind:?}: {volts} V, {um} µm");
            let (volts, um) = reads(&bench, &mut plant, 100.0, 100);
            // A step does what a slow way does, but for creep and a threshold that grows with the rate.
            assert!((volts - 100.0).abs() < 0.25 && (14.0..17.5).contains(&um), "{kind:?}: {volts} V, {um} µm");
            let (volts, back) = reads(&bench, &mut plant, 0.0, 100);
            assert!(volts.abs() < 0.25 && (0.2..4.0).contains(&back), "{kind:?}: {volts} V, {back} µm: no hysteresis");
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

    /// What the sensor reads of itself, without noise, after so many ticks at full voltage, µm.
    fn sensor_at_full(bench: Bench, ticks: u32) -> f64 {
        let bench = Bench { sensor_noise_nm: 0.0, monitor_noise_v: 0.0, ..bench };
        reads(&bench, &mut bench.connected(), 100.0, ticks).1
    }

    #[test]
    fn the_sensor_lags_and_drifts() {
        let exact =
            Bench { adc: Converter::adc(Range { min: 0.0, max: 1.0 }).of_nonlinearity(0.0), ..bench(Kind::BoucWen) };
        let [quick, slow] = [5e-5, 2e-3].map(|sensor_lag_s| sensor_at_full(Bench { sensor_lag_s, ..exact }, 4));
        assert!(slow < 0.8 * quick, "{slow} of {quick} µm in 2 ms");
        let drifting = Bench { sensor_drift_nm_per_s: 100.0, ..exact };
        let [still, drifted] = [exact, drifting].map(|bench| sensor_at_full(bench, TICK_HZ));
        assert!((drifted - still - 0.1).abs() < 1e-3, "{drifted} against {still} µm after a second");
    }

    #[test]
    fn a_load_takes_its_part_of_the_stroke_and_warmth_lengthens() {
        let cold = bench(Kind::BoucWen);
        let [free, loaded, warm] = [Change::NONE, Change::load(1.0, 0.0), Change::warming(2.0)]
            .map(|change| sensor_at_full(cold.after(change), TICK_HZ));
        assert!((loaded / free - 0.5).abs() < 0.02, "{loaded} of {free} µm");
        // 2 K: about 1 % of the stroke each, less 0.3 % of the strain.
        assert!((0.01..0.02).contains(&(warm / free - 1.0)), "{warm} of {free} µm");
    }
}
