// Made by `piezo emit`; change table.toml instead.
// Logs 63f15b78b7a097e3, seed 1, training MAE 0.3061 µm.
// Checksum f4462648.

#[allow(unused_imports, reason = "which types a table names depends on what it has")]
use estimator_core::{
    AdcCalibration, DacCalibration, Digest, DriveCalibration, DriveLimits, IntervalParameters, List, Parameters,
    Provenance, Range, Scheme::*, SetpointCalibration, Table, VoigtParameters,
};

/// The compiled-in parameter table.
pub const TABLE: Table = Table {
    sample_period_us: 500,
    scheme: ForwardEuler,
    deadband_v: 0.002988,
    voltage_zero_v: 0.0,
    displacement_zero_um: -118.681114,
    voltage_range_v: Range {
        min: -0.18,
        max: 3.78,
    },
    displacement_limits_um: Range {
        min: -3.1082249,
        max: 47.29719,
    },
    parameters: Parameters::Voigt(
        VoigtParameters {
            alpha_um: 651.67566,
            beta_v: -0.53082806,
            lambda_per_v: 0.21425441,
            b_ohm: 1041.8104,
            p: 1.1474788,
            g_um_per_s: 0.0,
            h: 0.0,
            e_m_per_s: 0.0,
            f: 0.0,
        },
    ),
    remanence_um: [
        0.0,
        0.0,
    ],
    adc: AdcCalibration {
        gain_v_per_code: 0.0010637363,
        offset_v: -0.378,
        invert: false,
        full_scale: 4095,
    },
    amplifier_slew_v_per_s: None,
    dac: DacCalibration {
        gain_codes_per_um: 81.241264,
        offset_code: 252.51613,
        full_scale: 4095,
    },
    drive: None,
    interval: None,
    provenance: Provenance {
        logs: Digest(
            [
                99,
                241,
                91,
                120,
                183,
                160,
                151,
                227,
            ],
        ),
        seed: 1,
        tool_version: [
            0,
            1,
            0,
        ],
        train_mae_um: 0.30611727,
        validation_mae_um: Some(
            0.30946946,
        ),
        validation_max_um: Some(
            0.83143723,
        ),
    },
};
