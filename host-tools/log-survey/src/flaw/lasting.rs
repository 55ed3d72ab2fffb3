//! Whether a leap of the displacement lasts, as a step of the sensor does, or comes back within some rows, as a glitch
//! does; and whether it is none, as where rows are missing and the displacement goes on on the other branch of a loop.
//!
//! ```text
//! y = a + b·t + c·v + Σ_i w_i·play_i(v) + Σ_k s_k·[row > k]        by least squares over the whole log
//! ```
//!
//! Plays of the voltage say what the displacement does on any way; s_k is then the level behind a leap at row k. Where
//! the voltage stands long enough around it, the readings there say it themselves.

use super::leaps::{BACK, GLITCH_ROWS};
use super::steps::{ROWS, STANDS};
use crate::signal::{ends, range};
use estimator_core::model::play;
use least_squares::{Normal, Sign, Waiting};
use std::ops::RangeInclusive;

/// Half-widths of the plays, of half the voltage's range.
const PLAYS: [f64; 7] = [0.03, 0.07, 0.15, 0.3, 0.45, 0.6, 0.8];
/// A constant, the time, and the voltage.
const OTHERS: usize = 3;
/// Rows that are looked at, at most.
const LOOKED_AT: usize = 20_000;
/// The level behind a step is above the one before it by these parts of the leap.
const LASTS: RangeInclusive<f64> = 0.6..=1.6;
/// A row leaps by at least this part of a leap that comes back.
const NEARLY: f64 = 0.5;

/// Which of these leaps, each with the row before it and how far it goes (µm), go on at their level. Rows that are
/// `flawed`, and those around a leap, say nothing.
pub fn lasting(
    voltage: &[f64],
    displacement: &[f64],
    flawed: impl Iterator<Item = RangeInclusive<usize>>,
    leaps: &[(usize, f64)],
) -> Vec<bool> {
    let mut sound = vec![true; voltage.len()];
    let around = |&(row, _): &(usize, f64)| row.saturating_sub(2 * ROWS)..=row + 2 * ROWS;
    for rows in flawed.chain(leaps.iter().map(around)) {
        let end = (rows.end() + 1).min(sound.len());
        sound[*rows.start().min(&end)..end].fill(false);
    }
    let rows: Vec<usize> = leaps.iter().map(|&(row, _)| row).collect();
    let levels = levels(voltage, displacement, &sound, &rows).unwrap_or_else(|| vec![0.0; leaps.len()]);
    let volts = range(voltage);
    let judged = levels.iter().zip(leaps).map(|(level, &leap)| {
        let level = standing(voltage, displacement, volts, leap.0).unwrap_or(*level);
        LASTS.contains(&(level / leap.1))
    });
    judged.collect()
}

/// What the level is above the one before a row, µm, on either side further from it than a glitch lasts; `None` where
/// the voltage, whose range is `volts`, moves meanwhile.
fn standing(voltage: &[f64], displacement: &[f64], volts: f64, row: usize) -> Option<f64> {
    let far = 2 * ROWS + GLITCH_ROWS;
    let around = row.checked_sub(far)?..row + far;
    let (low, high) = ends(voltage.get(around.clone())?);
    // A spike among them says nothing.
    let middle = |rows: &[f64]| {
        let mut rows = rows.to_vec();
        *rows.select_nth_unstable_by(ROWS / 2, f64::total_cmp).1
    };
    let measured = displacement.get(around)?;
    let level = middle(&measured[measured.len() - ROWS..]) - middle(&measured[..ROWS]);
    (high - low <= STANDS * volts).then_some(level)
}

/// What the level behind each of these rows is above the one before, µm; `None` where nothing tells.
fn levels(voltage: &[f64], displacement: &[f64], sound: &[bool], leaps: &[usize]) -> Option<Vec<f64>> {
    let (low, high) = ends(voltage);
    let columns = OTHERS + PLAYS.len() + leaps.len();
    let (mut normal, mut waiting) = (Normal::new(columns), Waiting::of_weight(1.0));
    let mut plays = PLAYS.map(|_| *voltage.first().unwrap_or(&0.0));
    let stride = voltage.len().div_ceil(LOOKED_AT).max(1);
    let mut values = Vec::with_capacity(columns);
    for (row, (&volts, &measured)) in voltage.iter().zip(displacement).enumerate() {
        for (at, part) in plays.iter_mut().zip(PLAYS) {
            *at = play(*at, volts, 0.5 * part * (high - low));
        }
        if !sound[row] || row % stride != 0 {
            continue;
        }
        values.clear();
        values.extend([1.0, row as f64, volts]);
        values.extend(plays);
        values.extend(leaps.iter().map(|&leap| if row > leap { 1.0 } else { 0.0 }));
        waiting.add(&mut normal, &values, measured);
    }
    waiting.finish(&mut normal);
    let found = normal.solve(&vec![Sign::Free; columns])?;
    Some(found[columns - leaps.len()..].to_vec())
}

/// The first and last row of what leaps away and back around a leap of so many µm behind a row, and how far (µm);
/// `None` where nothing does that is nearly as large.
pub fn brief(displacement: &[f64], (around, leap_um): (usize, f64)) -> Option<(usize, usize, f64)> {
    let from = around.saturating_sub(2 * ROWS);
    let near = displacement.get(from..(around + 2 * ROWS + 2).min(displacement.len()))?;
    let leaps: Vec<f64> = near.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let largest = |of: &dyn Fn(f64) -> bool| {
        let those = leaps.iter().enumerate().filter(|(_, leap)| of(**leap));
        those.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(at, leap)| (at, *leap))
    };
    let (one, away) = largest(&|_| true)?;
    let (other, back) = largest(&|leap| leap * away < 0.0)?;
    let comes_back = (away + back).abs() < BACK * away.abs() && away.abs() > NEARLY * leap_um.abs();
    comes_back.then(|| (from + one.min(other) + 1, from + one.max(other), away.abs()))
}

#[cfg(test)]
mod tests {
    use crate::flaw::{Flaw, in_rows};
    use plants::{CATALOGUE, Plant, Waveform};
    use recordings::log::Log;

    fn sine(seed: u32) -> Log {
        let kind = CATALOGUE[seed as usize % CATALOGUE.len()];
        let plant = Plant::drawn(kind, seed.into());
        let waveform = Waveform::Sine { amplitude: 0.8 * plant.full_v, hertz: 1.0, offset: 0.0 };
        plant.log("log", &waveform, 4.0, seed.into())
    }

    fn found(log: &Log) -> Vec<Flaw> {
        in_rows(&log.voltage, log.displacement.as_deref().unwrap(), 0.0, log.sample_period)
    }

    #[test]
    fn a_glitch_of_some_rows_is_no_step_and_all_of_it_is_found() {
        for seed in 0..CATALOGUE.len() as u32 {
            let clean = sine(seed);
            let stroke = crate::stroke(&clean.voltage, clean.displacement.as_deref().unwrap(), 0.0);
            for (rows, part, at) in [
                (2, 0.2, 2_345),
                (4, -0.07, 3_010),
                (4, 0.35, 4_400),
                (8, -0.2, 5_123),
                (20, 0.15, 5_300),
                (60, -0.1, 4_100),
            ] {
                let mut log = clean.clone();
                let glitch = &mut log.displacement.as_mut().unwrap()[at..at + rows];
                glitch.iter_mut().for_each(|y| *y += part * stroke);
                let which = format!("{rows} rows of {part} of the stroke, device {seed}");
                let flaws = found(&log);
                let [Flaw::Spike { at: stretch, leap_um, back: true }] = flaws[..] else {
                    panic!("{which}: {flaws:?}")
                };
                let row = |time: f64| (time / log.sample_period).round() as usize;
                assert_eq!((row(stretch.from_s), row(stretch.to_s)), (at, at + rows - 1), "{which}");
                assert!(
                    (leap_um - (part * stroke).abs()).abs() < 0.05 * stroke,
                    "{which}: {leap_um} µm of {stroke} µm"
                );
            }
        }
    }

    /// It is reported by nothing, as before leaps were looked for: neither a step nor a spike of the noise.
    #[test]
    fn a_leap_that_creeps_back_is_neither_a_step_nor_a_spike_of_the_noise() {
        for seed in 0..CATALOGUE.len() as u32 {
            let mut log = sine(seed);
            let stroke = crate::stroke(&log.voltage, log.displacement.as_deref().unwrap(), 0.0);
            let behind = log.displacement.as_mut().unwrap()[4_800..].iter_mut().enumerate();
            behind.for_each(|(row, y)| {
                let noise = 0.005 * stroke * f64::from([1, -1, 1, -1, -1, 1, 1][row % 7]);
                *y += 0.2 * stroke * (-(row as f64) / 120.0).exp() + noise;
            });
            assert_eq!(found(&log), [], "device {seed}");
        }
    }

    /// From a rise to the fall: the displacement goes on as if it had stepped by the loop's width.
    #[test]
    fn rows_that_are_missing_between_two_branches_are_no_step_of_the_sensor() {
        for seed in 0..CATALOGUE.len() as u32 {
            let mut log = sine(seed);
            // A second is 2,000 rows: a twentieth before the crest and behind it.
            log.voltage.drain(2_400..2_600);
            log.displacement.as_mut().unwrap().drain(2_400..2_600);
            let steps = found(&log).into_iter().filter(|flaw| matches!(flaw, Flaw::Step { .. })).count();
            assert_eq!(steps, 0, "device {seed}");
        }
    }
}
