//! What a board has seen that has been running before a recording: the whole range, and a rest, at which the displacement is told.

use estimator_core::Range;

/// From one voltage to another it goes in so long, and it then rests for so long, s.
const WAY_S: f64 = 0.4;
const RESTS_S: f64 = 1.0;

/// The voltages from a rest to both ends of a range and back to the rest, V a tick of `tick_s` seconds.
pub fn lead_in(rest: f64, range: Range<f64>, tick_s: f64) -> Vec<f64> {
    let ticks = |s: f64| ((s / tick_s) as usize).max(1);
    let way = |[from, to]: [f64; 2]| {
        let ticks = ticks(WAY_S);
        (0..ticks).map(move |k| from + (to - from) * k as f64 / ticks as f64)
    };
    let swing = [[rest, range.min], [range.min, range.max], [range.max, rest]];
    swing.into_iter().flat_map(way).chain(std::iter::repeat_n(rest, ticks(RESTS_S))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_over_the_range_and_rests() {
        let range = Range { min: -1.0, max: 3.0 };
        let voltage = lead_in(0.5, range, 0.001);
        assert_eq!(Range::of_values(voltage.iter().copied()), range);
        assert_eq!(voltage.len(), 3 * 400 + 1000);
        assert!(voltage[0] == 0.5 && voltage[1200..].iter().all(|&at| at == 0.5));
        assert!(voltage.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02));
    }
}
