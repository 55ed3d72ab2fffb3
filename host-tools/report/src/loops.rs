//! Hysteresis loops: displacement over voltage, measured and estimated.

use super::axis::Axis;
use super::svg::{Drawing, Frame};
use super::thin::{Point, gaps, periods, pieces, thin};
use identification::validate::Trace;
use std::ops::RangeInclusive;

/// Points that a period keeps its shape with, thinned.
const POINTS_OF_A_PERIOD: usize = 120;
/// Periods that are drawn for their extremes, typically.
const EXTREME: usize = 4;

/// How many of a log's periods are drawn.
pub struct Drawn {
    /// Periods that are drawn.
    pub periods: usize,
    /// Periods that the log has.
    pub of: usize,
}

/// A log's loops in a frame of a drawing; at most some `limit` points a line. Thinning whole loops would cut their
/// corners, so whole periods are left out: every n-th is drawn, and those with the extremes.
pub fn draw_in(drawing: &mut Drawing, frame: Frame, trace: &Trace, limit: usize) -> Drawn {
    let all = periods(&trace.voltage);
    let of_a_period = (trace.voltage.len() / all.len().max(1)).clamp(1, POINTS_OF_A_PERIOD);
    let every = all.len().div_ceil((limit / of_a_period).saturating_sub(EXTREME).max(1));
    let extremes = [&trace.voltage, &trace.measured, &trace.estimated].map(|values| extremes(values));
    let drawn: Vec<&RangeInclusive<usize>> = all
        .iter()
        .enumerate()
        .filter(|(n, period)| {
            (all.len() - 1 - n).is_multiple_of(every) || extremes.iter().flatten().any(|i| period.contains(i))
        })
        .map(|(_, period)| period)
        .collect();

    let of_each = (limit / drawn.len().max(1)).max(POINTS_OF_A_PERIOD);
    let voltages = Axis::linear(trace.voltage.iter().copied(), 4);
    let displacements = Axis::linear(trace.measured.iter().chain(&trace.estimated).copied(), 4);
    let panel = drawing.panel(frame, voltages, displacements, ("voltage, V", "displacement, µm"));
    let gaps = gaps(&trace.time_s);
    for (class, values) in [("sensor", &trace.measured), ("estimate", &trace.estimated)] {
        for period in &drawn {
            let points: Vec<Point> = (*period).clone().filter_map(|i| point(trace, values, i)).collect();
            for piece in pieces(&points, *period.start(), &gaps) {
                drawing.line(&panel, class, &thin(piece.iter().copied(), of_each));
            }
        }
    }
    drawing.legend(&panel, &[("sensor", "sensor"), ("estimate", "estimate")]);
    Drawn { periods: drawn.len(), of: all.len() }
}

/// Draws a log's loops.
pub fn draw(trace: &Trace, limit: usize) -> (Drawing, Drawn) {
    let mut drawing = Drawing::new(350.0, 262.0, 11.0);
    let drawn = draw_in(&mut drawing, Frame { left: 42.0, top: 22.0, width: 300.0, height: 208.0 }, trace, limit);
    (drawing, drawn)
}

fn point(trace: &Trace, values: &[f64], i: usize) -> Option<Point> {
    Some((*trace.voltage.get(i)?, *values.get(i)?))
}

/// Where the smallest and the largest value are.
fn extremes(values: &[f64]) -> [usize; 2] {
    let finite = || values.iter().enumerate().filter(|(_, x)| x.is_finite());
    let smallest = finite().min_by(|a, b| a.1.total_cmp(b.1));
    let largest = finite().max_by(|a, b| a.1.total_cmp(b.1));
    [smallest, largest].map(|found| found.map_or(0, |(i, _)| i))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 100 Hz sampled at 2 kHz, its amplitude growing, for 2 s.
    fn growing() -> Trace {
        let time_s: Vec<f64> = (1..=4000).map(|k| f64::from(k) * 5e-4).collect();
        let voltage: Vec<f64> = time_s.iter().map(|t| (10.0 + t) * (628.0 * t).sin()).collect();
        Trace { measured: voltage.clone(), estimated: voltage.iter().map(|v| 0.9 * v).collect(), time_s, voltage }
    }

    #[test]
    fn periods_are_left_out_and_those_drawn_are_whole() {
        let (drawing, drawn) = draw(&growing(), 1000);
        assert!((199..=201).contains(&drawn.of) && (40..70).contains(&drawn.periods), "{} {}", drawn.periods, drawn.of);
        let svg = drawing.inline("");
        let lines: Vec<usize> =
            svg.split("points=\"").skip(1).map(|line| line.split('"').next().unwrap().matches(',').count()).collect();
        assert_eq!(lines.len(), 2 * drawn.periods);
        assert!(lines.iter().filter(|&&points| points < 20).count() <= 4, "{lines:?}");
    }
}
