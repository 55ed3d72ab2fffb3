//! Tables for a converter that sees all of their voltages.

use super::models::table_of;
use estimator_core::*;

/// A table of a model with a converter of 12 bits over a twentieth more than its voltages at either end, and a deadband
/// of so many of its codes.
pub fn table_read_by_12_bits(model: Model, deadband_codes: f32) -> Table {
    let table = table_of(model);
    let Range { min, max } = table.voltage_range_v;
    let gain_v_per_code = 1.1 * (max - min) / 4095.0;
    let adc = AdcCalibration { gain_v_per_code, offset_v: min - 0.05 * (max - min), invert: false, full_scale: 4095 };
    let deadband_v = deadband_codes * gain_v_per_code;
    let mut table = Table { adc, deadband_v, ..table };
    match &mut table.parameters {
        Parameters::Narx(of) => of.deadband_v = deadband_v,
        Parameters::VoigtChain(of) => of.deadband_v = deadband_v,
        _ => {}
    }
    table
}
