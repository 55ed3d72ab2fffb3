//! Every bit of every model: what the estimator and the inverse give in `f32` for one fixed sequence, as a checksum.
//!
//! A table that was proven on one version of this library must give the same numbers on the next. A change that moves
//! bits on purpose renews the checksums here and says why in the changelog.
#![cfg(not(feature = "micromath"))]

use crate::common::VOIGT;
use crate::common::models::{DRIVE, table_of};
use crc::{CRC_32_ISO_HDLC, Crc};
use estimator_core::*;

const CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);
const TICKS: u32 = 5_000;

/// Of the estimator's displacement, DAC code and status; of the inverse's voltage and displacement.
const CHECKSUMS: &[(Model, u32, u32)] = &[
    (Model::Voigt, 0x541b0633, 0x454fbe6a),
    (Model::VoltageExtremum, 0x4868043a, 0x320a33a),
    (Model::DisplacementExtremum, 0x1502df4d, 0x91fe237a),
    (Model::Enhanced, 0x7db5ce3d, 0xdcb37d3c),
    (Model::VoigtChain, 0xa95c6e01, 0x8108dbd1),
    (Model::PrandtlIshlinskii, 0xc62648a8, 0x2c766939),
    (Model::MaxwellSlip, 0x40ce704e, 0xe32da6e4),
    (Model::Duhem, 0xa17708c3, 0x3b48a697),
    (Model::BoucWen, 0xaf5757b, 0x17f2c256),
    (Model::Preisach, 0x122c80be, 0x67ea4f41),
    (Model::Narx, 0x5ed4ee33, 0x0),
    (Model::GeneralisedPrandtlIshlinskii, 0x6ff1d307, 0xf44d20a0),
];

/// A table with every term that the model has.
fn table(model: Model) -> Admitted {
    let mut table = table_of(model);
    if model.is_voigt() {
        let (g_um_per_s, h) = if model.has_voltage_term() { (-3.0, 0.6) } else { (0.0, 0.0) };
        let (e_m_per_s, f) = if model.has_displacement_term() { (2e-5, 1.1) } else { (0.0, 0.0) };
        table.parameters = Parameters::of_voigt_family(model, VoigtParameters { g_um_per_s, h, e_m_per_s, f, ..VOIGT });
        table.deadband_v = 0.05;
    }
    table.admit().unwrap_or_else(|error| panic!("{model}: {error}"))
}

/// A number below 1 from a linear congruential generator (Numerical Recipes).
fn random(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    (*state >> 8) as f32 / 16_777_216.0
}

/// Part of the range at each tick: rest, ramps of every size between random reversals, steps, noise.
fn drive() -> impl Iterator<Item = f32> {
    let mut state = 1;
    let (mut at, mut towards, mut slope) = (0.5f32, 0.5f32, 0.0f32);
    (0..TICKS).map(move |tick| {
        if tick < 200 {
            return at;
        }
        if (at - towards).abs() <= slope {
            towards = random(&mut state);
            slope = match random(&mut state) {
                step if step < 0.05 => 1.0,
                speed => 0.02 * speed * speed + 1e-4,
            };
        }
        at += (towards - at).clamp(-slope, slope);
        (at + 2e-4 * (random(&mut state) - 0.5)).clamp(0.0, 1.0)
    })
}

fn estimator_bits(table: &Admitted) -> u32 {
    let mut digest = CRC.digest();
    let mut estimator = Estimator::<f32>::new(table);
    let Range { min, max } = table.voltage_range_v;
    for at in drive() {
        let voltage = min + (max - min) * at;
        let estimate = estimator.tick_volts(voltage + table.voltage_zero_v);
        digest.update(&estimate.displacement.to_bits().to_le_bytes());
        digest.update(&estimate.dac.0.to_le_bytes());
        digest.update(&[estimate.status.bits()]);
    }
    digest.finalize()
}

/// 0 where the model has no inverse.
fn inverse_bits(table: &Admitted) -> u32 {
    let limits = DriveLimits { slew_v_per_s: 2_000.0, rest_v: 5.0, range_v: DRIVE.limits.range_v };
    let Range { min, max } = table.voltage_range_v;
    let range_v = Range { min: limits.range_v.min.max(min), max: limits.range_v.max.min(max) };
    let Ok(mut inverse) = table.inverse::<f32>(&DriveLimits { range_v, ..limits }) else { return 0 };
    let mut digest = CRC.digest();
    let Range { min, max } = table.displacement_limits_um;
    for at in drive() {
        let commanded = inverse.tick(min + (max - min) * at);
        digest.update(&commanded.voltage.to_bits().to_le_bytes());
        digest.update(&commanded.displacement.to_bits().to_le_bytes());
    }
    digest.finalize()
}

#[test]
fn no_bit_of_any_model_has_moved() {
    let found = Model::ALL.map(|model| (model, estimator_bits(&table(model)), inverse_bits(&table(model))));
    let lines =
        found.map(|(model, estimator, inverse)| format!("    (Model::{model:?}, {estimator:#x}, {inverse:#x}),\n"));
    assert!(
        found == *CHECKSUMS,
        "renew the checksums only where a change is meant to move bits, or for a new model; found:\n{}",
        lines.concat()
    );
}
