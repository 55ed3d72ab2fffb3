//! By how much rounding may have moved the values of a recording: to a step, or to so many significant digits.

/// By how much a rounded value may be off, of what it was rounded to.
const HALF: f64 = 0.51;
/// Steps finer than this part of the span come of the arithmetic of programs, and are none.
const NO_STEP: f64 = 1e-9;
/// Part of the span by which any value may be off, however fine the step is.
const FINEST: f64 = 1e-6;
/// A number of so many digits is whole within this.
const WHOLE: f64 = 1e-6;
/// The coarsest step, of the span, that is taken for rounding, and not for levels at which an actuator was driven.
const COARSEST: f64 = 1e-3;
/// Significant digits that programs keep at least.
const DIGITS: i32 = 5;
/// Values among which the least step is looked for; more of them say nothing new.
const ENOUGH: usize = 20_000;

/// By how much values that were rounded to one step may be off. Values next to each other in size are compared, which
/// in a thinned recording are nearer than those next to each other in time.
pub fn step(values: &[f64]) -> f64 {
    let every = values.len() / ENOUGH + 1;
    let mut sorted: Vec<f64> = values.iter().copied().step_by(every).filter(|value| value.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let span = sorted.last().zip(sorted.first()).map_or(0.0, |(high, low)| high - low);
    let steps = sorted.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > NO_STEP * span);
    HALF * steps.fold(COARSEST * span, f64::min) + FINEST * span
}

/// How one series of two recordings may have been rounded in either.
pub struct Rounding {
    /// By how much a value may be off where it was rounded to a step.
    step: f64,
    /// Whether all values of either have few significant digits.
    digits: bool,
}

impl Rounding {
    /// Of values, and of some others that may be off by `step`.
    pub fn of(values: &[f64], others: &[f64], step_of_others: f64) -> Self {
        let digits = [values, others].iter().any(|values| values.iter().all(|value| has_few_digits(*value)));
        Self { step: step(values).max(step_of_others), digits }
    }

    /// Whether two values may be the same one, rounded.
    pub fn allows(&self, one: f64, other: f64) -> bool {
        (one - other).abs() <= self.at(one, other)
    }

    /// By how much two values may differ where one is the other, rounded.
    fn at(&self, one: f64, other: f64) -> f64 {
        let digit = if self.digits { HALF * last_digit(one.abs().max(other.abs())) } else { 0.0 };
        self.step.max(digit)
    }
}

/// Whether a value has no more significant digits than programs keep; one that is none has few.
fn has_few_digits(value: f64) -> bool {
    let digits = value / last_digit(value);
    !value.is_finite() || value == 0.0 || (digits - digits.round()).abs() < WHOLE
}

/// What the last significant digit of a value counts.
fn last_digit(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { 10f64.powi(value.abs().log10().floor() as i32 + 1 - DIGITS) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_step_is_found_among_values_far_apart_and_beside_bridged_ones() {
        let levels: Vec<f64> = (0..400).map(|k| f64::from(k % 4) * 10.0).collect();
        let found = step(&levels);
        assert!(found < 0.02, "levels at which it was driven are no rounding, {found}");
        let fine: Vec<f64> = (0..5000).map(|k| f64::from(k * 37 % 5003) * 1e-3).collect();
        let found = step(&fine);
        assert!((found - HALF * 1e-3).abs() < 1e-5, "{found}");
        let off_by_arithmetic: Vec<f64> = fine.iter().chain(&[1.0 + 1e-12]).copied().collect();
        assert!((step(&off_by_arithmetic) - found).abs() < 1e-9);
        assert_eq!(step(&[]), 0.0);
    }

    #[test]
    fn few_digits_are_told_from_more() {
        for few in [0.0, 12.345, -0.001_234_5, 99_999.0, 1000.0, f64::NAN] {
            assert!(has_few_digits(few), "{few}");
        }
        assert!(!has_few_digits(12.345_6) && !has_few_digits(250.123));
        let rounding = Rounding { step: 0.0, ..Rounding::of(&[12.345, 0.5], &[12.345_4], 0.0) };
        assert!(rounding.allows(12.345, 12.345_4) && !rounding.allows(12.345, 12.346));
        let whole = Rounding::of(&[12.345_1, 12.345_2], &[12.345_4, 12.345_6], 0.0);
        assert!(!whole.allows(12.345_1, 12.345_4));
    }
}
