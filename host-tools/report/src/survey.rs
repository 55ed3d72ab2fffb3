//! A log before anything is fitted to it, as a picture: voltage and displacement over time, the loop, and which
//! amplitudes it has at which frequencies.

use super::axis::Axis;
use super::number::quantity;
use super::svg::{Drawing, Frame};
use super::thin::{Point, thin};
use log_survey::{Block, Survey};

/// Points of a line.
const LIMIT: usize = 3000;
/// Lines that the loop is drawn by, at most.
const STRETCHES: usize = 4;

/// A standalone SVG, 900 units wide on white.
pub fn survey(survey: &Survey, title: &str) -> String {
    let mut drawing = Drawing::new(900.0, 700.0, 13.0);
    drawing.heading((14.0, 30.0), title);
    let words = format!(
        "{} rows at {}, {}",
        survey.rows,
        quantity(survey.clock.hz, "Hz"),
        quantity(survey.clock.duration_s, "s")
    );
    drawing.text((14.0, 52.0), "start", &words);
    let frame = |left, top, width| Frame { left, top, width, height: 150.0 };
    over_time(&mut drawing, frame(58.0, 90.0, 828.0), survey, "voltage, V", |block| block.voltage);
    over_time(&mut drawing, frame(58.0, 290.0, 828.0), survey, "displacement, µm", |block| block.displacement);
    hysteresis(&mut drawing, frame(58.0, 500.0, 352.0), survey);
    coverage(&mut drawing, frame(510.0, 500.0, 376.0), survey);
    drawing.standalone(&format!("{title}: {words}"))
}

/// Smallest and largest value of each block over time.
fn over_time(drawing: &mut Drawing, frame: Frame, survey: &Survey, title: &str, of: impl Fn(&Block) -> (f64, f64)) {
    let seconds = survey.rows_a_block as f64 / survey.clock.hz;
    let points: Vec<Point> = survey
        .blocks
        .iter()
        .enumerate()
        .flat_map(|(index, block)| {
            let (time, (low, high)) = (index as f64 * seconds, of(block));
            [(time, low), (time, high)]
        })
        .filter(|(_, value)| value.is_finite())
        .collect();
    let (x, y) = (Axis::tight(points.iter().map(|p| p.0), 6), Axis::linear(points.iter().map(|p| p.1), 4));
    let panel = drawing.panel(frame, x, y, ("time, s", title));
    drawing.line(&panel, "estimate", &thin(points, LIMIT));
}

/// Displacement over voltage: stretches of rows next to each other, evenly spread over the log.
fn hysteresis(drawing: &mut Drawing, frame: Frame, survey: &Survey) {
    let rows = survey.blocks.iter().map(|block| block.first).filter(|(v, y)| v.is_finite() && y.is_finite());
    let points: Vec<Point> = rows.collect();
    let x = Axis::linear(points.iter().map(|p| p.0), 4);
    let y = Axis::linear(points.iter().map(|p| p.1), 4);
    let panel = drawing.panel(frame, x, y, ("voltage, V", "displacement, µm"));
    for part in points.chunks(points.len().div_ceil(STRETCHES).max(1)) {
        drawing.line(&panel, "error", &part[..part.len().min(LIMIT)]);
    }
}

/// Half cycles by amplitude and frequency.
fn coverage(drawing: &mut Drawing, frame: Frame, survey: &Survey) {
    let cells = &survey.swings.cells;
    let x = Axis::logarithmic(cells.iter().flat_map(|cell| [cell.frequency_hz.0, cell.frequency_hz.1]));
    let y = Axis::linear(cells.iter().flat_map(|cell| [cell.amplitude_v.0, cell.amplitude_v.1]).chain([0.0]), 4);
    let panel = drawing.panel(frame, x, y, ("frequency of half cycles, Hz", "amplitude, V"));
    for cell in cells {
        let (from, to) = (cell.frequency_hz.0, cell.frequency_hz.1);
        drawing.bar(&panel, "share", (from, cell.amplitude_v.0), (to, cell.amplitude_v.1));
    }
}
