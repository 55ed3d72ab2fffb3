//! Which resistors: all triples of a series are tried, and the one is taken that uses most of the converter's range.

use crate::series::Series;
use crate::{Divider, OUTPUT_PIN_V, PIN_V};

/// What the node's resistance may be, Ω: the source carries it, and the follower's input current does not show on it.
const IMPEDANCE: (f64, f64) = (2e3, 4.5e3);
/// The same use of the range, to within this part of it: then the node's resistance that is nearest to
/// the middle counts.
const AS_GOOD: f64 = 2e-3;

/// Why there is no divider.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum DividerError {
    /// The two voltages are one, or none.
    #[error("{0} and {1} V are no span: two voltages that differ are needed, the output's lowest and its highest")]
    NoSpan(f64, f64),
    /// No values of the series do it.
    #[error(
        "no three resistors of 1 kΩ to 1 MΩ bring {low} … {high} V to {} … {} V: it needs an amplifier, or a divider of its own, before the board",
        PIN_V.0,
        PIN_V.1
    )]
    None {
        /// Lowest voltage of the source, V.
        low: f64,
        /// Highest voltage of the source, V.
        high: f64,
    },
    /// No values make an output stage.
    #[error(
        "no resistors of 1 kΩ to 1 MΩ make {low} … {high} V of the pin's {} … {} V around one operational amplifier: no amplifier's input takes so much",
        OUTPUT_PIN_V.0,
        OUTPUT_PIN_V.1
    )]
    NoStage {
        /// Lowest voltage of the amplifier's input, V.
        low: f64,
        /// Highest voltage of the amplifier's input, V.
        high: f64,
    },
}

/// The lower of two voltages, V, and the higher.
///
/// # Errors
/// They are one, or not finite.
pub(crate) fn ordered(one: f64, other: f64) -> Result<(f64, f64), DividerError> {
    let (low, high) = (one.min(other), one.max(other));
    if low.is_finite() && high.is_finite() && low < high {
        Ok((low, high))
    } else {
        Err(DividerError::NoSpan(one, other))
    }
}

impl Divider {
    /// The resistors that bring the source's voltages, V, to within 0.15 … 3.15 V and use most of that.
    ///
    /// # Errors
    /// There are none.
    pub fn choose((one, other): (f64, f64), series: Series) -> Result<Self, DividerError> {
        let (low, high) = ordered(one, other)?;
        let values = series.values();
        let or_none = || values.iter().copied().map(Some).chain([None]);
        let mut best: Option<(f64, f64, Self)> = None;
        for &r1 in &values {
            for r2 in or_none() {
                // More resistors side by side are less.
                if (Self { r1, r2, r3: None }).impedance() < IMPEDANCE.0 {
                    continue;
                }
                for r3 in or_none() {
                    let divider = Self { r1, r2, r3 };
                    let impedance = divider.impedance();
                    let (least, most) = (divider.pin(low), divider.pin(high));
                    let fits = least >= PIN_V.0 && most <= PIN_V.1;
                    if !(fits && (IMPEDANCE.0..=IMPEDANCE.1).contains(&impedance)) {
                        continue;
                    }
                    let unused = 1.0 - (most - least) / (PIN_V.1 - PIN_V.0);
                    let askew = (impedance / (IMPEDANCE.0 * IMPEDANCE.1).sqrt()).ln().abs();
                    let steps = (unused / AS_GOOD).floor();
                    if best.is_none_or(|(other, skew, _)| (steps, askew) < (other, skew)) {
                        best = Some((steps, askew, divider));
                    }
                }
            }
        }
        best.map(|(.., divider)| divider).ok_or(DividerError::None { low, high })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_chosen_stays_within_the_pin_s_range_and_uses_it() {
        let spans = [(0.0, 10.0), (-10.0, 10.0), (-5.0, 5.0), (-3.0, 13.0), (1.0, 10.0), (0.0, 150.0), (-30.0, 130.0)];
        for span in spans {
            for (series, used) in [(Series::E24, 0.93), (Series::E96, 0.97)] {
                let divider = Divider::choose(span, series).unwrap();
                let (least, most) = (divider.pin(span.0), divider.pin(span.1));
                assert!(least >= PIN_V.0 && most <= PIN_V.1, "{span:?}: {least} … {most} V by {divider:?}");
                // Without a resistor that pulls down, a voltage that never comes near 0 leaves the lower end unused.
                let reachable = if span.0 > 0.5 { 0.9 * used } else { used };
                assert!(most - least >= reachable * 3.0, "{span:?}: {least} … {most} V by {divider:?}");
                let values = series.values();
                let all = [Some(divider.r1), divider.r2, divider.r3];
                assert!(all.into_iter().flatten().all(|r| values.contains(&r)), "{divider:?}");
            }
        }
    }

    /// Those of the book's table, which were found by its equations.
    #[test]
    fn it_is_as_good_as_the_book_s() {
        let of = |r1, r2, r3| Divider { r1, r2: Some(r2), r3: Some(r3) };
        let book = [
            ((-10.0, 10.0), of(20e3, 6.04e3, 8.66e3), (-10.9, 10.9)),
            ((-5.0, 5.0), of(10e3, 6.04e3, 15e3), (-5.5, 5.5)),
            ((0.0, 10.0), of(10e3, 66.5e3, 4.53e3), (-0.5, 10.6)),
        ];
        for (span, divider, (zero, full)) in book {
            let (at_zero, at_full) = divider.span();
            assert!((at_zero - zero).abs() < 0.1 && (at_full - full).abs() < 0.1, "{at_zero} … {at_full} V");
            let swing = |of: &Divider| of.pin(span.1) - of.pin(span.0);
            let chosen = Divider::choose(span, Series::E96).unwrap();
            // Those of ±10 V go 10 mV beyond the pin's range at either end; the next values are 2.4 % away.
            assert!(
                swing(&chosen) > 0.975 * swing(&divider),
                "{chosen:?}: {} V of {} V",
                swing(&chosen),
                swing(&divider)
            );
        }
    }

    #[test]
    fn a_small_monitor_does_without_the_third_and_uses_less() {
        let divider = Divider::choose((-2.0, 2.0), Series::E96).unwrap();
        assert!(divider.r3.is_none_or(|r3| r3 > 100e3), "{divider:?}");
        let swing = divider.pin(2.0) - divider.pin(-2.0);
        assert!((2.2..2.5).contains(&swing), "{swing} V");
        for none in [(1.0, 1.0), (0.0, f64::NAN)] {
            assert!(matches!(Divider::choose(none, Series::E24), Err(DividerError::NoSpan(..))));
        }
        // Of a monitor that is always negative and far from 0, R2 cannot lift both ends by so much and keep them apart.
        let far = Divider::choose((-2e4, -1e4), Series::E24);
        assert!(matches!(far, Err(DividerError::None { .. })), "{far:?}");
    }
}
