//! A wiring with an emulated amplifier, actuator and sensor behind it.

use crate::board_file::BoardFacts;
use crate::wiring::Wiring;
use emulator::Bench;
use estimator_core::{DacCode, Range};
use plants::{Converter, Kind, Plant};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// A PICMA stack of 5 µF on an amplifier of −30 … 130 V and 100 mA at most, its monitor on a 16-bit scale, and a
/// capacitive sensor of 30 µm and 3 kHz.
pub const EMULATED: BoardFacts = BoardFacts {
    adc_span: Some((-35.0, 135.0)),
    adc_full_scale: Some(65_520),
    amplifier_slew: Some(20_000.0),
    dac_full_scale: Some(4095),
    drive_span: Some((-30.0, 130.0)),
    drive_range: Some((0.0, 100.0)),
    drive_rest: Some(0.0),
    drive_slew: Some(500.0),
    sensor_span: Some((-5.0, 25.0)),
    setpoint_span: None,
    linearise: None,
    board_uid: None,
};

/// Noise of the monitor and of the sensor, rms, each of its span: that of a 12-bit converter, oversampled sixteen
/// times, is a sixth of its own step.
const MONITOR_NOISE: f64 = 4e-5;
const SENSOR_NOISE: f64 = 2e-4;
/// The sensor's time constant, s, and most of its drift, a second and of its span.
const SENSOR_LAG_S: f64 = 1.0 / (TAU * 3000.0);
const SENSOR_DRIFT: f64 = 1e-5;
/// The actuator's stroke, and its rest above the sensor's lower end, of the sensor's span.
const STROKE: f64 = 0.5;
const REST: f64 = 1.0 / 6.0;

/// The bench: which kind of actuator, and which of that kind, its noise included.
pub fn emulated(wiring: &Wiring, kind: Kind, number: u64) -> Bench {
    let span_um = wiring.sensor.full_um - wiring.sensor.zero_um;
    // Where the sensor's lower end is at full scale, it rests as far above that.
    let zero = if span_um > 0.0 { REST } else { 1.0 - REST };
    let (adc, drive) = (wiring.adc(), wiring.drive());
    let [lowest, highest] = [0, wiring.line().dac.full_scale].map(|code| drive.voltage(DacCode(code)));
    // Of the most that data sheets state, either way.
    let mut drawn = ChaCha8Rng::seed_from_u64(number);
    let mut part = || drawn.random_range(-1.0..=1.0);
    Bench {
        actuator: Plant { slew_v_per_s: wiring.facts.amplifier_slew, ..Plant::drawn(kind, number) },
        stroke_um: STROKE * span_um.abs(),
        monitor: adc,
        drive,
        adc: Converter::adc(Range { min: 0.0, max: 1.0 }).of_nonlinearity(part()),
        dac: Converter::dac(Range { min: lowest, max: highest }).of_nonlinearity(part()),
        sensor_lag_s: SENSOR_LAG_S,
        sensor_drift_nm_per_s: 1e3 * SENSOR_DRIFT * span_um.abs() * part(),
        sensor_um: Some((-zero * span_um, (1.0 - zero) * span_um)),
        monitor_noise_v: MONITOR_NOISE * f64::from(adc.gain_v_per_code) * f64::from(adc.full_scale),
        sensor_noise_nm: 1e3 * SENSOR_NOISE * span_um.abs(),
        seed: number,
    }
}
