//! A sensor at an end of its range whose reading still has noise: it stands within a narrow band at its highest or
//! lowest while the voltage goes on.
//!
//! An actuator that saturates comes to its end in a bow, the voltage going as far from some way below the band to the
//! band as within it, and one that goes on after its voltage has turned bows within the band. What is cut off comes
//! there in a straight line and with the voltage, and stays level.

use super::leaps::ROWS;
use crate::noise::noise_of;
use crate::signal::{correlation_of, ends, resolution};
use std::ops::Range;

/// Heights of the band, of the stroke: a narrow one finds what is hardly cut off, a wide one what is noisier there.
const BANDS: [f64; 3] = [0.003, 0.006, 0.01];
/// A band is at least so many standard deviations of the noise high, and so many of the sensor's steps.
const DEVIATIONS: f64 = 8.0;
const STEPS: f64 = 4.0;
/// The way to the band begins so many of its heights below the end,
const BEGINS: f64 = 6.0;
/// and takes less than this part of the voltage's way within it.
const STRAIGHT: f64 = 0.5;
/// Level is what is higher in its middle third than in its first and last sixth by no more than this part of the band.
const LEVEL: f64 = 0.3;

/// First and last row of each stretch in which the displacement, which moves by `stroke`, is cut off while the voltage
/// moves by more than `least_v`.
pub(super) fn railed(voltage: &[f64], displacement: &[f64], least_v: f64, stroke: f64) -> Vec<(usize, usize)> {
    let noise = noise_of(displacement).unwrap_or(0.0);
    let least = (DEVIATIONS * noise).max(STEPS * resolution(displacement));
    let (low, high) = ends(displacement);
    let rises = correlation_of(voltage.iter().copied().zip(displacement.iter().copied())).signum();
    let at_ends = |band: f64| {
        let of = |(end, sign): (f64, f64)| {
            let below = move |row: usize| end - sign * displacement[row];
            let outwards = move |from: usize, to: usize| sign * rises * (voltage[to] - voltage[from]);
            at_an_end(voltage.len(), below, outwards, band, least_v)
        };
        [(high, 1.0), (-low, -1.0)].map(of).concat()
    };
    let bands = BANDS.iter().map(|part| part * stroke).filter(|band| *band >= least);
    let mut found: Vec<(usize, usize)> = bands.flat_map(at_ends).collect();
    merge(&mut found);
    found
}

/// Brings stretches into their order, and those that have rows in common together.
pub(super) fn merge(stretches: &mut Vec<(usize, usize)>) {
    stretches.sort_unstable();
    stretches.dedup_by(|later, earlier| {
        let one = later.0 <= earlier.1;
        if one {
            earlier.1 = earlier.1.max(later.1);
        }
        one
    });
}

/// Those at one end of so many rows. A row is `below` it by so many µm, and from one row to another the voltage goes by
/// so many V `outwards`, to where the displacement ends.
fn at_an_end(
    rows: usize,
    below: impl Fn(usize) -> f64 + Copy,
    outwards: impl Fn(usize, usize) -> f64,
    band: f64,
    least_v: f64,
) -> Vec<(usize, usize)> {
    // Where the way to the band began last, and with it where the band was come to.
    let (mut begins, mut from) = (None, None);
    let mut found = Vec::new();
    for row in 0..=rows {
        let inside = row < rows && below(row) <= band;
        match from {
            None if inside => from = Some((begins, row)),
            Some((Some(before), first)) if !inside => {
                let within = (first..row).map(|row| outwards(first, row)).fold(0.0, f64::max);
                let way = outwards(before, first);
                let straight = way > 0.0 && way < STRAIGHT * within;
                let level = || row - first >= ROWS && bow(first..row, below) < LEVEL * band;
                if within > least_v && straight && level() {
                    found.push((first, row - 1));
                }
            }
            _ => {}
        }
        if !inside {
            from = None;
        }
        if row < rows && below(row) > BEGINS * band {
            begins = Some(row);
        }
    }
    found
}

/// How far the middle third of some rows, eight at least, is above the higher of their first and last sixth.
fn bow(rows: Range<usize>, below: impl Fn(usize) -> f64) -> f64 {
    let median = |rows: Range<usize>| {
        let mut below: Vec<f64> = rows.map(&below).collect();
        let middle = below.len() / 2;
        *below.select_nth_unstable_by(middle, f64::total_cmp).1
    };
    let (third, sixth) = (rows.len() / 3, rows.len() / 6);
    let (start, end) = (median(rows.start..rows.start + sixth), median(rows.end - sixth..rows.end));
    start.min(end) - median(rows.start + third..rows.end - third)
}
