//! What is drawn of a long log: no more points than the eye can tell apart, and every extreme of them.

use log_survey::reversals::reversals;
use std::ops::RangeInclusive;

/// A point of a line, in the data's units.
pub type Point = (f64, f64);

/// At most `limit` points (at least 4) of a line: first, last, lowest and highest of each stretch. For a line over time
/// that is the M4 aggregation (Jugel et al., VLDB 2014), which hardly differs from drawing all points. Points that are
/// not finite are left out.
pub fn thin(points: impl IntoIterator<Item = Point>, limit: usize) -> Vec<Point> {
    let points: Vec<Point> = points.into_iter().filter(|(x, y)| x.is_finite() && y.is_finite()).collect();
    if points.len() <= limit {
        return points;
    }
    let stretch = points.len().div_ceil((limit / 4).max(1));
    let mut thinned = Vec::with_capacity(limit);
    for stretch in points.chunks(stretch) {
        let lowest = extreme(stretch, |a, b| a < b);
        let highest = extreme(stretch, |a, b| a > b);
        let mut kept = [0, lowest.min(highest), lowest.max(highest), stretch.len() - 1].to_vec();
        kept.dedup();
        thinned.extend(kept.into_iter().map(|i| stretch[i]));
    }
    thinned
}

/// From one instant to the next by more than so many times the middle of all is a gap: nothing is drawn over it.
const GAP: f64 = 3.0;

/// The first index behind each gap of some instants, s.
pub fn gaps(time_s: &[f64]) -> Vec<usize> {
    let mut apart: Vec<f64> = time_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = apart.len() / 2;
    if apart.is_empty() {
        return Vec::new();
    }
    let longest = GAP * *apart.select_nth_unstable_by(middle, f64::total_cmp).1;
    (1..time_s.len()).filter(|&index| time_s[index] - time_s[index - 1] > longest).collect()
}

/// Fewest points of a line that are drawn of what lies between two gaps.
pub const OF_A_PIECE: usize = 8;

/// What lies between gaps, of values from an index `first` on.
pub fn pieces<'v, T>(mut values: &'v [T], first: usize, gaps: &[usize]) -> Vec<&'v [T]> {
    let mut pieces = Vec::new();
    let mut from = first;
    for &gap in gaps.iter().filter(|gap| (first + 1..first + values.len()).contains(gap)) {
        let (piece, rest) = values.split_at(gap - from);
        pieces.push(piece);
        (values, from) = (rest, gap);
    }
    pieces.push(values);
    pieces
}

fn extreme(points: &[Point], beyond: fn(f64, f64) -> bool) -> usize {
    (1..points.len()).fold(0, |best, i| if beyond(points[i].1, points[best].1) { i } else { best })
}

/// Retreat that counts as a reversal here, as a fraction of the span: above any sensible noise.
const RETREAT: f64 = 0.02;

/// Where a voltage turns, seen by itself.
pub fn turns(voltage: &[f64]) -> Vec<usize> {
    reversals(voltage, retreat(voltage.iter().copied(), 0.0))
}

/// Retreat that counts as a reversal among some voltages: what is none beside all of them, or within the
/// deadband, is noise.
pub fn retreat(voltages: impl IntoIterator<Item = f64>, deadband: f64) -> f64 {
    let span = extent(voltages).map_or(0.0, |(min, max)| max - min);
    deadband.max(RETREAT * span)
}

/// The stretch of a log that is shown in detail: its last two periods and what follows, all of it where it has fewer.
pub fn last_periods(voltage: &[f64]) -> RangeInclusive<usize> {
    let turns = turns(voltage);
    let start = turns.len().checked_sub(5).map_or(0, |i| turns[i]);
    start..=voltage.len().saturating_sub(1)
}

/// A log's periods, from one reversal to the next but one, each ending where the next begins.
pub fn periods(voltage: &[f64]) -> Vec<RangeInclusive<usize>> {
    let mut ends = vec![0];
    ends.extend(turns(voltage).into_iter().step_by(2).filter(|&i| i > 0));
    ends.push(voltage.len().saturating_sub(1));
    ends.windows(2).map(|pair| pair[0]..=pair[1]).collect()
}

/// Smallest and largest of the values that are finite and of a size that can be drawn.
pub fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    let drawable = values.into_iter().filter(|x| x.abs() < 1e12);
    drawable.fold(None, |extent, x| Some(extent.map_or((x, x), |(min, max): (f64, f64)| (min.min(x), max.max(x)))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine(samples: usize, periods: f64) -> Vec<f64> {
        (0..samples).map(|k| (std::f64::consts::TAU * periods * k as f64 / samples as f64).sin()).collect()
    }

    #[test]
    fn thinning_keeps_ends_and_extremes() {
        let mut y = sine(40_000, 37.3);
        (y[12_345], y[23_456], y[30_000]) = (9.0, -8.0, f64::NAN);
        let thinned = thin(y.iter().enumerate().map(|(k, &y)| (k as f64, y)), 1000);
        assert!(thinned.len() <= 1000 && thinned.len() > 500);
        assert!(thinned.contains(&(12_345.0, 9.0)) && thinned.contains(&(23_456.0, -8.0)));
        assert_eq!((thinned[0].0, thinned[thinned.len() - 1].0), (0.0, 39_999.0));
        assert!(thinned.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }

    #[test]
    fn nothing_is_drawn_over_a_gap() {
        let time_s: Vec<f64> = (0..100).filter(|k| k % 40 < 30).map(|k| f64::from(k) * 1e-3).collect();
        let gaps = gaps(&time_s);
        assert_eq!(gaps, [30, 60]);
        let of =
            |first: usize| pieces(&time_s[first..], first, &gaps).into_iter().map(<[f64]>::len).collect::<Vec<_>>();
        assert_eq!((of(0), of(30), of(31)), (vec![30, 30, 20], vec![30, 20], vec![29, 20]));
        assert_eq!(pieces(&time_s[..30], 0, &gaps).len(), 1);
        assert!(super::gaps(&[1.0]).is_empty() && super::gaps(&[0.0, 1.0, 2.0, 4.0]).is_empty());
    }

    #[test]
    fn what_is_short_stays() {
        let points = [(0.0, 1.0), (1.0, 2.0), (2.0, f64::INFINITY)];
        assert_eq!(thin(points, 100), [(0.0, 1.0), (1.0, 2.0)]);
        assert!(thin([], 100).is_empty());
    }

    #[test]
    fn a_sine_turns_twice_a_period_and_noise_does_not() {
        let noisy: Vec<f64> = sine(1000, 5.0).iter().enumerate().map(|(k, y)| y + 0.01 * (k % 2) as f64).collect();
        let turns = turns(&noisy);
        assert_eq!(turns.len(), 10);
        assert!(turns.iter().enumerate().all(|(n, &turn)| turn.abs_diff(50 + 100 * n) < 10), "{turns:?}");
        assert_eq!(last_periods(&noisy), turns[5]..=999);
        assert_eq!(periods(&noisy).len(), 6);
    }

    #[test]
    fn a_constant_or_empty_voltage_has_one_stretch() {
        assert_eq!(periods(&[3.0; 50]), [0..=49]);
        assert_eq!(last_periods(&[3.0; 50]), 0..=49);
        assert_eq!(periods(&[]), [0..=0]);
    }
}
