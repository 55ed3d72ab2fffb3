//! A voltage that was misread for a few rows: it leaps away and back, and the displacement does not go along.

use super::leaps::{SPIKE_ROWS, least_leap, spikes};
use crate::noise::noise_of;
use std::borrow::Cow;

/// Rows behind a leap in which a displacement that goes along does so.
const SOON: usize = 3;
/// A displacement goes along by this part of (stroke/voltage range) × leap,
const ALONG: f64 = 0.3;
/// and by so many deviations of its noise.
const DEVIATIONS: f64 = 4.0;
/// A voltage is at rest within this part of the range.
const AT_REST: f64 = 0.01;
/// The last row leaps by this many times the largest step before it.
const FURTHER: f64 = 2.0;

/// First and last row of each leap of a voltage of this range and back, or in the last row, and how far it is.
/// `um_per_v` is what a displacement that goes along does; of its own spikes only those that are `uncommanded`
/// are broken rows.
pub fn voltage_spikes(
    voltage: &[f64],
    displacement: &[f64],
    range: f64,
    um_per_v: f64,
    uncommanded: &dyn Fn(&(usize, usize, f64)) -> bool,
) -> Vec<(usize, usize, f64)> {
    if range <= 0.0 || !um_per_v.is_finite() {
        return Vec::new();
    }
    let least = least_leap(voltage, range);
    let (inside, broken) = (spikes(voltage, least), spikes(displacement, least * um_per_v));
    let noise = DEVIATIONS * noise_of(displacement).unwrap_or(0.0);
    let goes_along = |&(first, last, leap): &(usize, usize, f64)| {
        // What is broken in both columns, as by a row of another file, shows nothing of the actuator.
        let both = broken.iter().any(|of| of.0 == first && of.1 == last && uncommanded(of));
        !both
            && off_line(displacement, first - 1, (last + SOON).min(displacement.len() - 1))
                > ALONG * um_per_v * leap + noise
    };
    let mut found: Vec<_> = inside.iter().copied().filter(|spike| !goes_along(spike)).collect();
    found.extend(last_row(voltage, &inside, least, AT_REST * range));
    found
}

/// A last row that leaps as none before it, as of a line that was cut in mid-number. What it does to the displacement
/// is not seen. One that goes to within `near` of 0 V, or of where the log began, is a drive that was switched off.
fn last_row(voltage: &[f64], inside: &[(usize, usize, f64)], least: f64, near: f64) -> Option<(usize, usize, f64)> {
    let last = voltage.len() - 1;
    let sound = |row: &usize| inside.iter().all(|of| row + 1 < of.0 || of.1 < *row);
    let step = |row: usize| (voltage[row + 1] - voltage[row]).abs();
    let largest = (0..last - 1).filter(sound).map(step).fold(0.0, f64::max);
    let leap = step(last - 1);
    let rests = [0.0, voltage[0]].into_iter().any(|rest: f64| (voltage[last] - rest).abs() <= near);
    (!rests && sound(&(last - 1)) && leap > least && leap > FURTHER * largest).then_some((last, last, leap))
}

/// How far the values are at most from the straight line between two rows.
fn off_line(values: &[f64], from: usize, to: usize) -> f64 {
    let at = |row: usize| values[from] + (values[to] - values[from]) * (row - from) as f64 / (to - from) as f64;
    (from..=to).map(|row| (values[row] - at(row)).abs()).fold(0.0, f64::max)
}

/// A voltage whose spikes lie on the straight line between the rows beside them; behind a last one there is no row.
pub fn without(voltage: &[f64], spikes: impl Iterator<Item = (usize, usize)>) -> Cow<'_, [f64]> {
    let mut mended = Cow::Borrowed(voltage);
    for (first, last) in spikes {
        debug_assert!(first > 0 && last < first + SPIKE_ROWS);
        let (before, after) = (voltage[first - 1], voltage.get(last + 1).copied().unwrap_or(voltage[first - 1]));
        let rows = (last + 2 - first) as f64;
        for (index, value) in mended.to_mut()[first..=last].iter_mut().enumerate() {
            *value = before + (after - before) * (index + 1) as f64 / rows;
        }
    }
    mended
}
