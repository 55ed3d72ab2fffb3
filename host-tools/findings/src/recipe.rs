//! How logs were prepared, in words.

use crate::micrometres::Micrometres;
use estimator_core::Range;
use recordings::prepare::Recipe;

/// Voltages that go no further may be a monitor's or an amplifier's input, V.
const MONITOR_V: f64 = 12.0;

/// What is asked of voltages (V) that may be a monitor's or an amplifier's input.
pub fn monitor_asked(volts: Range<f64>) -> Option<&'static str> {
    (volts.min.abs().max(volts.max.abs()) <= MONITOR_V).then_some(
        "is this voltage a monitor's, or the amplifier's input, and not the actuator's? Then identify needs the factor between them: \
         --voltage-scale <N>, 20 of a monitor 1:20",
    )
}

/// Scale, zeros and delay in words.
pub fn zeros(recipe: &Recipe) -> String {
    let volts = match recipe.voltage_scale {
        1.0 => "The voltage is taken as recorded".to_owned(),
        scale => format!("The voltage is the recorded one times {scale}"),
    };
    format!(
        "{volts}; the model counts volts from {:.4} V, and µm from {:.4} µm of the sensor, whose delay is taken as {:.2} ms",
        recipe.voltage_zero_v,
        Micrometres(recipe.displacement_zero_um),
        f64::from(recipe.delay_ticks) * recipe.tick_s() * 1e3
    )
}
