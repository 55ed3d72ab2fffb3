//! What a converter's ends stand for.

use std::str::FromStr;

/// What code 0 and what the full-scale code stand for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Span {
    /// At code 0.
    pub zero: f64,
    /// At full scale.
    pub full: f64,
}

impl FromStr for Span {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || "expected what code 0 and full scale stand for, as -22:22".to_owned();
        let (zero, full) = text.split_once(':').ok_or_else(wrong)?;
        let number = |text: &str| text.parse().ok().filter(|x: &f64| x.is_finite()).ok_or_else(wrong);
        let span = Self { zero: number(zero)?, full: number(full)? };
        if span.zero == span.full { Err("the two ends must differ".to_owned()) } else { Ok(span) }
    }
}
