//! Numbers as people read them: three significant digits, a real minus sign.

/// Three significant digits; powers of ten outside 0.001 … 99,999.
pub fn number(x: f64) -> String {
    if x.is_nan() {
        return "undefined".to_owned();
    }
    if x.is_infinite() {
        return if x > 0.0 { "∞" } else { "−∞" }.to_owned();
    }
    let rounded = format!("{x:.2e}");
    let (mantissa, exponent) = rounded.split_once('e').unwrap_or((&rounded, "0"));
    let power: i32 = exponent.parse().unwrap_or(0);
    let text = match power {
        0 if x == 0.0 => "0".to_owned(),
        -3..=4 => format!("{x:.*}", (2 - power).max(0) as usize),
        _ => format!("{mantissa}·10{}", superscript(exponent)),
    };
    text.replace('-', "−")
}

/// A number and its unit, with a space that does not break.
pub fn quantity(x: f64, unit: &str) -> String {
    if unit.is_empty() { number(x) } else { format!("{}\u{a0}{unit}", number(x)) }
}

/// The label of an axis tick, with the decimals that its step needs.
pub fn tick_label(value: f64, step: f64) -> String {
    let decimals = (-step.log10() - 1e-9).ceil().max(0.0);
    if decimals > 3.0 || value.abs() >= 1e5 {
        return number(if value.abs() < step / 2.0 { 0.0 } else { value });
    }
    let text = format!("{value:.*}", decimals as usize);
    // What rounds to zero has no sign.
    if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) {
        return text.trim_start_matches('-').to_owned();
    }
    text.replace('-', "−")
}

fn superscript(exponent: &str) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let raised = |c: char| c.to_digit(10).map_or('⁻', |digit| digits[digit as usize]);
    exponent.chars().map(raised).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_digits_everywhere() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (0.11349, "0.113"),
            (9.996, "10.0"),
            (99.96, "100"),
            (-1.5, "−1.50"),
            (2414.135, "2414"),
            (0.0012345, "0.00123"),
            (1.2345e-5, "1.23·10⁻⁵"),
            (-123_456.0, "−1.23·10⁵"),
            (f64::INFINITY, "∞"),
            (f64::NAN, "undefined"),
        ];
        for (x, expected) in cases {
            assert_eq!(number(x), expected);
        }
    }

    #[test]
    fn a_tick_has_the_decimals_of_its_step() {
        let cases = [
            (-1e-17, 0.1, "0.0"),
            (0.30000000000000004, 0.1, "0.3"),
            (-20.0, 10.0, "−20"),
            (0.25, 0.05, "0.25"),
            (2e-5, 1e-5, "2.00·10⁻⁵"),
            (1e-21, 1e-5, "0"),
        ];
        for (value, step, expected) in cases {
            assert_eq!(tick_label(value, step), expected);
        }
    }
}
