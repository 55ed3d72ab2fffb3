//! How logs were prepared, in words.

use crate::micrometres::Micrometres;
use recordings::prepare::Recipe;

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
