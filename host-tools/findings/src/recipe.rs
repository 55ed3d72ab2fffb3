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

/// What is left out of each log's ends, where that is anything.
pub fn ends_left_out(recipe: &Recipe) -> Option<String> {
    let ends = [("first", recipe.skip_start_s, "--skip-start"), ("last", recipe.skip_end_s, "--skip-end")];
    let left: Vec<_> = ends.into_iter().filter(|&(_, seconds, _)| seconds > 0.0).collect();
    let of = left.iter().map(|(end, seconds, _)| format!("the {end} {seconds} s")).collect::<Vec<_>>().join(" and ");
    let takes = left.iter().map(|(.., option)| format!("{option} 0")).collect::<Vec<_>>().join(" ");
    (!left.is_empty())
        .then(|| format!("Left out of each log, as the table says or was typed: {of}; {takes} takes all."))
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
