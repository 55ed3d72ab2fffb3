//! Values that leap away and back within a few rows, or where a log begins or ends.

/// Fewest rows of one number that are a stretch; twice as many are what is near an end.
pub const ROWS: usize = 8;
/// Most rows of a spike.
pub(crate) const SPIKE_ROWS: usize = 3;
/// Most rows of a glitch, which leaps away in one row and back in another.
pub(crate) const GLITCH_ROWS: usize = 60;
/// A spike leaps by this many times the steps that all but one in 20 are within,
const STEPS: f64 = 6.0;
/// and by this part of the range,
const LEAP: f64 = 0.05;
/// and comes back to where it left by this part of its leap.
pub const BACK: f64 = 0.3;
/// A leap of up to this many times (stroke/voltage range) × (how far the voltage leaps near it) is the voltage's.
pub const EXPLAINED: f64 = 2.0;

/// The least leap of a spike.
pub fn least_leap(values: &[f64], range: f64) -> f64 {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    let usual = steps.len() - 1 - steps.len() / 20;
    let usual = *steps.select_nth_unstable_by(usual, f64::total_cmp).1;
    (STEPS * usual).max(LEAP * range)
}

/// Leaps of the displacement that the voltage explains, µm.
#[derive(Clone, Copy)]
pub(crate) struct Explained {
    /// In the first rows.
    pub start_um: f64,
    /// In the last rows.
    pub end_um: f64,
}

impl Explained {
    /// By the largest step of the voltage (V) near each end, at so many µm/V; before the first row the
    /// voltage was `before_v`.
    pub fn of(voltage: &[f64], before_v: f64, um_per_v: f64) -> Self {
        let (count, near) = (voltage.len(), (2 * ROWS).min(voltage.len()));
        let step = |of: &[f64]| of.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        let um = |step_v: f64| if step_v > 0.0 { EXPLAINED * um_per_v * step_v } else { 0.0 };
        let first = voltage.first().map_or(0.0, |v| (v - before_v).abs());
        Self { start_um: um(step(&voltage[..near]).max(first)), end_um: um(step(&voltage[count - near..])) }
    }
}

/// First and last row of a leap within the first rows, and of one within the last, and how far it is: further than the
/// voltage explains. Before the log that may have been 0 V.
pub fn at_ends(values: &[f64], explained: Explained, least: f64) -> [Option<(usize, usize, f64)>; 2] {
    let count = values.len();
    let leaps = |from_end: &dyn Fn(usize) -> f64, explained: f64| {
        // The longest first: rows that are broken differently leap among themselves, too.
        (1..=SPIKE_ROWS).rev().find_map(|rows| {
            let leap = (0..rows).map(|row| (from_end(row) - from_end(rows)).abs()).fold(f64::INFINITY, f64::min);
            (leap > least + explained).then_some((rows, leap))
        })
    };
    let start = leaps(&|row| values[row], explained.start_um);
    let end = leaps(&|row| values[count - 1 - row], explained.end_um);
    [start.map(|(rows, leap)| (0, rows - 1, leap)), end.map(|(rows, leap)| (count - rows, count - 1, leap))]
}

/// First and last row of each glitch, and its leap: longer than a [spike](spikes), it leaps by more than so much at
/// once, and as far back at once; in between it goes on as the actuator does. No step of the voltage (V), up to `late`
/// rows before, explains either leap at so many µm/V.
pub fn glitches(values: &[f64], least: f64, voltage: &[f64], um_per_v: f64, late: usize) -> Vec<(usize, usize, f64)> {
    let step = |row: usize| values[row] - values[row - 1];
    // Beside the motion in the rows before and behind. A leap is such a row of its neighbours; the steepest is meant.
    let leap = |row: usize| step(row) - 0.5 * (step(row - 1) + step(row + 1));
    let steepest = |row: usize| step(row).abs() >= step(row - 1).abs().max(step(row + 1).abs());
    let explained = |row: usize| {
        let near = &voltage[row.saturating_sub(late + 1)..(row + ROWS).min(voltage.len())];
        let volts = near.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        volts > 0.0 && leap(row).abs() <= EXPLAINED * um_per_v * volts
    };
    let is_edge = |&row: &usize| steepest(row) && leap(row).abs() > least && !explained(row);
    let edges: Vec<usize> = (2..values.len().saturating_sub(1)).filter(is_edge).collect();
    let (mut found, mut edges) = (Vec::new(), edges.as_slice());
    while let [away, rest @ ..] = edges {
        edges = rest;
        let Some(back) = rest.first() else { break };
        let [there, here] = [away, back].map(|row| leap(*row));
        let size = there.abs().min(here.abs());
        if there * here < 0.0 && (there + here).abs() < BACK * size && back - away <= GLITCH_ROWS {
            edges = &rest[1..];
            if back - away > SPIKE_ROWS {
                found.push((*away, back - 1, size));
            }
        }
    }
    found
}

/// First and last row of each spike that leaps by more than so much and back, and its leap.
pub fn spikes(values: &[f64], least: f64) -> Vec<(usize, usize, f64)> {
    let mut found = Vec::new();
    let mut row = 1;
    while row < values.len() {
        let before = values[row - 1];
        let spike = (1..=SPIKE_ROWS).find_map(|rows| {
            let after = *values.get(row + rows)?;
            let leap = values[row..row + rows].iter().map(|value| (value - before).abs()).fold(f64::INFINITY, f64::min);
            let back = (values[row + rows - 1] - after).abs();
            (leap > least && back > least && (after - before).abs() < BACK * leap).then_some((rows, leap))
        });
        match spike {
            Some((rows, leap)) => {
                found.push((row, row + rows - 1, leap));
                row += rows + 1;
            }
            None => row += 1,
        }
    }
    found
}
