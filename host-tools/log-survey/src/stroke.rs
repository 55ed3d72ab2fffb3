//! How far a displacement goes, where some of what was recorded of it is no measurement.

use crate::flaw::{SPIKE_ROWS, frozen};
use crate::signal::range;

/// At most one value in so many is left out at either end,
const RARE: usize = 100;
/// where it is beyond the next one by more than this part of the range that all but the rarest values lie in.
const APART: f64 = 0.05;

/// The stroke of a displacement (µm) beside the voltage at the same instants (V; none where it is not known), from its lowest to
/// its highest value. Left out are stretches in which it stands still while the voltage moves, and at either end a few values
/// beyond a gap that come no more than three in a row: a spike is no movement. Where that is most of them, nothing is left out.
pub fn stroke(voltage: &[f64], displacement: &[f64]) -> f64 {
    let mut moved = vec![true; displacement.len()];
    if voltage.len() == displacement.len() {
        frozen(voltage, displacement).for_each(|(first, last)| moved[first..=last].fill(false));
    }
    let mut rows: Vec<usize> = (0..displacement.len()).filter(|&row| moved[row]).collect();
    if 2 * rows.len() < displacement.len() {
        rows = (0..displacement.len()).collect();
    }
    rows.sort_by(|a, b| displacement[*a].total_cmp(&displacement[*b]));
    let sorted: Vec<f64> = rows.iter().map(|&row| displacement[row]).collect();
    let apart = APART * range(&sorted);
    let rare = sorted.len() / RARE;
    // So many values at an end, the most of them that can be, are left out; `at` counts from that end.
    let left_out = |at: &dyn Fn(usize) -> usize| {
        let gap = |count: &usize| (sorted[at(*count)] - sorted[at(count - 1)]).abs() > apart;
        let beyond = |count: usize| (0..count).map(|index| rows[at(index)]).collect();
        (1..=rare).rev().filter(gap).find(|&count| brief(beyond(count))).unwrap_or(0)
    };
    let Some(end) = sorted.len().checked_sub(1) else { return 0.0 };
    let (low, high) = (left_out(&|index| index), left_out(&|index| end - index));
    sorted[end - high] - sorted[low]
}

/// Whether rows come no more at a time than a spike's do.
fn brief(mut rows: Vec<usize>) -> bool {
    rows.sort_unstable();
    rows.chunk_by(|a, b| a + 1 == *b).all(|run| run.len() <= SPIKE_ROWS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use plants::{CATALOGUE, Plant, Waveform};
    use recordings::log::Log;
    use recordings::rig::{EXCITATIONS, Rig};

    fn of(log: &Log) -> f64 {
        stroke(&log.voltage, log.displacement.as_deref().unwrap())
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
                stroke(&voltage, &displacement)
            };
            let sound = of(&|_, y| y);
            for leap in [3.0_f64, 50.0, -9_000.0] {
                for rows in [4_000..4_001, 4_000..4_003, 0..1, 9_998..10_000] {
                    let spiky = of(&|row, y| if rows.contains(&row) { 5.0 * leap.signum() + leap } else { y });
                    assert_eq!(spiky, sound, "{degrees}° a row, {leap} µm at {rows:?}");
                }
            }
            let many = of(&|row, y| if row % 500 == 17 { y + if row % 1000 == 17 { 50.0 } else { -50.0 } } else { y });
            assert!((many / sound - 1.0).abs() < 1e-9, "{degrees}° a row: {many} of {sound} µm");
        }
    }

    /// As a sensor that is off reads.
    #[test]
    fn a_sensor_that_stands_elsewhere_does_not_move_it() {
        let (voltage, displacement) = sine(1.0, |row, y| if (3_000..3_600).contains(&row) { -80.0 } else { y });
        assert_eq!(stroke(&voltage, &displacement), 10.0);
        assert!(stroke(&[], &displacement) > 80.0, "nothing shows that the voltage moved");
    }

    #[test]
    fn a_rare_movement_counts_and_a_spike_beside_a_rest_does_not() {
        let stands = |moves: std::ops::Range<usize>| {
            let of = |row: usize| if moves.contains(&row) { 8.0 } else { 1e-3 * libm::sin(row as f64) };
            let displacement: Vec<f64> = (0..10_000).map(of).collect();
            stroke(&vec![0.0; 10_000], &displacement)
        };
        assert!((stands(5_000..5_050) - 8.0).abs() < 0.01);
        assert!(stands(5_000..5_002) < 0.01);
    }

    #[test]
    fn of_few_values_it_is_what_they_span() {
        assert_eq!((stroke(&[], &[]), stroke(&[], &[3.0]), stroke(&[], &[0.0, 10.0])), (0.0, 0.0, 10.0));
    }
}
