//! The sample period of a log, and the proof that its time stamps keep it.
//!
//! The period is the slope of the line of least squares through all time stamps, never one step; a whole-hertz rate
//! that the stamps cannot tell from it is taken instead, where their steps differ: 134 stamps exactly 1.5 ms apart are
//! no rounded ones of 667 Hz.

use super::channels::Channels;
use super::error::PlacedFault;
use super::fault::Fault;
use super::number::Number;
use super::recording::Recording;
use super::resolution::{coarsest, resolution};
use super::steps::{self, Line};
use measurement_files::{Quantity, SampleTime, Unit, excerpt};

/// Tolerated deviation of a stated sample rate from the time column's, as a part of it.
const RATE_TOLERANCE: f64 = 1e-3;
/// What a step may differ from the others, of the last digit, where none of them is rounded.
const EVEN: f64 = 1e-3;
/// Sample periods outside this range are taken for a wrong unit, s.
const PERIODS: std::ops::RangeInclusive<f64> = 1e-7..=10.0;

/// Refuses a stated sample rate (Hz) that is not finite or outside 0.1 Hz to 10 MHz.
pub(super) fn check_rate(rate: f64) -> Result<(), Fault> {
    if PERIODS.contains(&(1.0 / rate)) { Ok(()) } else { Err(Fault::SampleRate(rate)) }
}

/// Sample period (s) from the time column, which must hold at least two rows, else from the stated rate (Hz).
pub(super) fn sample_period(recording: &Recording, stated_rate: Option<f64>) -> Result<f64, PlacedFault> {
    let (Some(time), Some(channel)) = (&recording.time, recording.channels.time) else {
        return without_time(recording.sample_time.as_ref(), stated_rate);
    };
    let unit = channel.unit;
    let example = |unit| recording.channels.restated(Quantity::Time, unit);

    let resolution = resolution(time);
    let rough = steps::rough_period(time, &resolution);
    let plausible = PERIODS.contains(&rough);
    let checked = match plausible {
        true => steps::check(time, &resolution, rough),
        false => steps::check_increasing(time, |_| false),
    };
    checked.map_err(|(row, fault)| without_time_column(fault, recording).at(recording.place(row)))?;
    if !plausible {
        let (period, example) = (Number(rough), example(neighbour(unit)));
        return Err(Fault::ImplausiblePeriod { period, unit, example }.into());
    }

    let line = Line::fit(time);
    let span = time[time.len() - 1] - time[0];
    let digit = coarsest(&resolution);
    let printed = digit / span;
    // Stamps since 1970 have fewer digits left for their steps.
    let exact = EVEN * digit + 2.0 * f64::EPSILON * time[time.len() - 1].abs();
    let even = digit > 0.0 && time.windows(2).all(|pair| (pair[1] - pair[0] - line.period).abs() <= exact);
    let period = match whole_rate(line.period, if even { exact / span } else { printed.min(RATE_TOLERANCE) }) {
        Some(rate) => 1.0 / rate,
        None => line.period,
    };

    let disagrees = |rate: &f64| (period * rate - 1.0).abs() > RATE_TOLERANCE.max(printed);
    if let Some(stated) = stated_rate.filter(disagrees) {
        return Err(Fault::RateDisagrees {
            stated: Number(stated),
            found: Number(1.0 / period),
            unit,
            example: example(neighbour(unit)),
        }
        .into());
    }
    Ok(period)
}

/// Before which rows of a recording how many samples are missing, by its time column; none where they are too many
/// to be holes.
pub(super) fn gaps(recording: &Recording) -> Vec<(usize, usize)> {
    let Some(time) = &recording.time else { return Vec::new() };
    let resolution = resolution(time);
    let period = steps::rough_period(time, &resolution);
    if PERIODS.contains(&period) { steps::few_gaps(time, &resolution, period) } else { Vec::new() }
}

/// The fault with the columns that do without the time, where its remedy asks for them.
fn without_time_column(fault: Fault, recording: &Recording) -> Fault {
    match fault {
        Fault::IrregularTime { value, percent, period, .. } => {
            let example = Channels { time: None, ..recording.channels }.to_string();
            Fault::IrregularTime { value, percent, period, example }
        }
        fault => fault,
    }
}

/// Sample period (s) of a recording without a time column: what the file says beside its columns, else the stated rate
/// (Hz); where there are both, they agree.
pub(super) fn without_time(sample_time: Option<&SampleTime>, stated_rate: Option<f64>) -> Result<f64, PlacedFault> {
    match (sample_time, stated_rate) {
        (None, None) => Err(Fault::SampleRate(f64::NAN).into()),
        (None, Some(rate)) => Ok(1.0 / rate),
        (Some(SampleTime { seconds, place, name }), _) if !PERIODS.contains(seconds) => {
            Err(Fault::ImplausibleSampleTime { name: excerpt(name), seconds: Number(*seconds) }.at(*place))
        }
        (Some(SampleTime { seconds, place, name }), Some(rate)) if (seconds * rate - 1.0).abs() > RATE_TOLERANCE => {
            let (stated, seconds) = (Number(rate), Number(*seconds));
            Err(Fault::RateContradicted { stated, name: excerpt(name), seconds }.at(*place))
        }
        (Some(SampleTime { seconds, .. }), _) => Ok(whole_rate(*seconds, 0.0).map_or(*seconds, |rate| 1.0 / rate)),
    }
}

/// The rate (Hz) of `period` (s) if that is a whole number, to the relative `tolerance` of the period.
pub(super) fn whole_rate(period: f64, tolerance: f64) -> Option<f64> {
    const ARITHMETIC: f64 = 1e-9;
    let rate = (1.0 / period).round();
    let same = (period * rate - 1.0).abs() <= tolerance.max(ARITHMETIC);
    (rate >= 1.0 && same).then_some(rate)
}

fn neighbour(unit: Unit) -> Unit {
    unit.smaller().or(unit.larger()).unwrap_or(unit)
}

#[cfg(test)]
mod tests {
    use super::super::holes::put_stamps_back;
    use super::super::recording::Recording;
    use super::*;
    use measurement_files::Place;

    fn period(time: &[f64], rate: Option<f64>) -> Result<f64, (Place, Fault)> {
        let recording = Recording {
            channels: Channels::in_order(3),
            first_row: Place::Line(2),
            sample_time: None,
            time: Some(time.to_vec()),
            voltage: vec![0.0; time.len()],
            displacement: None,
            holes: Vec::new(),
            put_back: Vec::new(),
        };
        sample_period(&recording, rate).map_err(|PlacedFault(place, fault)| (place, fault))
    }

    fn clock(rows: u32, period: f64) -> Vec<f64> {
        (0..rows).map(|k| f64::from(k) * period).collect()
    }

    fn printed(time: &[f64], print: impl Fn(f64) -> String) -> Vec<f64> {
        time.iter().map(|&t| print(t).parse().unwrap()).collect()
    }

    /// As C's `%.4g` prints.
    fn four_digits(t: f64) -> String {
        format!("{t:.3e}")
    }

    #[test]
    fn the_period_comes_from_the_whole_column() {
        for rate in [1.0, 200.0, 2000.0, 3000.0, 10_000.0, 44_100.0, 1e6] {
            assert_eq!(period(&clock(4001, 1.0 / rate), None).unwrap(), 1.0 / rate);
        }
        let slow = period(&clock(1000, 1.0 / 2000.3), None).unwrap();
        assert!((slow * 2000.3 - 1.0).abs() < 1e-12);
        let mut first_step_short = clock(1000, 0.001);
        first_step_short[0] = 0.000_009;
        assert_eq!(period(&first_step_short, None).unwrap(), 0.001);
        let late: Vec<f64> = clock(1000, 0.0005).iter().map(|t| t + 1.7e9).collect();
        assert_eq!(period(&late, None).unwrap(), 0.0005);
    }

    #[test]
    fn a_period_that_every_step_has_is_no_rounded_whole_rate() {
        for (period_ms, rows, decimals) in [(1.5, 134, 4), (1.5, 20, 4), (3.0, 20, 3), (4.5, 20, 4), (9.0, 20, 3)] {
            let time = printed(&clock(rows, period_ms * 1e-3), |t| format!("{t:.decimals$}"));
            let found = 1e3 * period(&time, None).unwrap();
            assert!((found - period_ms).abs() < 1e-9, "{period_ms} ms: {found}");
            let since_1970 = |t: f64| format!("{:.decimals$}", 1.7e9 + t);
            let found = 1e3 * period(&printed(&clock(rows, period_ms * 1e-3), since_1970), None).unwrap();
            assert!((found - period_ms).abs() < 1e-5, "{period_ms} ms: {found}");
        }
    }

    #[test]
    fn printed_time_stamps_are_tolerated() {
        let starts = (0..40).map(|n| f64::from(n) * 0.05);
        let starts = starts.flat_map(|start| [(16, start), (17, start), (100, start)]);
        for (rows, start) in starts.chain([(4001, 0.7), (20_000, 0.3), (20_000, 0.0)]) {
            let clock = |rows, period| -> Vec<f64> {
                let ticks = (0..rows).map(f64::from);
                ticks.map(|k| (k + start) * period).collect()
            };
            for (rate, decimals) in [(2000.0, 4), (2000.0, 3), (3000.0, 4), (1024.0, 4), (256.0, 3)] {
                let time = printed(&clock(rows, 1.0 / rate), |t| format!("{t:.decimals$}"));
                let found = period(&time, None);
                let found = found.unwrap_or_else(|e| panic!("{rows} {rate} {decimals}: {}", e.1));
                let relative = (found * rate - 1.0).abs();
                assert!(relative < 0.1_f64.max(2.0 / f64::from(rows)), "{rows} {rate}: {found}");
                if rows > 4000 {
                    assert_eq!(found, 1.0 / rate);
                }
            }
            let time = printed(&clock(rows, 0.0005), four_digits);
            assert_eq!(period(&time, None).unwrap(), 0.0005, "{rows}");
        }
    }

    #[test]
    fn small_jitter_passes_and_large_does_not() {
        let jittered = |part: f64| -> Vec<f64> {
            clock(500, 0.001).iter().enumerate().map(|(k, t)| t + 0.001 * part * (k as f64 * 1.7).sin()).collect()
        };
        assert!((period(&jittered(0.004), None).unwrap() - 0.001).abs() < 1e-7);
        let (_, fault) = period(&jittered(0.03), None).unwrap_err();
        assert!(matches!(fault, Fault::IrregularTime { .. }), "{fault}");
        let milliseconds = printed(&jittered(0.6), |t| format!("{t:.3}"));
        assert!(period(&milliseconds, None).is_err());
        let mut one = clock(500, 0.001);
        one[300] += 0.0003;
        let (place, fault) = period(&one, None).unwrap_err();
        assert_eq!(place, Place::Line(302));
        assert!(fault.to_string().contains("30 % of a sample period of 0.001 s"), "{fault}");
    }

    #[test]
    fn a_clock_that_changes_pace_is_refused() {
        let mut time = clock(2000, 0.001);
        for k in 1000..2000 {
            time[k] = time[k - 1] + 0.001_008;
        }
        let (_, fault) = period(&time, None).unwrap_err();
        assert!(matches!(fault, Fault::IrregularTime { .. }), "{fault}");
    }

    #[test]
    fn gaps_are_counted_and_dated() {
        for (decimals, rate) in [(9, 2000.0), (4, 2000.0), (3, 1000.0), (2, 100.0), (6, 3000.0)] {
            let mut time = clock(400, 1.0 / rate);
            for t in &mut time[150..] {
                *t += 3.0 / rate;
            }
            for t in &mut time[300..] {
                *t += 1.0 / rate;
            }
            let time = printed(&time, |t| format!("{t:.decimals$}"));
            let (place, fault) = period(&time, None).unwrap_err();
            assert_eq!(place, Place::Line(152), "{decimals} {rate}");
            let Fault::Gap { missing, after, gaps, few } = fault else {
                panic!("{fault}");
            };
            assert_eq!((missing, gaps, few), (3, 2, true));
            assert!((after.0 - 149.0 / rate).abs() < 1e-3 / rate + 1e-6);
        }
    }

    #[test]
    fn long_gaps_are_counted_whatever_the_period_is_rounded_to() {
        for (rate, decimals) in
            [(3000.0, 6), (6000.0, 6), (7000.0, 6), (1024.0, 6), (44_100.0, 9), (2000.3, 6), (2000.0, 4)]
        {
            for lost in [150, 400, 1000] {
                let mut time = printed(&clock(20_000, 1.0 / rate), |t| format!("{t:.decimals$}"));
                time.drain(9_000..9_000 + lost);
                let (_, fault) = period(&time, None).unwrap_err();
                let Fault::Gap { missing, few: true, .. } = fault else { panic!("{lost} at {rate} Hz: {fault}") };
                assert_eq!(missing, lost as u64, "{rate} Hz");
                let filled = put_stamps_back(&time, &[(9_000, lost)]);
                assert!((period(&filled, None).unwrap() * rate - 1.0).abs() < 1e-6, "{lost} at {rate} Hz");
            }
        }
    }

    #[test]
    fn stamps_that_are_missing_are_put_back_with_as_many_decimals() {
        for (decimals, rate) in [(9, 2000.0), (4, 2000.0), (3, 1000.0), (2, 100.0), (6, 3000.0)] {
            let whole = printed(&clock(400, 1.0 / rate), |t| format!("{t:.decimals$}"));
            let time = [&whole[..150], &whole[153..300], &whole[301..]].concat();
            let filled = put_stamps_back(&time, &[(150, 3), (297, 1)]);
            let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1.001 * 10_f64.powi(-(decimals as i32));
            assert!(filled.len() == 400 && filled.iter().zip(&whole).all(near), "{rate}");
            assert!((period(&filled, None).unwrap() * rate - 1.0).abs() < 1e-9, "{rate}");
        }
    }

    #[test]
    fn time_must_increase() {
        let mut back = clock(100, 0.001);
        back[50] = 0.0301;
        let (place, fault) = period(&back, None).unwrap_err();
        assert_eq!(place, Place::Line(52));
        assert!(fault.to_string().contains("(0.0301 s after 0.049 s)"), "{fault}");
        let mut twice = clock(100, 0.001);
        twice[50] = twice[49];
        let (place, fault) = period(&twice, None).unwrap_err();
        assert_eq!(place, Place::Line(52));
        assert!(matches!(fault, Fault::TimeNotIncreasing { .. }), "{fault}");
        for time in [vec![1.0; 20], clock(20, -0.001)] {
            let (place, fault) = period(&time, None).unwrap_err();
            assert_eq!(place, Place::Line(3));
            assert!(matches!(fault, Fault::TimeNotIncreasing { .. }), "{fault}");
        }
    }

    #[test]
    fn a_clock_that_jitters_back_is_told_from_another_recording() {
        let jittery = |k: u32| (f64::from(k) + f64::from(k * 7919 % 13) * 0.2 - 1.2) * 0.001;
        let (_, fault) = period(&(0..200).map(jittery).collect::<Vec<f64>>(), None).unwrap_err();
        assert!(matches!(&fault, Fault::IrregularTime { example, .. } if !example.contains("time=")), "{fault}");
        let mut seldom = clock(1000, 0.001);
        [100, 400, 700].into_iter().for_each(|row| seldom[row] = seldom[row - 1] - 0.002);
        let (place, fault) = period(&seldom, None).unwrap_err();
        assert!(matches!(fault, Fault::IrregularTime { .. }) && place == Place::Line(102), "{place:?}: {fault}");
        (seldom[400], seldom[700]) = (0.4, 0.7);
        let (_, fault) = period(&seldom, None).unwrap_err();
        assert!(matches!(fault, Fault::TimeNotIncreasing { .. }), "one row in a wrong place: {fault}");
        let (mut equal, even) = (clock(1000, 0.001), |k: u32| (f64::from(k) + f64::from(k * 7919 % 13) * 0.07) * 0.001);
        [100, 400, 700].into_iter().for_each(|row| equal[row] = equal[row - 1]);
        let mut jitters: Vec<f64> = (0..200).map(even).collect();
        jitters[101] = jitters[100];
        for time in [equal, jitters] {
            let (place, fault) = period(&time, None).unwrap_err();
            assert!(matches!(fault, Fault::IrregularTime { .. }), "{place:?}: {fault}");
        }
        let (place, fault) = period(&(0..200).map(|k| jittery(k % 100)).collect::<Vec<f64>>(), None).unwrap_err();
        assert!(matches!(fault, Fault::TimeNotIncreasing { .. }), "{place:?}: {fault}");
        let (_, fault) = period(&[clock(100, 0.001), clock(100, 0.001)].concat(), None).unwrap_err();
        assert!(matches!(fault, Fault::TimeNotIncreasing { .. }), "{fault}");
    }

    /// Written in whole periods, so that a stamp that is late by one is the next one's.
    #[test]
    fn stamps_that_are_late_by_a_period_are_no_gap() {
        for every in [50, 100, 200, 2_100] {
            let mut time = clock(4000, 0.001);
            (every..4000)
                .step_by(every)
                .for_each(|row| time[row] = printed(&[time[row] + 0.001], |t| format!("{t:.3}"))[0]);
            let (place, fault) = period(&time, None).unwrap_err();
            assert!(matches!(fault, Fault::IrregularTime { .. }), "{every}: {place:?}: {fault}");
            assert!(steps::few_gaps(&time, &resolution(&time), 0.001).is_empty(), "{every}");
        }
        // What is missing is missing though the next stamp comes early.
        let mut time = clock(4000, 0.001);
        time[2000..].iter_mut().for_each(|stamp| *stamp += 0.1);
        time[2001] -= 0.0006;
        assert_eq!(steps::few_gaps(&time, &resolution(&time), 0.001), [(2000, 100)]);
    }

    #[test]
    fn a_stated_rate_must_agree() {
        let time = clock(100, 0.0005);
        assert_eq!(period(&time, Some(2000.0)).unwrap(), 0.0005);
        assert_eq!(period(&time, Some(2001.0)).unwrap(), 0.0005);
        let (_, fault) = period(&time, Some(2010.0)).unwrap_err();
        assert!(matches!(fault, Fault::RateDisagrees { .. }));
        let (_, fault) = period(&clock(100, 0.5), Some(2000.0)).unwrap_err();
        assert!(matches!(&fault, Fault::RateDisagrees { example, .. } if example.contains("time=1:ms")), "{fault}");
    }

    #[test]
    fn implausible_periods_ask_for_the_unit() {
        for wrong in [500.0, 1e-9, 1e300] {
            let (place, fault) = period(&clock(100, wrong), None).unwrap_err();
            assert_eq!(place, Place::File);
            assert!(matches!(fault, Fault::ImplausiblePeriod { .. }), "{fault}");
        }
    }
}
