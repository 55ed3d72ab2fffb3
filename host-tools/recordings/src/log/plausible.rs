//! Sizes no log of a piezo actuator has: most often a wrong unit or a wrong column.

use super::error::PlacedFault;
use super::fault::Fault;
use super::number::Number;
use super::recording::Recording;
use measurement_files::Quantity;

/// Refuses a constant voltage or displacement, a voltage span outside 1 mV to 5 kV and a displacement span outside
/// 1 nm to 10 mm. A few values beyond, as a spike's, are no wrong unit.
pub(super) fn check(recording: &Recording) -> Result<(), PlacedFault> {
    check_span(recording, Quantity::Voltage, &recording.voltage, (1e-3, "less than 1 mV"), (5e3, "more than 5 kV"))?;
    match &recording.displacement {
        Some(displacement) => check_span(
            recording,
            Quantity::Displacement,
            displacement,
            (1e-3, "less than 1 nm"),
            (1e4, "more than 10 mm"),
        ),
        None => Ok(()),
    }
}

fn check_span(
    recording: &Recording,
    quantity: Quantity,
    values: &[f64],
    least: (f64, &'static str),
    most: (f64, &'static str),
) -> Result<(), PlacedFault> {
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let span = largest - smallest;
    let unit = recording.channels.get(quantity).map_or(quantity.base(), |channel| channel.unit);
    let suggested = |unit| recording.channels.restated(quantity, unit);
    // Of a span that is none too large, which few are, nothing rare has to be left out.
    let usual = if span > most.0 { usual_span(values) } else { span };
    let (limit, other) = if span == 0.0 {
        return Err(Fault::Constant {
            quantity,
            value: Number(largest),
            unit: quantity.base(),
            rows: values.len(),
            example: suggested(unit),
        }
        .into());
    } else if span < least.0 {
        (least.1, unit.larger())
    } else if usual > most.0 {
        (most.1, unit.smaller())
    } else {
        return Ok(());
    };
    Err(Fault::ImplausibleSpan {
        quantity,
        span: Number(if span < least.0 { span } else { usual }),
        base: quantity.base(),
        limit,
        unit,
        example: suggested(other.unwrap_or(unit)),
    }
    .into())
}

/// One value in so many is left out of a span that is too large, at either end.
const RARE: usize = 100;

/// How far all values but the rarest go.
fn usual_span(values: &[f64]) -> f64 {
    let rare = values.len() / RARE;
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    match (sorted.get(rare), sorted.iter().rev().nth(rare)) {
        (Some(low), Some(high)) => high - low,
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, parsed, refused, rows};
    use super::*;

    fn scaled(voltage: f64, displacement: f64) -> String {
        let row = |t, v, y| format!("{t},{},{}", v * voltage + 1.0, y * displacement + 1.0);
        "t_s,u_V,y_um\n".to_owned() + &rows(0.001, row)
    }

    #[test]
    fn wrong_units_are_named_with_the_likely_one() {
        let likely = |voltage, displacement| {
            let (_, fault) = refused(&scaled(voltage, displacement), &options("", None));
            let Fault::ImplausibleSpan { limit, ref example, .. } = fault else { panic!("{fault}") };
            format!("{limit}; {example}")
        };
        assert!(likely(1.0, 1e4).contains("more than 10 mm"));
        assert!(likely(1.0, 1e4).ends_with("displacement=3:nm"));
        assert!(likely(1.0, 1e-6).contains("less than 1 nm"));
        assert!(likely(1.0, 1e-6).ends_with("displacement=3:mm"));
        assert!(likely(1e3, 1.0).contains("voltage=2:mV"));
        assert!(likely(1e-6, 1.0).contains("voltage=2:kV"));
        let restated = options("time=1,voltage=2,displacement=3:nm", None);
        assert!(parsed(&scaled(1.0, 1e4), &restated).is_ok());
    }

    #[test]
    fn a_spike_beyond_every_stroke_is_no_wrong_unit() {
        let rows: String = (0..400)
            .map(|row| {
                format!(
                    "{},{},{}\n",
                    f64::from(row) * 1e-3,
                    row % 40,
                    if row == 200 { 5e5 } else { f64::from(row % 40) }
                )
            })
            .collect();
        assert!(parsed(&format!("t_s,u_V,y_um\n{rows}"), &options("", None)).is_ok());
    }

    #[test]
    fn constant_series_are_refused() {
        for (voltage, displacement, expected) in [(0.0, 1.0, Quantity::Voltage), (1.0, 0.0, Quantity::Displacement)] {
            let (_, fault) = refused(&scaled(voltage, displacement), &options("", None));
            assert!(matches!(fault, Fault::Constant { quantity, rows: 20, .. } if quantity == expected));
        }
    }
}
