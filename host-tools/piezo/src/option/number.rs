//! Numbers of options, refused where they make no sense.

use ::calibration::span::Span;
use recordings::prepare::AutoOr;
use std::num::{IntErrorKind, ParseIntError};
use std::str::FromStr;

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    let comma = text.contains(',') && text.replace(',', ".").parse::<f64>().is_ok();
    let wrong = || if comma { "a decimal point is a point" } else { "expected a finite number, without a unit" };
    text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(|| wrong().to_owned())
}

/// A finite number that is 0 or positive.
pub fn not_negative(text: &str) -> Result<f64, String> {
    finite(text).and_then(|x| if x < 0.0 { Err("must not be negative".to_owned()) } else { Ok(x) })
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    finite(text).and_then(|x| if x > 0.0 { Ok(x) } else { Err("must be above 0".to_owned()) })
}

/// A whole number of at least 1; `else_` says what comes of no number at all.
pub fn count<T: FromStr<Err = ParseIntError>>(text: &str, else_: &str) -> Result<T, String> {
    let is_0 = text.parse() == Ok(0u64);
    match text.parse() {
        Ok(number) if !is_0 => Ok(number),
        Err(error) if *error.kind() == IntErrorKind::PosOverflow => {
            Err(format!("expected a whole number of at most {}", u64::MAX >> (64 - 8 * size_of::<T>())))
        }
        _ => Err(format!("expected a whole number of at least 1{else_}")),
    }
}

/// What a converter's ends stand for, or a range: `-22:22`.
pub fn span(text: &str) -> Result<Span, String> {
    let wrong = |_| "expected two numbers, as -22:22".to_owned();
    let (zero, full) = text.split_once(':').ok_or(()).map_err(wrong)?;
    let number = |text: &str| finite(text).map_err(|_| ()).map_err(wrong);
    let span = Span { zero: number(zero)?, full: number(full)? };
    if span.zero == span.full { Err("the two ends must differ".to_owned()) } else { Ok(span) }
}

/// A time and where the actuator is then: `24:-91.5`.
pub fn zero(text: &str) -> Result<(f64, f64), String> {
    let (at_s, um) = text.split_once(':').ok_or("expected a time and a displacement, as 24:-91.5")?;
    Ok((not_negative(at_s)?, finite(um)?))
}

/// A finite number, or `auto`.
pub fn auto_or(text: &str) -> Result<AutoOr, String> {
    match text {
        "auto" => Ok(AutoOr::Auto),
        _ => finite(text).map(AutoOr::Given),
    }
}

/// A sensor's delay, ms.
pub fn delay(text: &str) -> Result<f64, String> {
    match finite(text)? {
        ms if ms < 0.0 => Err("a sensor cannot show what has not happened".to_owned()),
        ms if ms >= 1e3 => Err("expected milliseconds, less than a second".to_owned()),
        ms => Ok(ms),
    }
}

/// The same, or `auto`.
pub fn delay_or_auto(text: &str) -> Result<AutoOr, String> {
    if text == "auto" { Ok(AutoOr::Auto) } else { delay(text).map(AutoOr::Given) }
}

/// A factor that leaves something.
pub fn factor(text: &str) -> Result<f64, String> {
    if text.contains(':') {
        return Err("expected one number: for 1:20 it is 20".to_owned());
    }
    finite(text).and_then(|x| if x == 0.0 { Err("a scale of 0 leaves nothing".to_owned()) } else { Ok(x) })
}

/// A multiple of the stroke for `--limit`.
pub fn limit(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(limit) if limit > 1.0 && limit <= 100.0 => Ok(limit),
        _ => Err("expected a number above 1, at most 100".to_owned()),
    }
}

/// A number from 0 to 1.
pub fn fraction(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("expected a number from 0 to 1".to_owned()),
    }
}

/// A number of chromosomes.
pub fn even(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(n) if n % 2 == 0 && (2..=100_000).contains(&n) => Ok(n),
        _ => Err("expected an even number from 2 to 100000".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fraction_lies_between_0_and_1() {
        assert!(["1.01", "-0.1", "nan"].iter().all(|text| fraction(text).is_err()) && fraction("0.5").is_ok());
    }

    #[test]
    fn a_span_has_two_ends_that_differ() {
        for text in ["", "1", "1:1", "1:x", "nan:1", "1:inf"] {
            assert!(span(text).is_err(), "{text}");
        }
        assert_eq!(span("-22:22"), Ok(Span { zero: -22.0, full: 22.0 }));
    }
}
