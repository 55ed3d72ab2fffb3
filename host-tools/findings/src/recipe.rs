//! How logs were prepared, in words.

use recordings::prepare::Recipe;

/// Zeros and delay in words.
pub fn zeros(recipe: &Recipe) -> String {
    format!(
        "{:.4} V and {:.4} µm are the model's zero; the sensor's delay is taken as {:.2} ms",
        recipe.voltage_zero_v,
        recipe.displacement_zero_um,
        f64::from(recipe.delay_ticks) * recipe.tick_s() * 1e3
    )
}
