//! How far a displacement goes, where some of what was recorded of it is no measurement.

use crate::flaw::{Commanded, Explained, SPIKE_ROWS, frozen};
use crate::signal::range;
use std::cmp::Ordering;

/// At most one value in so many is left out at either end,
const RARE: usize = 100;
/// where it is beyond the next one by more than this part of the range that all but the rarest values lie in.
const APART: f64 = 0.05;

/// The stroke of a displacement (µm) beside the voltage at the same instants (V), from its lowest to its highest value;
/// `before_v` is the voltage before the first. Left out are stretches in which it stands still while the voltage moves,
/// and a few values beyond a gap that come no more than three in a row, unless the voltage leaps there, too: a spike is
/// no movement, and a pulse that the voltage commands is a movement. Where a sensor stood still for most of the time,
/// nothing of that is left out.
pub fn stroke(voltage: &[f64], displacement: &[f64], before_v: f64) -> f64 {
    debug_assert_eq!(voltage.len(), displacement.len());
    let mut moved = vec![true; displacement.len()];
    frozen(voltage, displacement).for_each(|(first, last)| moved[first..=last].fill(false));
    let mut rows: Vec<usize> = (0..displacement.len()).filter(|&row| moved[row]).collect();
    if 2 * rows.len() < displacement.len() {
        rows = (0..displacement.len()).collect();
    }
    let Some(end) = rows.len().checked_sub(1) else { return 0.0 };
    let usual = range(&rows.iter().map(|&row| displacement[row]).collect::<Vec<_>>());
    let rare = rows.len() / RARE;
    in_order_at_the_ends(&mut rows, rare + 1, |a, b| displacement[a].total_cmp(&displacement[b]).then(a.cmp(&b)));
    let at_rank = |rank: usize| displacement[rows[rank]];
    let explained = Explained::of(voltage, before_v, usual / range(voltage));
    let commanded = Commanded::of(voltage, displacement, usual);
    // So many values at an end, the most of them that can be, are left out; `at` counts from that end.
    let left_out = |at: &dyn Fn(usize) -> usize| {
        let spikes = |count: &usize| {
            let next = at_rank(at(*count));
            // First, since few are: of a long log there are many counts.
            if (at_rank(at(count - 1)) - next).abs() <= APART * usual {
                return false;
            }
            let mut beyond: Vec<usize> = (0..*count).map(|index| rows[at(index)]).collect();
            beyond.sort_unstable();
            let leap = |run: &[usize]| run.iter().map(|&row| (displacement[row] - next).abs()).fold(0.0, f64::max);
            let explains = |run: &[usize]| {
                commanded.explains(run[0], run[run.len() - 1], leap(run))
                    || (run.contains(&0) && leap(run) <= explained.start_um)
                    || (run.contains(&(displacement.len() - 1)) && leap(run) <= explained.end_um)
            };
            beyond.chunk_by(|a, b| a + 1 == *b).all(|run| run.len() <= SPIKE_ROWS && !explains(run))
        };
        (1..=rare).rev().find(spikes).unwrap_or(0)
    };
    let (low, high) = (left_out(&|index| index), left_out(&|index| end - index));
    at_rank(end - high) - at_rank(low)
}

/// Puts so many of the first and of the last in order, as sorting all would: of a long log few are looked at.
fn in_order_at_the_ends(rows: &mut [usize], count: usize, order: impl Fn(usize, usize) -> Ordering) {
    let by = |a: &usize, b: &usize| order(*a, *b);
    if 2 * count >= rows.len() {
        return rows.sort_unstable_by(by);
    }
    let (first, _, rest) = rows.select_nth_unstable_by(count, by);
    first.sort_unstable_by(by);
    // Of the rest, which has as many at least.
    let from = rest.len() - count;
    if from > 0 {
        rest.select_nth_unstable_by(from - 1, by);
    }
    rest[from..].sort_unstable_by(by);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flaw::in_rows;
    use plants::{CATALOGUE, Plant, Waveform};
    use recordings::log::Log;
    use recordings::rig::{EXCITATIONS, Rig};

    fn of(log: &Log) -> f64 {
        stroke(&log.voltage, log.displacement.as_deref().unwrap(), 0.0)
    }

    fn raw(log: &Log) -> f64 {
        let of = |pick: fn(f64, f64) -> f64| log.displacement.iter().flatten().copied().reduce(pick).unwrap();
        of(f64::max) - of(f64::min)
    }

    /// So that no figure of a sound log is another for it, bit by bit.
    #[test]
    fn of_a_sound_log_it_is_from_the_lowest_to_the_highest_value() {
        for seed in 1..=20 {
            for excitation in EXCITATIONS {
                let log = Rig { duration: 0.5, seed, ..Rig::default() }.log(excitation);
                assert_eq!(of(&log), raw(&log), "{} of seed {seed}", excitation.name);
            }
        }
        for (seed, kind) in (1u32..).zip(CATALOGUE) {
            let plant = Plant::drawn(kind, seed.into());
            let amplitude = 0.8 * plant.full_v;
            for waveform in [
                Waveform::Sine { amplitude, hertz: 100.0, offset: 0.0 },
                Waveform::AmplitudeModulated { amplitude, hertz: 5.0, swell_hz: 0.5 },
                Waveform::Staircase { amplitude, steps: 6, hold_s: 0.1 },
                Waveform::Multisine { amplitude, from_hz: 1.0, to_hz: 40.0, tones: 12 },
            ] {
                let log = plant.log("log", &waveform, 2.0, seed.into());
                assert_eq!(of(&log), raw(&log), "{} on {waveform:?}", kind.name());
            }
        }
    }

    /// A sine of 50 V and 5 µm whose rows are as many degrees apart, for ten thousand rows.
    fn sine(degrees: f64, change: impl Fn(usize, f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        let course = |row: usize| libm::sin((degrees * row as f64).to_radians());
        (0..10_000).map(|row| (50.0 * course(row), change(row, 5.0 * course(row)))).unzip()
    }

    #[test]
    fn spikes_do_not_move_it_however_fast_the_displacement_is() {
        for degrees in [1.0, 18.0, 60.0] {
            let of = |change: &dyn Fn(usize, f64) -> f64| {
                let (voltage, displacement) = sine(degrees, change);
                stroke(&voltage, &displacement, 0.0)
            };
            let sound = of(&|_, y| y);
            for leap in [3.0_f64, 50.0, -9_000.0] {
                for rows in [4_000..4_001, 4_000..4_003, 0..1, 9_998..10_000] {
                    // Where a log begins or ends, the voltage's own steps may be the displacement's.
                    if degrees > 1.0 && leap == 3.0 && !(1..9_998).contains(&rows.start) {
                        continue;
                    }
                    let spiky = of(&|row, y| if rows.contains(&row) { 5.0 * leap.signum() + leap } else { y });
                    assert_eq!(spiky, sound, "{degrees}° a row, {leap} µm at {rows:?}");
                }
            }
            let many = of(&|row, y| if row % 500 == 17 { y + if row % 1000 == 17 { 50.0 } else { -50.0 } } else { y });
            assert!((many / sound - 1.0).abs() < 1e-9, "{degrees}° a row: {many} of {sound} µm");
        }
    }

    #[test]
    fn a_log_that_begins_with_a_jump_from_another_voltage_has_gone_that_far() {
        let (voltage, displacement) = sine(1.0, |row, y| if row < 2 { -12.0 } else { y });
        let voltage: Vec<f64> = voltage.iter().map(|v| v + 60.0).collect();
        assert!((stroke(&voltage, &displacement, 0.0) - 17.0).abs() < 1e-9);
        assert!((stroke(&voltage, &displacement, voltage[0]) - 10.0).abs() < 1e-9);
    }

    /// A rest, or a slow sine of ±`amplitude_v`, at 0.1 µm/V with noise in both; one row in 400 begins a pulse of so
    /// many rows to 50 V, which the displacement follows so many rows late.
    fn pulses(amplitude_v: f64, rows: usize, late: usize) -> (Vec<f64>, Vec<f64>) {
        let mut draw = 1_u64;
        let mut noise = || {
            draw = draw * 48_271 % 2_147_483_647;
            draw as f64 / 2_147_483_647.0 - 0.5
        };
        let commanded = |row: usize| {
            let sine = amplitude_v * libm::sin(row as f64 * 0.005);
            if row % 400 >= 200 && row % 400 < 200 + rows { 50.0 } else { sine }
        };
        (0..10_000)
            .map(|row| (commanded(row) + 0.02 * noise(), 0.1 * commanded(row.saturating_sub(late)) + 0.004 * noise()))
            .unzip()
    }

    #[test]
    fn rare_pulses_that_the_voltage_commands_count_and_spikes_beside_them_do_not() {
        for amplitude_v in [0.0, 5.0] {
            for (rows, late) in [(1, 0), (2, 0), (3, 0), (1, 2), (3, 2)] {
                let (voltage, displacement) = pulses(amplitude_v, rows, late);
                let whole = 5.0 + 0.1 * amplitude_v;
                let found = stroke(&voltage, &displacement, 0.0);
                let which = format!("{rows} rows, {late} late, on ±{amplitude_v} V");
                assert!((found - whole).abs() < 0.02, "{which}: {found} µm, not {whole} µm");
                assert_eq!(in_rows(&voltage, &displacement, 0.0, 5e-4), [], "{which}");
                let mut spiky = displacement.clone();
                spiky[5_100] += 90.0;
                spiky[7_350] -= 40.0;
                let found = stroke(&voltage, &spiky, 0.0);
                assert!((found - whole).abs() < 0.02, "{which}, with spikes: {found} µm, not {whole} µm");
            }
        }
    }

    /// As by a row of another file; by the log's own gain the pulse would have moved the displacement by 90 µm.
    #[test]
    fn rows_that_are_broken_in_both_columns_do_not_count() {
        let (mut voltage, mut displacement) = sine(1.0, |_, y| y);
        (voltage[4_000], displacement[4_000]) = (900.0, 900.0);
        assert_eq!(stroke(&voltage, &displacement, 0.0), 10.0);
    }

    /// As a sensor that is off reads.
    #[test]
    fn a_sensor_that_stands_elsewhere_does_not_move_it() {
        let (voltage, displacement) = sine(1.0, |row, y| if (3_000..3_600).contains(&row) { -80.0 } else { y });
        assert_eq!(stroke(&voltage, &displacement, 0.0), 10.0);
    }

    #[test]
    fn a_rare_movement_counts_and_a_spike_beside_a_rest_does_not() {
        let stands = |moves: std::ops::Range<usize>| {
            let of = |row: usize| if moves.contains(&row) { 8.0 } else { 1e-3 * libm::sin(row as f64) };
            let displacement: Vec<f64> = (0..10_000).map(of).collect();
            stroke(&vec![0.0; 10_000], &displacement, 0.0)
        };
        assert!((stands(5_000..5_050) - 8.0).abs() < 0.01);
        assert!(stands(5_000..5_002) < 0.01);
    }

    #[test]
    fn as_many_at_either_end_are_in_order_as_are_asked_for() {
        for rows in [0, 1, 2, 5, 6, 7, 300] {
            let value = |row: usize| (row * 7919) % 101;
            let order = |a: usize, b: usize| value(a).cmp(&value(b)).then(a.cmp(&b));
            let mut sorted: Vec<usize> = (0..rows).collect();
            sorted.sort_by(|a, b| order(*a, *b));
            for count in 1..=rows.min(4) {
                let mut found: Vec<usize> = (0..rows).collect();
                in_order_at_the_ends(&mut found, count, order);
                let ends = |of: &[usize]| [of[..count].to_vec(), of[rows - count..].to_vec()];
                assert_eq!(ends(&found), ends(&sorted), "{count} of {rows}");
            }
        }
    }

    #[test]
    fn of_few_values_it_is_what_they_span() {
        assert_eq!(
            (stroke(&[], &[], 0.0), stroke(&[1.0], &[3.0], 0.0), stroke(&[0.0; 2], &[0.0, 10.0], 0.0)),
            (0.0, 0.0, 10.0)
        );
    }
}
