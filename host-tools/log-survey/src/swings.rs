//! The voltage's reversals, and the half cycles between them: which amplitudes a log has at which frequencies.

use serde::Serialize;

use crate::blocks::{Block, BlocksView};
use crate::reversals::reversals;
use crate::series::Series;
use recordings::log::bridge;

/// Smallest half cycle, as a part of the voltage's range.
const PART: f64 = 0.02;
/// A half cycle is larger than so many standard deviations of the noise.
const DEVIATIONS: f64 = 8.0;
/// Classes of amplitude have their edges, as parts of the largest there can be, between those that people record at:
/// tenths, quarters, thirds.
const PARTS: [f64; 7] = [0.0, 0.15, 0.37, 0.55, 0.72, 0.87, 1.0];

/// The voltage's reversals and half cycles.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Swings {
    /// How often the voltage turns.
    pub reversals: usize,
    /// Smallest swing that counts, V from one reversal to the next.
    pub threshold_v: f64,
    /// Half cycles by amplitude and frequency, those that there are; none over a gap of the time stamps.
    pub cells: Vec<Cell>,
}

/// Half cycles of one class.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cell {
    /// Amplitudes from … to, V: half of what the voltage goes from reversal to reversal.
    pub amplitude_v: (f64, f64),
    /// Frequencies from … to, Hz: one over twice the time from reversal to reversal.
    pub frequency_hz: (f64, f64),
    /// How many half cycles.
    pub half_cycles: usize,
}

/// Finds them in the blocks of a log of this voltage and sample period, s, with gaps before these rows.
pub(crate) fn find(blocks: BlocksView<'_>, voltage: &Series, period: f64, gaps: &[u64]) -> Swings {
    let range = voltage.high - voltage.low;
    let threshold_v = (PART * range).max(DEVIATIONS * voltage.noise);
    if range <= 0.0 || !period.is_finite() {
        return Swings { threshold_v, ..Swings::default() };
    }
    let turns = turns(blocks, threshold_v);
    let mut cells: Vec<((usize, i32), usize)> = Vec::new();
    let over_a_gap = |pair: &&[(f64, f64)]| gaps.iter().any(|&row| pair[0].0 < row as f64 && row as f64 <= pair[1].0);
    for pair in turns.windows(2).filter(|pair| !over_a_gap(pair)) {
        let amplitude = (pair[1].1 - pair[0].1).abs() / 2.0;
        let seconds = (pair[1].0 - pair[0].0) * period;
        let class = (amplitude_class(amplitude, range), frequency_class(0.5 / seconds));
        match cells.iter_mut().find(|(other, _)| *other == class) {
            Some((_, count)) => *count += 1,
            None => cells.push((class, 1)),
        }
    }
    cells.sort_unstable();
    let cell = |((amplitude, frequency), half_cycles): ((usize, i32), usize)| Cell {
        amplitude_v: (amplitude_edge(amplitude, range), amplitude_edge(amplitude + 1, range)),
        frequency_hz: (frequency_edge(frequency), frequency_edge(frequency + 1)),
        half_cycles,
    };
    Swings { reversals: turns.len().saturating_sub(2), threshold_v, cells: cells.into_iter().map(cell).collect() }
}

/// The log's start, its reversals and the furthest that it goes behind the last of them, as rows and voltages; the
/// start alone where the voltage goes nowhere.
fn turns(blocks: BlocksView<'_>, threshold: f64) -> Vec<(f64, f64)> {
    let in_order = |block: &Block| {
        let (low, high) = block.voltage;
        if block.rising { [low, high] } else { [high, low] }
    };
    let mut voltages: Vec<f64> = blocks.blocks.iter().flat_map(in_order).collect();
    bridge([&mut voltages[..]]);
    // The second of a block's two stands in its middle, unless it is the same row.
    let second = if blocks.rows_a_block > 1 { 0.5 } else { 0.0 };
    let place = |index: usize| (index / 2) as f64 + (index % 2) as f64 * second;
    let point = |index: usize| (place(index) * blocks.rows_a_block as f64, voltages[index]);
    let mut turns = if voltages.is_empty() { Vec::new() } else { vec![0] };
    turns.extend(reversals(&voltages, threshold));
    if let Some(&last) = turns.last() {
        let distance = |index: &usize| (voltages[*index] - voltages[last]).abs();
        let furthest = (last..voltages.len()).max_by(|one, other| distance(one).total_cmp(&distance(other)));
        turns.extend(furthest.filter(|index| turns.len() > 1 || distance(index) >= threshold));
    }
    turns.into_iter().map(point).collect()
}

fn amplitude_class(amplitude: f64, range: f64) -> usize {
    PARTS[1..PARTS.len() - 1].iter().filter(|part| amplitude > **part * range / 2.0).count()
}

fn amplitude_edge(class: usize, range: f64) -> f64 {
    range / 2.0 * PARTS[class]
}

/// Classes of frequency have their edges between those that people record at: at 1.4, 4.5, 14, 45, …
const EDGES: [f64; 2] = [1.4, 4.5];

fn frequency_class(hz: f64) -> i32 {
    let decade = (hz / EDGES[0]).log10().floor();
    let decade = decade.clamp(-12.0, 12.0) as i32;
    2 * decade + i32::from(hz >= EDGES[1] * 10_f64.powi(decade))
}

fn frequency_edge(class: i32) -> f64 {
    10_f64.powi(class.div_euclid(2)) * EDGES[class.rem_euclid(2) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::Blocks;

    #[test]
    fn a_half_cycle_over_a_gap_has_no_frequency() {
        let mut blocks = Blocks::default();
        let wave = |row: u32| (std::f64::consts::TAU * 0.01 * f64::from(row)).sin();
        (0..1000).for_each(|row| blocks.add(wave(row), 0.0));
        let voltage = Series { low: -1.0, high: 1.0, ..Series::default() };
        let counted = |gaps: &[u64]| {
            let swings = find(blocks.all(), &voltage, 1e-3, gaps);
            swings.cells.iter().map(|cell| cell.half_cycles).sum::<usize>()
        };
        assert_eq!(counted(&[]) - counted(&[501]), 1);
    }

    #[test]
    fn what_people_record_at_lies_within_a_class_and_not_at_its_edge() {
        for part in [1.0, 0.9, 0.8, 0.75, 0.67, 0.6, 0.5, 0.4, 0.33, 0.3, 0.25, 0.2, 0.1] {
            let class = |of: f64| amplitude_class(of * part * 50.0, 100.0);
            assert_eq!([class(0.975), class(1.025)], [class(1.0); 2], "{part}");
            let edges = [amplitude_edge(class(1.0), 100.0), amplitude_edge(class(1.0) + 1, 100.0)];
            assert!(edges[0] < part * 50.0 && part * 50.0 <= edges[1], "{part}: {edges:?}");
        }
    }

    #[test]
    fn a_swing_that_goes_from_one_side_of_the_start_to_the_other_is_one() {
        let mut blocks = Blocks::default();
        [0.0, 0.8, -0.8, 10.0, 9.5].iter().for_each(|&volts| blocks.add(volts, 0.0));
        assert_eq!(turns(blocks.all(), 1.0), [(0.0, 0.0), (2.0, -0.8), (3.0, 10.0)]);
        assert_eq!(turns(blocks.all(), 11.0), [(0.0, 0.0)], "it goes nowhere");
    }
}
