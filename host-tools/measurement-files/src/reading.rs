//! Which numbers of a file are readings.

use std::ops::RangeInclusive;

/// What instruments write for an overload where they speak SCPI: infinity is 9.9E37 there, and "not a number" 9.91E37
/// (SCPI 1999.0, volume 1, 7.2.1.4 and 7.2.1.5); in single precision, or printed with fewer digits, it is near that.
const OVERLOAD: RangeInclusive<f64> = 9.89e37..=9.92e37;

/// Whether a number is a reading, and not what stands for none: NaN, an infinity, or an instrument's overload.
pub(crate) fn is_reading(value: f64) -> bool {
    value.is_finite() && !OVERLOAD.contains(&value.abs())
}
