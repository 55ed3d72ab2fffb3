// Made by `piezo emit`; change table.toml instead.
// Logs 57bf11f99660667d, seed 1, training MAE 0.1137 µm.

#[allow(unused_imports, reason = "which types a table names depends on what it has")]
use estimator_core::{
    AdcCalibration, DacCalibration, Digest, DriveCalibration, DriveLimits, List, Parameters, Provenance, Range,
    Scheme::*, Table, GeneralisedPrandtlIshlinskiiParameters,
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
        min: -3.834686,
        max: 47.482994,
    },
    parameters: Parameters::GeneralisedPrandtlIshlinskii(
        GeneralisedPrandtlIshlinskiiParameters {
            span_v: Range {
                min: 0.0,
                max: 3.6,
            },
            delay_ticks: 1.7527894,
            slew_v_per_s: 0.0,
            lag_s: 0.0156065915,
            half_widths_v: List::of(
                [
                    0.0,
                    0.225,
                    0.45,
                    0.675,
                    0.9,
                    1.125,
                    1.35,
                    1.575,
                ],
            ),
            resonance_hz: 0.0,
            damping: 0.0,
            weights_um: List::of(
                [
                    17.37457,
                    15.1715975,
                    2.839422,
                    1.6763046,
                    1.4954392,
                    0.8823094,
                    0.8206488,
                    0.3324683,
                    0.6904826,
                    0.73282486,
                    0.8145716,
                    0.45149678,
                    0.36299145,
                    0.0,
                    0.20970999,
                    0.0,
                ],
            ),
            creep_times_s: List::of(
                [
                    0.01,
                    0.1,
                    1.0,
                    10.0,
                ],
            ),
            creep_um_per_v: List::of(
                [
                    0.06420323,
                    0.06420323,
                    0.06420323,
                    0.06420323,
                ],
            ),
            curvature_per_um: 0.0005337577,
            offset_um: -0.6839774,
        },
    ),
    adc: AdcCalibration {
        gain_v_per_code: 0.0012210013,
        offset_v: -1.0,
        invert: false,
        full_scale: 4095,
    },
    dac: DacCalibration {
        gain_codes_per_um: 79.797066,
        offset_code: 305.99667,
        full_scale: 4095,
    },
    drive: Some(
        DriveCalibration {
            gain_codes_per_v: 1023.75,
            offset_code: -0.0,
            limits: DriveLimits {
                range_v: Range {
                    min: 0.0,
                    max: 3.78,
                },
                rest_v: 0.0,
                slew_v_per_s: 100.0,
            },
        },
    ),
    provenance: Provenance {
        logs: Digest(
            [
                87,
                191,
                17,
                249,
                150,
                96,
                102,
                125,
            ],
        ),
        seed: 1,
        tool_version: [
            0,
            1,
            0,
        ],
        train_mae_um: 0.11370981,
        validation_mae_um: Some(
            0.21526214,
        ),
        validation_max_um: Some(
            0.58271396,
        ),
    },
};
