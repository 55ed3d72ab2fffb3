//! The numbers of a table's model, one by one.

use estimator_core::{Admitted, Parameters, Table};
use serde_json::Value;

/// Change of a number, of its size.
const STEP: f64 = 1e-3;
/// How a model is laid out before anything is fitted: no log has told these.
const LAID_OUT: [&str; 11] = [
    "span_v",
    "memory_v",
    "half_widths_v",
    "thresholds_v",
    "dead_zones_um",
    "creep_times_s",
    "voltage_centre_v",
    "deadband_v",
    "limits_um",
    "lower_v",
    "upper_v",
];
/// A delay is known beforehand to some ticks, however small it is.
const TICKS: (&str, f64) = ("delay_ticks", 1.0);

/// A number of the model, and what a change of it makes.
pub struct Number {
    /// The table with the number a little larger, or smaller.
    pub changed: Admitted,
    /// By how much, as a part of the number's size.
    pub step: f64,
}

/// Every number of a table that a log could have told: those that are not 0, for that says that a stage is not there,
/// and that can be a little other without breaking a rule; and how many could not.
pub fn numbers(table: &Admitted) -> (Vec<Number>, usize) {
    let Ok(parameters) = serde_json::to_value(table.parameters) else { return (Vec::new(), 0) };
    let mut found = Vec::new();
    leaves(&parameters, "", String::new(), &mut found);
    let numbers: Vec<Number> =
        found.iter().filter_map(|(pointer, size)| number(table, &parameters, pointer, *size)).collect();
    let held = found.len() - numbers.len();
    (numbers, held)
}

/// Where numbers are, as JSON pointers, and their sizes: in a list the mean, where the number itself is smaller.
fn leaves(value: &Value, name: &str, pointer: String, found: &mut Vec<(String, f64)>) {
    let list = |items: &[Value]| {
        let sizes = items.iter().filter_map(Value::as_f64).map(f64::abs);
        sizes.sum::<f64>() / items.len().max(1) as f64
    };
    match value {
        Value::Object(fields) => {
            for (name, field) in fields.iter().filter(|(name, _)| !LAID_OUT.contains(&name.as_str())) {
                leaves(field, name, format!("{pointer}/{name}"), found);
            }
        }
        Value::Array(items) => {
            let mean = list(items);
            for (index, item) in items.iter().enumerate() {
                match item.as_f64() {
                    Some(number) if mean > 0.0 => found.push((format!("{pointer}/{index}"), number.abs().max(mean))),
                    Some(_) => {}
                    None => leaves(item, name, format!("{pointer}/{index}"), found),
                }
            }
        }
        Value::Number(number) => {
            let size = number.as_f64().unwrap_or(0.0).abs();
            let (delay, least) = TICKS;
            let size = if name == delay { size.max(least) } else { size };
            if size > 0.0 {
                found.push((pointer, size));
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

fn number(table: &Admitted, parameters: &Value, pointer: &str, size: f64) -> Option<Number> {
    let changed = |step: f64| {
        let mut changed = parameters.clone();
        let number = changed.pointer_mut(pointer)?;
        let before = number.as_f64()?;
        *number = (before + step * size).into();
        let parameters: Parameters = serde_json::from_value(changed).ok()?;
        // An f32 has seven digits: the change is what has come of it.
        let after = serde_json::to_value(parameters).ok()?.pointer(pointer)?.as_f64()?;
        let changed = Table { parameters, ..**table }.admit().ok()?;
        (after != before).then_some(Number { changed, step: (after - before) / size })
    };
    changed(STEP).or_else(|| changed(-STEP))
}
