//! What a board has seen that has been running before a recording: the whole range, and a rest, at which the
//! displacement is told.

use estimator_core::Range;

/// From one voltage to another it goes in so long, s.
const RAMP_S: f64 = 0.4;

/// The voltages from a rest to both ends of a range, back to the rest, which lasts for `rested_s`, and on to another
/// voltage, V a tick of `tick_s` seconds; and the tick at which the rest ends.
pub fn lead_in(rest: f64, to: f64, range: Range<f64>, rested_s: f64, tick_s: f64) -> (Vec<f64>, usize) {
    let ticks = |s: f64| ((s / tick_s) as usize).max(1);
    let ramp = |[from, to]: [f64; 2]| {
        let ticks = ticks(RAMP_S);
        (0..ticks).map(move |k| from + (to - from) * k as f64 / ticks as f64)
    };
    let swing = [[rest, range.min], [range.min, range.max], [range.max, rest]].into_iter().flat_map(ramp);
    let mut voltage: Vec<f64> = swing.chain(std::iter::repeat_n(rest, ticks(rested_s))).collect();
    let ends = voltage.len();
    voltage.extend(ramp([rest, to]));
    (voltage, ends)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_goes_over_the_range_rests_and_goes_on() {
        let range = Range { min: -1.0, max: 3.0 };
        let (voltage, ends) = lead_in(0.5, 2.0, range, 1.0, 0.001);
        assert_eq!(Range::of_values(voltage.iter().copied()), range);
        assert_eq!((voltage.len(), ends), (4 * 400 + 1000, 3 * 400 + 1000));
        assert!(voltage[1200..=ends].iter().all(|&at| at == 0.5));
        assert!(voltage.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.02) && voltage[voltage.len() - 1] > 1.99);
    }
}
