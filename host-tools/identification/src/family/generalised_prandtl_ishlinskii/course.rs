//! Which ticks of a session a candidate is stepped at: where a reading counts and, where readings between are passed over, at
//! the voltage's corners, too: those of a polyline that the voltage leaves by no more than a deadband. From one such tick to the
//! next the voltage runs straight, as every stage takes it to; passed over, a reversal would leave its loop too narrow.

use crate::settled::settled;
use recordings::session::Session;
use std::ops::RangeInclusive;

/// Most readings that count, of all sessions; of more, every n-th.
const READINGS: usize = 10_000;
/// Most of one session, which may have the fewest however many sessions there are.
const OF_ONE: RangeInclusive<usize> = 1_000..=5_000;

/// The way through a session.
pub struct Course {
    /// The measured instants, by their index, that count.
    pub readings: Vec<usize>,
    /// Ticks of the voltage's corners; none where every reading counts.
    pub corners: Vec<u32>,
    /// Index of the first instant that the session's start does not reach.
    pub settled: usize,
}

impl Course {
    /// Of each of some sessions, with corners by a deadband (V).
    pub fn of_all<'a>(sessions: impl Iterator<Item = &'a Session> + Clone, deadband: f64) -> Vec<Self> {
        let most = (READINGS / sessions.clone().count().max(1)).clamp(*OF_ONE.start(), *OF_ONE.end());
        sessions.map(|session| Self::within(most, session, deadband)).collect()
    }

    /// Of a session, with at most so many readings, but for those of its start.
    pub fn within(most: usize, session: &Session, deadband: f64) -> Self {
        let settled = settled(session);
        let stride = session.instants.len().div_ceil(most).max(1);
        let counts = |index: &usize| index.is_multiple_of(stride) || (*index < settled && settled < most);
        let corners = if stride > 1 { corners(&session.voltage, deadband) } else { Vec::new() };
        Self { readings: (0..session.instants.len()).filter(counts).collect(), corners, settled }
    }
}

/// Ticks between which a voltage (V) stays within `deadband` (V) of a straight line through its first: the swinging door of
/// process historians (Bristol, Swinging Door Trending, 1990).
fn corners(voltage: &[f64], deadband: f64) -> Vec<u32> {
    let mut found = Vec::new();
    let mut anchor = 0;
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for tick in 1..voltage.len() {
        let slope = |volts: f64, anchor: usize| (volts - voltage[anchor]) / (tick - anchor) as f64;
        let door = |anchor| (slope(voltage[tick] - deadband, anchor), slope(voltage[tick] + deadband, anchor));
        let (low, high) = door(anchor);
        (least, most) = (f64::max(least, low), f64::min(most, high));
        if least > most {
            anchor = tick - 1;
            found.push(anchor as u32);
            (least, most) = door(anchor);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_are_where_a_voltage_turns_leaps_or_bends_and_nowhere_else() {
        let triangle: Vec<f64> = (0..400).map(|k| f64::from((k % 200_i32 - 100).abs()) * 0.5).collect();
        assert_eq!(corners(&triangle, 0.01), [100, 200, 300]);
        let noisy: Vec<f64> =
            triangle.iter().enumerate().map(|(k, v)| v + if k % 2 == 0 { 0.04 } else { 0.0 }).collect();
        let found = corners(&noisy, 0.1);
        assert!((3..8).contains(&found.len()), "{found:?}");
        let leap: Vec<f64> = (0..50).map(|k| if k < 20 { 1.0 } else { 3.0 }).collect();
        assert_eq!(corners(&leap, 0.1), [19, 20]);
        let arc: Vec<f64> = (0..1000).map(|k| 10.0 * libm::sin(f64::from(k) * 6.283e-3)).collect();
        let found = corners(&arc, 0.1);
        assert!((5..20).contains(&found.len()), "{found:?}");
        assert!(corners(&[], 0.1).is_empty() && corners(&[7.0], 0.1).is_empty());
    }
}
