//! Units that are unlike the rest of their fleet.
//!
//! The logarithm of a quantity is compared with the median of all; the spread is 1.4826 times the median distance from
//! it, which is a normal distribution's standard deviation and which no few outliers move. Farther than 3.5 of these is
//! far (Iglewicz and Hoaglin, *How to Detect and Handle Outliers*, 1993), and so is nothing within 20 %: a fleet that
//! is alike would have its hairs split.

use serde::Serialize;
use std::fmt;

/// Fewer units than this have no spread.
pub const ENOUGH: usize = 5;
/// Spreads beyond which one is far.
const FAR: f64 = 3.5;
/// Of a normal distribution: its standard deviation, as a multiple of the median distance from its median.
const NORMAL: f64 = 1.4826;
/// What is within this factor of the median is like it.
const ALIKE: f64 = 1.2;

/// What of a unit's table is compared with the fleet's median.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Mean absolute error on what was held out, % of the stroke.
    ErrorPercent,
    /// Least half-width of the interval, % of the stroke.
    HalfWidthPercent,
    /// Stroke of the training, µm.
    StrokeUm,
}

impl Quantity {
    /// Every quantity, in the order in which they are told.
    pub const ALL: [Self; 3] = [Self::ErrorPercent, Self::HalfWidthPercent, Self::StrokeUm];

    /// A value of it, in words.
    pub fn said(self, value: f64) -> String {
        match self {
            Self::ErrorPercent | Self::HalfWidthPercent => format!("{value:.2} % of the stroke"),
            Self::StrokeUm => format!("{value:.2} µm"),
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::ErrorPercent => "held-out error",
            Self::HalfWidthPercent => "±",
            Self::StrokeUm => "stroke",
        })
    }
}

/// A unit that is far from the rest in something.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Outlier {
    /// Name of the unit.
    pub unit: String,
    /// What it is far off in.
    pub quantity: Quantity,
    /// The unit's value, in the quantity's unit.
    pub value: f64,
    /// The fleet's median.
    pub median: f64,
}

/// Those of some units with their values of a quantity that are far from the rest; none of a few.
pub(crate) fn outliers(quantity: Quantity, units: &[(String, f64)]) -> Vec<Outlier> {
    let logarithms: Vec<f64> = units.iter().filter(|(_, value)| *value > 0.0).map(|(_, value)| value.ln()).collect();
    if logarithms.len() < ENOUGH {
        return Vec::new();
    }
    let middle = median(&logarithms);
    let spread = NORMAL * median(&logarithms.iter().map(|x| (x - middle).abs()).collect::<Vec<_>>());
    let far = |value: f64| value > 0.0 && (value.ln() - middle).abs() > (FAR * spread).max(ALIKE.ln());
    let outlier =
        |(unit, value): &(String, f64)| Outlier { unit: unit.clone(), quantity, value: *value, median: middle.exp() };
    units.iter().filter(|(_, value)| far(*value)).map(outlier).collect()
}

/// The median of some numbers; not a number of none.
pub(crate) fn median(of: &[f64]) -> f64 {
    let mut sorted = of.to_vec();
    sorted.sort_by(f64::total_cmp);
    let middle = sorted.len() / 2;
    match (sorted.get(middle), sorted.len() % 2) {
        (Some(upper), 0) => 0.5 * (sorted[middle - 1] + upper),
        (Some(middle), _) => *middle,
        (None, _) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn far(values: &[f64]) -> Vec<f64> {
        let units: Vec<_> = values.iter().map(|&value| (format!("SN{value}"), value)).collect();
        outliers(Quantity::ErrorPercent, &units).iter().map(|outlier| outlier.value).collect()
    }

    #[test]
    fn one_that_is_far_is_named_either_way_and_hides_no_other() {
        assert_eq!(far(&[0.19, 0.2, 0.21, 0.22, 0.2, 1.9]), [1.9]);
        assert_eq!(far(&[0.19, 0.2, 0.21, 0.22, 0.2, 0.02]), [0.02]);
        assert_eq!(far(&[0.19, 0.2, 0.21, 0.22, 0.2, 0.18, 0.23, 1.9, 40.0]), [1.9, 40.0]);
    }

    #[test]
    fn what_scatters_has_no_outlier_and_a_fleet_that_is_alike_none_within_a_fifth() {
        assert_eq!(far(&[0.1, 0.2, 0.4, 0.3, 0.15, 0.6]), [0.0; 0]);
        assert_eq!(far(&[0.2, 0.2, 0.2, 0.2, 0.2, 0.23]), [0.0; 0]);
        assert_eq!(far(&[0.2, 0.2, 0.2, 0.2, 0.2, 0.25]), [0.25]);
    }

    #[test]
    fn of_four_none_is_far_and_an_error_of_nothing_is_no_logarithm() {
        assert_eq!(far(&[0.2, 0.2, 0.2, 9.0]), [0.0; 0]);
        assert_eq!(far(&[0.0, 0.2, 0.2, 0.2, 0.2, 0.2, 9.0]), [9.0]);
    }

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&[]).is_nan());
    }
}
