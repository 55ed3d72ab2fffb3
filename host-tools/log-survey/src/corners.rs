//! Where a voltage bends, where instants are missing, and how long a voltage stands still first: what a walk through a
//! session that does not stop at every tick needs to know.

use recordings::session::Session;
use std::ops::Range;

/// Ticks between which a voltage (V) stays within `deadband` (V) of a straight line through its first: the swinging
/// door of process historians (Bristol, Swinging Door Trending, 1990).
pub fn corners(voltage: &[f64], deadband: f64) -> Vec<u32> {
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

/// The corners at ticks between which instants are missing.
pub fn corners_left_out(voltage: &[f64], instants: &[u32], deadband: f64) -> Vec<u32> {
    let gaps = gaps(instants);
    if gaps.is_empty() {
        return Vec::new();
    }
    corners(voltage, deadband).into_iter().filter(|tick| within(&gaps, *tick)).collect()
}

/// Ticks between two instants that are farther apart than most are, because what was between them is left out.
fn gaps(instants: &[u32]) -> Vec<Range<u32>> {
    let mut apart: Vec<u32> = instants.windows(2).map(|pair| pair[1] - pair[0]).collect();
    apart.sort_unstable();
    let usual = apart.get(apart.len() / 2).copied().unwrap_or(0);
    // Of a log whose rates are no multiples, instants are one tick more or less apart.
    instants.windows(2).filter(|pair| pair[1] - pair[0] > usual + 1).map(|pair| pair[0]..pair[1]).collect()
}

/// Whether a tick is in one of these, which are in the order of time.
fn within(gaps: &[Range<u32>], tick: u32) -> bool {
    gaps.get(gaps.partition_point(|gap| gap.end <= tick)).is_some_and(|gap| gap.contains(&tick))
}

/// How long a session's voltage stays within a deadband (V) of its first, s.
pub fn stands_still_s(session: &Session, deadband: f64) -> f64 {
    let first = session.voltage.first().copied().unwrap_or(0.0);
    session.voltage.iter().take_while(|volts| (**volts - first).abs() <= deadband).count() as f64 * session.tick_s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten swings, of which two are left out: what is passed over is gone through, and nothing else.
    #[test]
    fn what_is_left_out_is_gone_through_by_its_corners() {
        let voltage: Vec<f64> = (0..1_000).map(|k| f64::from((k % 100_i32 - 50).abs())).collect();
        let measured = |left_out: Range<u32>| -> Vec<u32> {
            (0..1_000).step_by(2).filter(|tick| !left_out.contains(tick)).collect()
        };
        assert_eq!(corners_left_out(&voltage, &measured(400..600), 0.1), [400, 450, 500, 550]);
        assert!(corners_left_out(&voltage, &measured(0..0), 0.1).is_empty());
    }

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
