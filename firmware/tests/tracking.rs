//! What the box that linearises is worth: set-point by the ADC, command by the DAC, an actuator that is not quite the
//! table's model behind it, and the same set-point through a straight line instead.

mod common;

use common::{FACTS, SETPOINT, linearising, started};
use estimator_core::{AdcCode, Admitted, DacCode, Estimator, Parameters, Table};
use firmware::Conversion;
use firmware::setpoint::CALM_TICKS;
use firmware::startup::Startup;
use protocol::Faults;

const TICKS: usize = 8_000;
/// The actuator's parameters beside those that the table was given.
const OFF: f32 = 1.05;

/// The actuator: the table's model with parameters that are off, in f64, relative to the model's zero.
fn actuator(table: &Admitted) -> Estimator<f64> {
    let Parameters::Voigt(mut voigt) = table.parameters else { panic!("the compiled table's model") };
    voigt.alpha_um *= OFF;
    voigt.b_ohm *= OFF;
    let limits = estimator_core::Range { min: -50.0, max: 100.0 };
    let table = Table { parameters: Parameters::Voigt(voigt), displacement_limits_um: limits, ..**table };
    Estimator::new(&table.admit().expect("wide limits"))
}

/// Swings of 1 Hz that shrink, µm.
fn wanted(k: usize) -> f64 {
    let t = k as f64 * 5e-4;
    20.0 + (12.0 - 2.0 * t) * (t * std::f64::consts::TAU).sin()
}

/// What the converter makes of it.
fn read(k: usize) -> AdcCode {
    let code = (wanted(k) - f64::from(SETPOINT.offset_um)) / f64::from(SETPOINT.gain_um_per_code);
    AdcCode(code.round() as u16)
}

/// Mean absolute error of the displacements of an actuator that is given these codes, µm, without the offset of all.
fn error(table: &Admitted, codes: &[DacCode]) -> f64 {
    let (drive, mut actuator) = (table.drive.unwrap(), actuator(table));
    let after = codes.iter().map(|&code| actuator.tick_volts(drive.voltage(code)).displacement);
    // The code of tick k stands from trigger k + 1 on, and the actuator has answered at k + 2: that latency is
    // no error here.
    let errors: Vec<f64> = after.enumerate().map(|(k, um)| um - wanted(k)).skip(2_000).collect();
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    errors.iter().map(|error| (error - mean).abs()).sum::<f64>() / errors.len() as f64
}

/// The codes that the device gives.
fn linearised(table: &Admitted) -> Vec<DacCode> {
    let (mut tick, link) = started(Startup::new(Some(table), &FACTS, Faults::empty()));
    let mut dac = link.telemetry.safe();
    let calm = CALM_TICKS as usize;
    let all = (0..calm + TICKS).map(|n| {
        let volts = table.drive.unwrap().voltage::<f32>(dac);
        let monitor = AdcCode(table.adc.code(volts).0 + (n % 2) as u16);
        let setpoint = Some(read(n.saturating_sub(calm)));
        dac = DacCode(tick.sample(Conversion { monitor, sensor: None, setpoint }, n as u32 * common::PERIOD).0);
        dac
    });
    all.skip(calm).collect()
}

/// The codes of the straight line through the actuator's own loop, which it would be given by whoever measured that.
fn scaled(table: &Admitted) -> Vec<DacCode> {
    let (drive, mut actuator) = (table.drive.unwrap(), actuator(table));
    let loops: Vec<(f64, f64)> = (0..8_000)
        .map(|k| 1.7 - 1.0 * (k as f64 * 5e-4 * std::f64::consts::TAU).sin())
        .map(|volts| (volts, actuator.tick_volts(volts).displacement))
        .skip(4_000)
        .collect();
    let of = |pick: fn(&(f64, f64)) -> f64| loops.iter().map(pick).sum::<f64>() / loops.len() as f64;
    let (volts, um) = (of(|(volts, _)| *volts), of(|(_, um)| *um));
    let gain = loops.iter().map(|(v, d)| (v - volts) * (d - um)).sum::<f64>()
        / loops.iter().map(|(v, _)| (v - volts).powi(2)).sum::<f64>();
    let codes = (0..TICKS).map(|k| volts + (SETPOINT.displacement::<f64>(read(k)) - um) / gain);
    codes.map(|volts| drive.code(volts, table.dac.full_scale)).collect()
}

#[test]
fn it_tracks_at_least_three_times_as_well_as_a_straight_line_with_both_converters_in_it() {
    let table = linearising(true);
    let (by_inverse, by_line) = (error(&table, &linearised(&table)), error(&table, &scaled(&table)));
    let step = 1.0 / f64::from(table.drive.unwrap().gain_codes_per_v);
    println!(
        "mean error {:.0} nm, of a straight line {:.0} nm; a step of the DAC is {:.1} mV",
        1e3 * by_inverse,
        1e3 * by_line,
        1e3 * step
    );
    assert!(by_inverse <= by_line / 3.0, "{by_inverse} µm, {by_line} µm by a straight line");
}
