//! Time traces: the estimate on the sensor over the last periods, the error below it, and the error over the whole log.

use super::axis::Axis;
use super::svg::{Drawing, Frame, Panel};
use super::thin::{OF_A_PIECE, Point, gaps, last_periods, pieces, thin};
use identification::validate::{Estimates, Instant, Trace};
use std::ops::RangeInclusive;

/// Lines over time.
pub struct Lines {
    measured: Vec<Point>,
    estimated: Vec<Point>,
    error: Vec<Point>,
    /// Half-width of the interval, where it is drawn round the error.
    half_width: Vec<Point>,
    /// Stretches of time that are no measurement, s.
    flaws: Vec<(f64, f64)>,
}

impl Lines {
    /// A log's lines.
    pub fn of(trace: &Trace) -> Self {
        let over_time = |values: &[f64]| trace.time_s.iter().copied().zip(values.iter().copied()).collect();
        let error: Vec<f64> = trace.estimated.iter().zip(&trace.measured).map(|(e, m)| e - m).collect();
        Self {
            measured: over_time(&trace.measured),
            estimated: over_time(&trace.estimated),
            error: over_time(&error),
            half_width: Vec::new(),
            flaws: Vec::new(),
        }
    }

    /// The same with the error and the half-width since a zero, as `zeroed` has them of the same log: what it does not
    /// score is not drawn.
    pub fn since_zero(self, zeroed: &Estimates) -> Self {
        // A trace may begin later in the log.
        let rows = zeroed.instants.iter().skip(zeroed.instants.len().saturating_sub(self.error.len()));
        let scored = |value: Option<f64>, scored: bool| value.filter(|_| scored).unwrap_or(f64::NAN);
        let error = |row: &Instant| (row.time_s, scored(row.error(), row.scored));
        let half_width = |row: &Instant| (row.time_s, scored(row.half_width, row.scored));
        Self { error: rows.clone().map(error).collect(), half_width: rows.map(half_width).collect(), ..self }
    }

    /// Some of their points.
    pub fn cut(&self, points: &RangeInclusive<usize>) -> Self {
        let cut = |line: &[Point]| line.get(points.clone()).unwrap_or_default().to_vec();
        Self {
            measured: cut(&self.measured),
            estimated: cut(&self.estimated),
            error: cut(&self.error),
            half_width: cut(&self.half_width),
            flaws: self.flaws.clone(),
        }
    }

    /// First and last instant, s.
    pub fn span(&self) -> (f64, f64) {
        let time = |point: Option<&Point>| point.map_or(0.0, |(time, _)| *time);
        (time(self.error.first()), time(self.error.last()))
    }

    /// Draws sensor and estimate, without labels of the time, which the panel below has.
    pub fn displacement(&self, drawing: &mut Drawing, frame: Frame, limit: usize) -> Panel {
        let values = self.measured.iter().chain(&self.estimated).map(|point| point.1);
        let panel = drawing.panel(frame, self.time(), Axis::linear(values, 3), ("", "displacement, µm"));
        line(drawing, &panel, "sensor", &self.measured, limit);
        line(drawing, &panel, "estimate", &self.estimated, limit);
        panel
    }

    /// Draws the error, in the band of its interval where there is one, and marks a part of the time.
    pub fn error(&self, drawing: &mut Drawing, frame: Frame, limit: usize, title: &str, mark: Option<(f64, f64)>) {
        let half_widths = self.half_width.iter().map(|point| point.1).filter(|half| half.is_finite());
        let errors =
            self.error.iter().map(|point| point.1).chain(half_widths.flat_map(|half| [half, -half])).chain([0.0]);
        let panel = drawing.panel(frame, self.time(), Axis::linear(errors, 2), ("time, s", title));
        if let Some((from, to)) = mark {
            drawing.window(&panel, "window", from, to);
        }
        for (from, to) in &self.flaws {
            drawing.window(&panel, "flaw", *from, *to);
        }
        let pieces = between_gaps(&self.half_width, limit);
        for piece in pieces.iter().filter(|piece| piece.iter().any(|(_, half)| half.is_finite())) {
            let side = |sign: f64| thin(piece.iter().map(|&(time, half)| (time, sign * half)), limit / pieces.len());
            drawing.band(&panel, "band", &side(1.0), &side(-1.0));
        }
        line(drawing, &panel, "error", &self.error, limit);
        drawing.zero(&panel);
    }

    fn time(&self) -> Axis {
        Axis::tight(self.error.iter().map(|point| point.0), 3)
    }
}

/// What lies between gaps; a log that was read in bursts, of which too few points would be drawn of each, is one piece.
fn between_gaps(points: &[Point], limit: usize) -> Vec<&[Point]> {
    let gaps = gaps(&points.iter().map(|point| point.0).collect::<Vec<_>>());
    pieces(points, 0, if (gaps.len() + 1) * OF_A_PIECE > limit { &[] } else { &gaps })
}

/// Draws a line over time, broken where nothing was measured.
fn line(drawing: &mut Drawing, panel: &Panel, class: &str, points: &[Point], limit: usize) {
    let pieces = between_gaps(points, limit);
    for piece in &pieces {
        drawing.line(panel, class, &thin(piece.iter().copied(), limit / pieces.len()));
    }
}

/// Title of an error's axis.
pub const ERROR: &str = "estimate − sensor, µm";

/// Draws a log, and where it is no measurement; at most `limit` points a line. Also the seconds that are shown in
/// detail, where not all are, and whether any such place is drawn.
pub fn draw(trace: &Trace, flaws: Vec<(f64, f64)>, limit: usize) -> (Drawing, Option<(f64, f64)>, bool) {
    let lines = Lines::of(trace);
    let (first, last) = lines.span();
    let mut flaws: Vec<(f64, f64)> = flaws.into_iter().filter(|(from, to)| *to >= first && *from <= last).collect();
    flaws.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Next to another they are one mark.
    flaws.dedup_by(|next, kept| {
        let near = next.0 - kept.1 < (last - first) / MARKS;
        if near {
            kept.1 = kept.1.max(next.1);
        }
        near
    });
    let flawed = !flaws.is_empty();
    let all = Lines { flaws, ..lines };
    let detail = last_periods(&trace.voltage);
    let shown = all.cut(&detail);
    let mark = (*detail.start() > 0).then(|| shown.span());
    let frame = |top, height| Frame { left: 42.0, top, width: 300.0, height };
    let mut drawing = Drawing::new(350.0, if mark.is_some() { 390.0 } else { 290.0 }, 11.0);
    let upper = shown.displacement(&mut drawing, frame(22.0, 140.0), limit);
    drawing.legend(&upper, &[("sensor", "sensor"), ("estimate", "estimate")]);
    shown.error(&mut drawing, frame(186.0, 70.0), limit, ERROR, None);
    if mark.is_some() {
        all.error(&mut drawing, frame(308.0, 48.0), limit, "the same over the whole log, µm", mark);
    }
    (drawing, mark, flawed)
}

/// Marks that the width of a drawing has room for.
const MARKS: f64 = 150.0;
