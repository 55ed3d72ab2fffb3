//! A board's converters: what they make of a value by their steps and by their integral nonlinearity.

use estimator_core::Range;
use std::f64::consts::TAU;

/// Codes of twelve bits.
const CODES: f64 = 4095.0;
/// Parts of a code that oversampling tells apart in the ADC, and noise shaping in the DAC.
const PARTS: f64 = 16.0;
/// Integral nonlinearity of the ADC, codes of twelve bits: about the most that data sheets of microcontrollers state.
/// How it lies over the range none says.
pub const ADC_INL_CODES: f64 = 2.0;
/// The same of the DAC.
pub const DAC_INL_CODES: f64 = 4.0;

/// A converter with ideal ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Converter {
    range: Range<f64>,
    steps: f64,
    inl: f64,
}

impl Converter {
    /// The board's ADC over a range, oversampled sixteenfold.
    pub fn adc(range: Range<f64>) -> Self {
        Self { range, steps: CODES * PARTS, inl: ADC_INL_CODES / CODES }
    }

    /// The board's DAC over a range, with its noise shaping and a low-pass behind it.
    pub fn dac(range: Range<f64>) -> Self {
        Self { range, steps: CODES * PARTS, inl: DAC_INL_CODES / CODES }
    }

    /// The same with so much of its nonlinearity; a negative part bends the other way.
    #[must_use]
    pub fn of_nonlinearity(self, part: f64) -> Self {
        Self { inl: part * self.inl, ..self }
    }

    /// What is made of a value: the nearest step, bent.
    pub fn through(&self, value: f64) -> f64 {
        let at = (self.range.clamp(value) - self.range.min) / self.range.span();
        self.bent(self.range.min + self.range.span() * (at * self.steps).round() / self.steps)
    }

    /// What a whole wave of the nonlinearity over the range makes of a value, where the steps are somebody else's.
    pub fn bent(&self, value: f64) -> f64 {
        let at = (value - self.range.min) / self.range.span();
        value + self.range.span() * self.inl * libm::sin(TAU * at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_off_by_half_a_step_and_the_nonlinearity_and_the_ends_by_nothing() {
        let range = Range { min: -20.0, max: 30.0 };
        let code = range.span() / CODES;
        for converter in [Converter::adc(range), Converter::dac(range)] {
            let most = (0.5 / converter.steps + converter.inl) * range.span();
            let off = (0..=5000)
                .map(|k| range.min + 0.01 * f64::from(k))
                .map(|value| (converter.through(value) - value).abs());
            let largest = off.fold(0.0, f64::max);
            assert!(largest <= most + 1e-9 && largest > converter.inl * range.span() - code, "{largest} of {most}");
            assert!([range.min, range.max].iter().all(|end| (converter.through(*end) - end).abs() < 1e-9));
        }
        assert_eq!(Converter::adc(range).through(31.0), range.max);
    }
}
