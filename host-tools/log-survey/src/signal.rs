//! Numbers of a signal that outliers do not decide, and how far two go together.

use crate::deadband::noise_of;
use recordings::session::Session;

/// One value in so many is left out of a range, at either end: a single spike is no movement.
const RARE: usize = 100;

/// Between the first and the last hundredth of the sorted values; 0 of none.
pub fn range(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let rare = sorted.len() / RARE;
    match (sorted.get(rare), sorted.iter().rev().nth(rare)) {
        (Some(low), Some(high)) => high - low,
        _ => 0.0,
    }
}

/// Correlation of voltage and displacement at the measured instants, −1 … 1; 0 where one of them rests.
pub fn correlation(session: &Session) -> f64 {
    let pairs = session.instants.iter().zip(&session.displacement);
    let pairs = pairs.map(|(&instant, &displacement)| (session.voltage[instant as usize], displacement));
    let count = session.instants.len().max(1) as f64;
    let (v, y) = pairs.clone().fold((0.0, 0.0), |(v, y), pair| (v + pair.0 / count, y + pair.1 / count));
    let [vv, vy, yy] = pairs.fold([0.0; 3], |[vv, vy, yy], pair| {
        let (dv, dy) = (pair.0 - v, pair.1 - y);
        [vv + dv * dv, vy + dv * dy, yy + dy * dy]
    });
    if vv * yy > 0.0 { vy / (vv * yy).sqrt() } else { 0.0 }
}

/// The range of noise is less than so many of its standard deviations: nine in ten thousand of a normal distribution's lie beyond.
const DEVIATIONS: f64 = 6.0;
/// What goes with the voltage correlates with it by more than this, one way or the other.
const GOES_WITH: f64 = 0.5;

/// Whether the displacement is noise alone, which does not go with the voltage.
pub fn is_noise(session: &Session) -> bool {
    let noise = noise_of(&session.displacement).unwrap_or(0.0);
    range(&session.displacement) < DEVIATIONS * noise && correlation(session).abs() < GOES_WITH
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_leaves_the_rarest_out_and_a_correlation_has_the_sign_of_the_slope() {
        let mut values: Vec<f64> = (0..1000).map(f64::from).collect();
        values[500] = 1e6;
        assert_eq!(range(&values), 980.0);
        assert_eq!(range(&[]), 0.0);
        let of = |slope: f64| {
            let voltage: Vec<f64> = (0..20).map(f64::from).collect();
            let displacement = voltage.iter().map(|v| slope * v).collect();
            correlation(&Session::new("".into(), voltage, (0..20).collect(), displacement, 5e-4))
        };
        assert!((of(2.0) - 1.0).abs() < 1e-12 && (of(-0.1) + 1.0).abs() < 1e-12 && of(0.0) == 0.0);
    }
}
