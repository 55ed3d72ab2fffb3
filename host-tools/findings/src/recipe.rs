//! How logs were prepared, in words.

use recordings::prepare::Recipe;

/// Scale, zeros and delay in words.
pub fn zeros(recipe: &Recipe) -> String {
    let volts = match recipe.voltage_scale {
        1.0 => "The voltage is taken as recorded".to_owned(),
        scale => format!("The voltage is the recorded one times {scale}"),
    };
    format!(
        "{volts}; {:.4} V and {:.4} µm are the model's zero; the sensor's delay is taken as {:.2} ms",
        recipe.voltage_zero_v,
        recipe.displacement_zero_um,
        f64::from(recipe.delay_ticks) * recipe.tick_s() * 1e3
    )
}
