//! Values that resistors are sold in (IEC 60063).

use serde::Serialize;

/// E24's values in a decade; they do not follow the formula everywhere.
const E24: [f64; 24] = [
    1.0, 1.1, 1.2, 1.3, 1.5, 1.6, 1.8, 2.0, 2.2, 2.4, 2.7, 3.0, 3.3, 3.6, 3.9, 4.3, 4.7, 5.1, 5.6, 6.2, 6.8, 7.5, 8.2,
    9.1,
];
/// Smallest resistor that is tried, Ω, and how many decades from there.
const LEAST: f64 = 1e3;
const DECADES: i32 = 3;

/// A series of values.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
pub enum Series {
    /// 24 a decade.
    E24,
    /// 96 a decade: 10^(k/96) to three digits.
    E96,
}

impl Series {
    /// All values from 1 kΩ to 1 MΩ, Ω.
    pub fn values(self) -> Vec<f64> {
        let decade: Vec<f64> = match self {
            Self::E24 => E24.to_vec(),
            Self::E96 => (0..96).map(|k| (100.0 * 10f64.powf(f64::from(k) / 96.0)).round() / 100.0).collect(),
        };
        let decades = (0..DECADES).map(|decade| LEAST * 10f64.powi(decade));
        // Whole ohms, as they are printed.
        let values = decades.flat_map(|scale| decade.iter().map(move |value| (scale * value).round()));
        values.chain([LEAST * 10f64.powi(DECADES)]).collect()
    }
}

/// The value of E24 that is nearest to a resistance, Ω.
pub(crate) fn nearest(ohms: f64) -> f64 {
    let decade = 10f64.powf(ohms.log10().floor());
    let values = E24.iter().copied().chain([10.0]).map(|value| value * decade);
    values.min_by(|a, b| (a / ohms).ln().abs().total_cmp(&(b / ohms).ln().abs())).unwrap_or(ohms)
}

/// Ohms as they are printed on a bag of resistors.
pub fn ohms(ohms: f64) -> String {
    // Three digits are all that a value of a series has.
    let short = |x: f64| format!("{x:.3}").trim_end_matches('0').trim_end_matches('.').to_owned();
    match ohms {
        1e6.. => format!("{} MΩ", short(ohms / 1e6)),
        _ => format!("{} kΩ", short(ohms / 1e3)),
    }
}

/// A resistor's line in a list of what to buy.
pub(crate) fn part(name: &str, resistor: Option<f64>, between: &str) -> String {
    match resistor {
        Some(value) => format!("  {name} = {} {between}", ohms(value)),
        None => format!("  {name} is left out"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_values_are_those_of_the_shop() {
        let (e24, e96) = (Series::E24.values(), Series::E96.values());
        assert_eq!((e24.len(), e96.len()), (3 * 24 + 1, 3 * 96 + 1));
        assert!([4_700.0, 91_000.0, 1e6].iter().all(|value| e24.contains(value)));
        assert!([6_040.0, 8_660.0, 4_530.0, 66_500.0, 976_000.0].iter().all(|value| e96.contains(value)));
        assert_eq!([439e3, 101.0, 98_500.0, 1.0].map(nearest), [430e3, 100.0, 1e5, 1.0]);
        assert!([&e24, &e96].iter().all(|values| values.windows(2).all(|pair| pair[0] < pair[1])));
    }
}
