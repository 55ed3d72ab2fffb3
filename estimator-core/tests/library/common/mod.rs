//! A table to test with: Table 4.6's simulation set, calibrated to a 12-bit converter over ±22 V.

pub mod converter;
pub mod models;

use estimator_core::interval::{PLAYS, PROTOTYPES, TRIANGLE};
use estimator_core::*;
use proptest::prelude::*;

pub const VOIGT: VoigtParameters = VoigtParameters {
    alpha_um: 1139.296,
    beta_v: 749.755,
    lambda_per_v: 0.00772,
    b_ohm: 90777.126,
    p: 0.754,
    g_um_per_s: 0.0,
    h: 0.0,
    e_m_per_s: 0.0,
    f: 0.0,
};

pub fn table() -> Table {
    Table {
        sample_period_us: 500,
        scheme: Scheme::ForwardEuler,
        deadband_v: 0.0,
        voltage_zero_v: 0.0,
        displacement_zero_um: 0.0,
        voltage_range_v: Range { min: -20.0, max: 20.0 },
        displacement_limits_um: Range { min: -6.0, max: 6.0 },
        parameters: Parameters::Voigt(VOIGT),
        remanence_um: [0.0; 2],
        adc: AdcCalibration { gain_v_per_code: 44.0 / 4095.0, offset_v: -22.0, invert: false, full_scale: 4095 },
        amplifier_slew_v_per_s: None,
        dac: DacCalibration { gain_codes_per_um: 300.0, offset_code: 2047.5, full_scale: 4095 },
        drive: None,
        interval: None,
        provenance: Provenance {
            logs: Digest([0xa5; 8]),
            seed: 7,
            tool_version: [0, 1, 0],
            train_mae_um: 0.25,
            validation_mae_um: Some(0.26),
            validation_max_um: None,
        },
    }
}

/// An interval in which every part has its own size; the plays count alone.
pub fn interval() -> IntervalParameters {
    let mut spread_um = [0.0; TRIANGLE];
    (0..PLAYS).for_each(|row| spread_um[row * (row + 3) / 2] = 0.2);
    IntervalParameters {
        memory_um: [2.0, 1.0, 0.5, 0.25, 0.0, 0.0, 0.0, 0.0, 0.0],
        memory_at_ends: 0.0,
        misfit_um: 0.1,
        rate_ticks: 1.0,
        spread_um,
        prototypes: [[0; PLAYS]; PROTOTYPES],
        prototype_um: 0.01,
        untrained_um: 0.1,
        gain: 0.02,
        drift_um: 0.05,
        earliest_s: 0.01,
    }
}

/// Tables around plausible ones, most of them admissible; all that are not must be refused by `admit`.
pub fn any_table() -> impl Strategy<Value = Table> {
    let drive = (1.0f32..3.3, 0.3f32..1.2, 0.0f32..0.02, -200.0f32..800.0);
    let extrema = (0usize..4, -0.4f32..0.4, 0.0f32..2.0, -0.4f32..0.4, 0.0f32..2.0);
    let signal = (-30.0f32..30.0, 0.5f32..60.0, 0.0f32..1.0, -100.0f32..100.0, -100.0f32..100.0);
    let codes = (any::<bool>(), any::<bool>(), -5000.0f32..5000.0, 3u16..);
    let tick = (any::<bool>(), prop_oneof![Just(500u32), 10u32..10_000]);
    (drive, extrema, signal, codes, tick).prop_map(
        |((rate, p, lambda, beta), (model, g, h, e, f), signal, (invert, dac_invert, offset, full), tick)| {
            let (zoh, sample_period_us) = tick;
            let (low, span, deadband, v0, y0) = signal;
            let model = Model::VOIGT_FAMILY[model];
            let high = low + span;
            // The rate at the range's middle, and a static displacement of ±5 µm or so at its ends.
            let rate = 10f32.powf(rate);
            let middle = (lambda * (beta - (low + high) / 2.0)).exp();
            let reach = low.abs().max(high.abs());
            let drive = 5.0 * rate;
            let b = reach * (1e6 / drive).powf(1.0 / p);
            let (g, h) = if model.has_voltage_term() { (g * drive / reach.powf(h), h) } else { (0.0, 0.0) };
            let (e, f) = if model.has_displacement_term() {
                (e * drive / 5f32.powf(f) / 10f32.powf(6.0 * (1.0 - f)), f)
            } else {
                (0.0, 0.0)
            };
            Table {
                sample_period_us,
                scheme: if zoh { Scheme::ZeroOrderHold } else { Scheme::ForwardEuler },
                deadband_v: deadband * span * 0.1,
                voltage_zero_v: v0,
                displacement_zero_um: y0,
                voltage_range_v: Range { min: low, max: high },
                displacement_limits_um: Range { min: -30.0, max: 30.0 },
                parameters: Parameters::of_voigt_family(
                    model,
                    VoigtParameters {
                        alpha_um: 1e6 * (2.0 + middle + 1.0 / middle) / (rate * lambda * b),
                        beta_v: beta,
                        lambda_per_v: lambda,
                        b_ohm: b,
                        p,
                        g_um_per_s: g,
                        h,
                        e_m_per_s: e,
                        f,
                    },
                ),
                adc: AdcCalibration {
                    gain_v_per_code: 1.2 * span / f32::from(full),
                    offset_v: v0 + if invert { high + 0.1 * span } else { low - 0.1 * span },
                    invert,
                    full_scale: full,
                },
                dac: DacCalibration {
                    gain_codes_per_um: if dac_invert { -70.0 } else { 70.0 },
                    offset_code: offset,
                    full_scale: full,
                },
                ..table()
            }
        },
    )
}

/// Puts the right checksum behind whatever the record holds.
pub fn resealed(mut record: Vec<u8>) -> Vec<u8> {
    let body = record.len() - 4;
    let checksum = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC).checksum(&record[..body]);
    record[body..].copy_from_slice(&checksum.to_le_bytes());
    record
}
