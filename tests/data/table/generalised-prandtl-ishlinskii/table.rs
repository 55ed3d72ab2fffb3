// Made by `piezo emit`; change table.toml instead.
// Logs 57bf11f99660667d, seed 1, training MAE 0.0739 µm.

#[allow(unused_imports, reason = "which types a table names depends on what it has")]
use estimator_core::{
    AdcCalibration, DacCalibration, Digest, DriveCalibration, DriveLimits, IntervalParameters, List, Parameters,
    Provenance, Range, Scheme::*, Table, GeneralisedPrandtlIshlinskiiParameters,
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
        min: -7.218351,
        max: 50.451912,
    },
    parameters: Parameters::GeneralisedPrandtlIshlinskii(
        GeneralisedPrandtlIshlinskiiParameters {
            span_v: Range {
                min: 0.0,
                max: 3.6,
            },
            delay_ticks: 8.912666,
            slew_v_per_s: 0.0,
            lag_s: 0.010612198,
            resonance_hz: 0.0,
            damping: 0.0,
            reversible_um_per_v: List::of(
                [
                    8.389243,
                    8.28598,
                    8.73839,
                    8.625915,
                    8.298165,
                    8.424067,
                    8.825284,
                    8.531161,
                    8.292415,
                ],
            ),
            envelope_um_per_v: List::of(
                [
                    35.170715,
                    17.667353,
                    14.120799,
                    13.651538,
                    12.972345,
                    12.052777,
                    10.88053,
                    9.292908,
                    11.851624,
                ],
            ),
            half_widths_v: List::of(
                [
                    0.036,
                    0.04760554,
                    0.06295243,
                    0.08324679,
                    0.11008357,
                    0.14557189,
                    0.19250078,
                    0.25455844,
                    0.336622,
                    0.4451409,
                    0.5886437,
                    0.7784084,
                    1.0293486,
                    1.3611861,
                    1.8,
                ],
            ),
            weights: List::of(
                [
                    0.019494057,
                    0.006232722,
                    0.008152465,
                    0.010626026,
                    0.013785753,
                    0.017775258,
                    0.02273343,
                    0.028763227,
                    0.035877846,
                    0.043917503,
                    0.052436687,
                    0.06058053,
                    0.06700716,
                    0.06996867,
                    0.06770475,
                ],
            ),
            creep_times_s: List::of(
                [
                    0.01,
                    0.1,
                    1.0,
                    10.0,
                    100.0,
                ],
            ),
            creep_gains: List::of(
                [
                    0.021764468,
                    0.025318135,
                    0.0288718,
                    0.032425467,
                    0.035979133,
                ],
            ),
            rest_memory: 0.6649107,
            offset_um: -10.434809,
        },
    ),
    adc: AdcCalibration {
        gain_v_per_code: 0.0010637363,
        offset_v: -0.378,
        invert: false,
        full_scale: 4095,
    },
    dac: DacCalibration {
        gain_codes_per_um: 71.00713,
        offset_code: 512.5544,
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
    interval: None,
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
        train_mae_um: 0.07387277,
        validation_mae_um: Some(
            0.08456455,
        ),
        validation_max_um: Some(
            0.3809199,
        ),
    },
};
