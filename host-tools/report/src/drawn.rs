//! The figures of the thesis that `piezo reproduce` draws anew, as SVG within a page.

use super::axis::Axis;
use super::svg::{Drawing, Frame};
use super::thin::{Point, last_periods, thin};
use super::{errors, loops, rows, traces};
use identification::Convergence;
use identification::validate::Comparison;

/// Points of a line: six logs of three panels and a dozen traces stay below a megabyte.
const POINTS: usize = 600;

/// Sensor and estimate over time, and the error below (Figures 4.11, 5.1 to 5.6); the caption. `None` where there is
/// nothing to draw.
pub fn over_time(log: &Comparison, name: &str) -> Option<(String, String)> {
    if log.trace.time_s.is_empty() {
        return None;
    }
    let (drawing, ..) = traces::draw(&log.trace, Vec::new(), POINTS);
    let caption = format!("On {}. {}", log.name, rows::sentence(log));
    let label = format!("Displacement over time, {name}: sensor, estimate, error. {caption}");
    Some((drawing.inline(&label), caption))
}

/// Errors after each generation (Figures 4.9, 4.10). `None` where there is nothing to draw.
pub fn convergence(course: &[Convergence], label: &str) -> Option<String> {
    Some(errors::convergence(course, "generation", POINTS)?.0.inline(label))
}

/// Errors (µm) over the sampling time (ms), ours and the thesis's, the smallest of each circled (Figure 4.8).
pub fn sampling_times(ours: &[Point], thesis: &[Point], label: &str) -> String {
    let mut drawing = Drawing::new(350.0, 262.0, 11.0);
    let frame = Frame { left: 42.0, top: 22.0, width: 300.0, height: 208.0 };
    let all = || ours.iter().chain(thesis);
    let times = Axis::logarithmic(all().map(|point| point.0));
    let errors = Axis::linear(all().map(|point| point.1).chain([0.0]), 4);
    let panel = drawing.panel(frame, times, errors, ("sampling time, ms", "MAE, µm"));
    for (class, line) in [("training", thesis), ("estimate", ours)] {
        drawing.line(&panel, class, line);
        if let Some(&least) = line.iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
            drawing.circle(&panel, class, least);
        }
    }
    drawing.legend(&panel, &[("estimate", "here"), ("training", "thesis")]);
    drawing.inline(label)
}

/// Voltage and displacement over the log's last periods, and the loop (three figures of Appendix B), each with the
/// estimate; the caption. `None` where there is nothing to draw.
pub fn appendix_b(log: &Comparison, name: &str) -> Option<(String, String)> {
    let trace = &log.trace;
    if trace.time_s.is_empty() {
        return None;
    }
    let frame = |top, height| Frame { left: 42.0, top, width: 300.0, height };
    let mut drawing = Drawing::new(350.0, 560.0, 11.0);
    let detail = last_periods(&trace.voltage);
    let line = |values: &[f64]| -> Vec<Point> {
        let points = trace.time_s.iter().copied().zip(values.iter().copied());
        points.skip(*detail.start()).take(detail.end() - detail.start() + 1).collect()
    };
    let lines = [&trace.voltage, &trace.measured, &trace.estimated].map(|values| line(values));
    let [voltage, measured, estimated] = &lines;
    let time = || Axis::tight(voltage.iter().map(|point| point.0), 3);
    let values = |lines: &[&Vec<Point>]| -> Vec<f64> { lines.iter().copied().flatten().map(|point| point.1).collect() };
    let volts = Axis::linear(values(&[voltage]), 3);
    let upper = drawing.panel(frame(22.0, 90.0), time(), volts, ("", "voltage, V"));
    drawing.line(&upper, "error", &thin(voltage.iter().copied(), POINTS));
    let displacements = Axis::linear(values(&[measured, estimated]), 3);
    let middle = drawing.panel(frame(136.0, 110.0), time(), displacements, ("time, s", "displacement, µm"));
    drawing.line(&middle, "sensor", &thin(measured.iter().copied(), POINTS));
    drawing.line(&middle, "estimate", &thin(estimated.iter().copied(), POINTS));
    drawing.legend(&middle, &[("sensor", "sensor"), ("estimate", "estimate")]);
    loops::draw_in(&mut drawing, frame(316.0, 208.0), trace, POINTS);
    let end = |point: Option<&Point>| point.map_or(0.0, |(time, _)| *time);
    let (from, to) = (end(voltage.first()), end(voltage.last()));
    let caption = format!(
        "Voltage and displacement from {from:.3} to {to:.3} s, and the whole log's loops. {}",
        rows::sentence(log)
    );
    Some((drawing.inline(&format!("{name}. {caption}")), caption))
}
