//! The ends of an ADC's range. A code at one says so in the status of its tick; codes near one, for
//! [`crate::watch::SATURATED`] ticks, are a fault, and a set-point near one is not followed.

use core::ops::Range;
use estimator_core::AdcCode;

/// This part of the range at either end is too near the end: an amplifier in front of the ADC, or an offset of its own,
/// may keep a saturated input from its very last code.
pub const MARGIN: u16 = 128;

/// The ends of an ADC's range.
#[derive(Clone, Debug)]
pub struct Ends {
    full_scale: u16,
    good_codes: Range<u16>,
}

impl Ends {
    /// Of an ADC with this largest code.
    pub fn new(full_scale: u16) -> Self {
        let margin = full_scale / MARGIN;
        Self { full_scale, good_codes: margin + 1..full_scale - margin }
    }

    /// Whether a code is one of them.
    #[inline]
    pub fn at(&self, AdcCode(code): AdcCode) -> bool {
        code == 0 || code >= self.full_scale
    }

    /// Whether a code is too near one of them to be believed.
    #[inline]
    pub fn near(&self, AdcCode(code): AdcCode) -> bool {
        !self.good_codes.contains(&code)
    }
}
