//! The tables of the core's own tests, which are as long as a record of their model may be.

use estimator_core::*;

#[path = "../../../../../estimator-core/tests/library/common/models.rs"]
pub mod models;

/// Of no use here: the tables of Voigt's family are those that were identified.
const VOIGT: VoigtParameters = VoigtParameters {
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

/// What the tables have in common beyond their model.
fn table() -> Table {
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
        adc: AdcCalibration { gain_v_per_code: 1.0, offset_v: 0.0, invert: false, full_scale: 65_520 },
        amplifier_slew_v_per_s: None,
        dac: DacCalibration { gain_codes_per_um: 1.0, offset_code: 0.0, full_scale: 4095 },
        drive: None,
        interval: None,
        provenance: Provenance {
            logs: Digest([0xa5; 8]),
            seed: 7,
            tool_version: [0, 1, 0],
            train_mae_um: 0.25,
            validation_mae_um: None,
            validation_max_um: None,
        },
    }
}
