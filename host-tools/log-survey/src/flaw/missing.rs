//! Where samples may be missing that no time stamp tells of: voltage and displacement leap together from one row to the
//! next, by far more than anywhere near, and both go on as before.
//!
//! What leaps because the drive does looks alike where the displacement follows within a row. A drive that leaps mostly
//! rests before or behind it, leaps as far again elsewhere, or goes from one end of its range to the other: such leaps
//! are none. Nothing is seen of samples that are missing where the voltage comes to the same value again, or stands.

use crate::noise::noise_of;
use crate::signal::ends;

/// Rows before and behind a leap that it is held against.
const NEAR: usize = 20;
/// It is this many times the largest step near it,
const FURTHER: f64 = 5.0;
/// and this part of the range.
const LEAP: f64 = 0.05;
/// Displacement and voltage leap by each other's part of their ranges within this factor.
const TOGETHER: f64 = 3.0;
/// Near it the voltage goes on at this part of the log's usual step at least,
const MOVES: f64 = 0.2;
/// and by so many deviations of its noise.
const DEVIATIONS: f64 = 6.0;
/// Leaps of a drive are alike within this part of themselves.
const ALIKE: f64 = 0.1;
/// A step of this part of a leap is one of the drive's.
const STEP: f64 = 0.5;
/// So many leaps are the drive's.
const MANY: usize = 64;

/// The row before each leap, and how far voltage and displacement leap, whose ranges these are.
pub fn missing(voltage: &[f64], displacement: &[f64], volts: f64, stroke: f64) -> Vec<(usize, f64, f64)> {
    let rows = voltage.len();
    if rows <= 2 * NEAR + 2 || volts <= 0.0 || stroke <= 0.0 {
        return Vec::new();
    }
    let step = |values: &[f64], row: usize| values[row + 1] - values[row];
    let mut steps: Vec<f64> = (0..rows - 1).map(|row| step(voltage, row).abs()).collect();
    let usual = *steps.select_nth_unstable_by((rows - 1) / 2, f64::total_cmp).1;
    let goes_on = (MOVES * NEAR as f64 * usual).max(DEVIATIONS * noise_of(voltage).unwrap_or(0.0));
    let leaps = |values: &[f64], range: f64, row: usize| {
        let leap = step(values, row).abs();
        let mut near = (row - NEAR..row).chain(row + 1..row + 1 + NEAR);
        leap > LEAP * range && near.all(|row| leap > FURTHER * step(values, row).abs())
    };
    let moves = |from: usize, to: usize| goes_on > 0.0 && (voltage[to] - voltage[from]).abs() > goes_on;
    let (low, high) = ends(voltage);
    let at_end = |v: f64| v - low < LEAP * volts || high - v < LEAP * volts;
    let found: Vec<(usize, f64, f64)> = (NEAR..rows - NEAR - 1)
        .filter(|&row| leaps(voltage, volts, row) && leaps(displacement, stroke, row))
        .map(|row| (row, step(voltage, row), step(displacement, row)))
        .filter(|&(row, leap_v, leap_um)| {
            // A sensor that is mounted the other way leaps the other way.
            let together = (leap_um / stroke / (leap_v / volts)).abs();
            (TOGETHER.recip()..TOGETHER).contains(&together)
                && moves(row - NEAR, row)
                && moves(row + 1, row + 1 + NEAR)
                && !(at_end(voltage[row]) && at_end(voltage[row + 1]))
        })
        .take(MANY)
        .collect();
    if found.len() == MANY {
        return Vec::new();
    }
    let drives = |&(row, leap_v, _): &(usize, f64, f64)| {
        let other = |of: usize| of != row && found.iter().all(|found| found.0 != of);
        let alike = |of: f64| (of.abs() / leap_v.abs() - 1.0).abs() < ALIKE;
        (0..rows - 1).any(|of| other(of) && step(voltage, of).abs() > STEP * leap_v.abs())
            || found.iter().any(|of| of.0 != row && alike(of.1))
    };
    found.iter().filter(|leap| !drives(leap)).map(|&(row, volts, um)| (row, volts.abs(), um.abs())).collect()
}
