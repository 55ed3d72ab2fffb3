//! The swings of the logs, from a reversal to the next but one: how large and how fast the voltage went, and how far
//! the estimate was off meanwhile. What the training covers, and what the error is where, is read off them.

use super::axis::Axis;
use super::csv::Csv;
use super::number::{number, tick_label};
use super::svg::{Drawing, Frame};
use super::thin::{Point, extent, gaps};
use identification::validate::Comparison;
use log_survey::reversals::reversals;

/// Classes of frequency a decade, and of the swing an octave: round numbers lie in the middle of a class, 1 and 3 and
/// 10 Hz, the whole range and half of it.
const A_DECADE: f64 = 2.0;
/// Smaller swings than the whole range halved so many times are one class.
const HALVINGS: i32 = 4;
/// Circles nearer to one another than this, in parts of an octave, are one.
const ALIKE: f64 = 0.125;

/// One swing between two reversals.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Swing {
    /// Voltage, peak to peak, V.
    pub volts: f64,
    /// One over the time from a reversal to the next but one, Hz.
    pub hertz: f64,
    /// Mean absolute error beside the log's own constant, µm.
    pub off_um: f64,
}

/// The whole swings of a log, none over a gap; a reversal is what goes back by more than `retreat` V.
pub fn swings(log: &Comparison, retreat: f64) -> Vec<Swing> {
    let trace = &log.trace;
    let turns = reversals(&trace.voltage, retreat);
    let gaps = gaps(&trace.time_s);
    let swing = |ends: &[usize]| {
        let &[from, _, to] = ends else { return None };
        // Where the voltage is only seen again, or no more, it need not have turned.
        if gaps.get(gaps.partition_point(|gap| *gap < from)).is_some_and(|gap| *gap <= to + 1) {
            return None;
        }
        let (min, max) = extent(trace.voltage[from..=to].iter().copied())?;
        let errors = trace.estimated[from..to].iter().zip(&trace.measured[from..to]);
        let sum: f64 = errors.map(|(estimate, sensor)| (estimate - sensor - log.mil.offset_um).abs()).sum();
        let hertz = 1.0 / (trace.time_s[to] - trace.time_s[from]);
        let swing = Swing { volts: max - min, hertz, off_um: sum / (to - from) as f64 };
        (hertz.is_finite() && swing.volts > 0.0 && swing.off_um.is_finite()).then_some(swing)
    };
    turns.windows(3).step_by(2).filter_map(swing).collect()
}

/// The errors by swing and frequency.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct BySwing {
    /// Frequencies of the columns.
    pub frequencies: Vec<String>,
    /// The swing of each row, and a cell for each frequency.
    pub rows: Vec<(String, Vec<Option<Cell>>)>,
}

/// Mean absolute errors of a class, µm.
#[derive(Clone, PartialEq, Debug)]
pub struct Cell {
    /// On what was held out; `None` where no such swing was.
    pub held_out: Option<String>,
    /// On what was fitted to; `None` where no such swing was.
    pub training: Option<String>,
}

impl BySwing {
    /// Of swings that were held out and that were fitted to.
    pub fn of(held_out: &[Swing], training: &[Swing]) -> Self {
        let all = || held_out.iter().chain(training);
        let Some((_, widest)) = extent(all().map(|swing| swing.volts)) else { return Self::default() };
        let row = |swing: &Swing| ((widest / swing.volts).log2().round() as i32).min(HALVINGS);
        let column = |swing: &Swing| (A_DECADE * swing.hertz.log10()).round() as i32;
        let classes = |class: &dyn Fn(&Swing) -> i32| {
            let mut classes: Vec<i32> = all().map(class).collect();
            classes.sort_unstable();
            classes.dedup();
            classes
        };
        let mean = |swings: &[Swing], at: (i32, i32)| {
            let inside = || swings.iter().filter(|swing| (row(swing), column(swing)) == at);
            let sum: f64 = inside().map(|swing| swing.off_um).sum();
            (inside().count() > 0).then(|| number(sum / inside().count() as f64))
        };
        let columns = classes(&column);
        let cell = |at| {
            let (held_out, training) = (mean(held_out, at), mean(training, at));
            (held_out.is_some() || training.is_some()).then_some(Cell { held_out, training })
        };
        let named = |class: i32| {
            let volts = volts(widest / 2f64.powi(class));
            if class < HALVINGS { format!("about {volts}") } else { format!("about {volts}, or less") }
        };
        let cells = |class: i32| columns.iter().map(|&column| cell((class, column))).collect();
        Self {
            rows: classes(&row).into_iter().map(|class| (named(class), cells(class))).collect(),
            frequencies: columns.iter().map(|&class| format!("about {}", frequency(class))).collect(),
        }
    }
}

/// A voltage to three digits, without zeros at its end.
fn volts(volts: f64) -> String {
    let last = 10f64.powf(volts.log10().floor() - 2.0);
    format!("{}\u{a0}V", ((volts / last).round() * last * 1e9).round() / 1e9)
}

/// The middle of a class of frequencies, to one digit.
fn frequency(class: i32) -> String {
    let hertz = 10f64.powf(f64::from(class) / A_DECADE);
    let digit = 10f64.powf(hertz.log10().floor());
    format!("{}\u{a0}Hz", tick_label((hertz / digit).round() * digit, digit))
}

/// Where the swings lie, by frequency and size, with the numbers; `None` without any.
pub fn map(held_out: &[Swing], training: &[Swing]) -> Option<(Drawing, Csv)> {
    let all = || held_out.iter().chain(training);
    all().next()?;
    let mut drawing = Drawing::new(350.0, 262.0, 11.0);
    let frame = Frame { left: 42.0, top: 22.0, width: 300.0, height: 208.0 };
    let (hertz, volts) = (all().map(|swing| swing.hertz), all().map(|swing| swing.volts));
    let titles = ("frequency, Hz", "swing, V");
    let panel = drawing.panel(frame, Axis::logarithmic(hertz), Axis::logarithmic(volts), titles);
    let parts = [("learnt", "training", apart(training)), ("error", "held out", apart(held_out))];
    for (class, _, points) in &parts {
        points.iter().for_each(|&point| drawing.circle(&panel, class, point));
    }
    let entries = [("learnt", "training"), ("error", "held out")];
    drawing.legend(&panel, if held_out.is_empty() { &entries[..1] } else { &entries });
    let curves = parts.each_ref().map(|(_, part, points)| (*part, points.as_slice()));
    Some((drawing, Csv::of_curves("what-the-logs-cover", ["frequency_hz", "swing_v"], &curves)))
}

/// Frequency and size of swings, one of those that lie on one another.
fn apart(swings: &[Swing]) -> Vec<Point> {
    let place = |swing: &Swing| [swing.hertz, swing.volts].map(|value| (value.log2() / ALIKE).round() as i64);
    let mut points: Vec<([i64; 2], Point)> =
        swings.iter().map(|swing| (place(swing), (swing.hertz, swing.volts))).collect();
    points.sort_by_key(|(place, _)| *place);
    points.dedup_by_key(|(place, _)| *place);
    points.into_iter().map(|(_, point)| point).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tests::log;
    use super::*;

    #[test]
    fn a_sine_has_swings_of_its_size_and_frequency_and_the_error_beside_its_constant() {
        let mut sine = log("a", 4000, |k| 0.3 + if k % 2 == 0 { 0.1 } else { -0.1 });
        sine.mil.offset_um = 0.3;
        let swings = swings(&sine, 0.8);
        assert!((18..=20).contains(&swings.len()), "{}", swings.len());
        for swing in &swings {
            assert!((swing.volts - 40.0).abs() < 0.1 && (swing.hertz - 10.0).abs() < 0.2, "{swing:?}");
            assert!((swing.off_um - 0.1).abs() < 1e-9, "{swing:?}");
        }
        assert_eq!(apart(&swings).len(), 1, "they lie on one another");
    }

    #[test]
    fn the_noise_of_a_rest_is_no_swing_beside_what_moves() {
        let moving = log("a", 2000, |_| 0.1);
        let mut rest = log("b", 2000, |_| 0.1);
        rest.trace.voltage.iter_mut().enumerate().for_each(|(k, volts)| *volts = if k % 3 == 0 { 0.02 } else { -0.01 });
        let all = || [&moving, &rest].into_iter().flat_map(|log| log.trace.voltage.iter().copied());
        assert!(swings(&rest, super::super::thin::retreat(all(), 0.0)).is_empty());
        assert!(swings(&rest, super::super::thin::retreat(rest.trace.voltage.iter().copied(), 0.05)).is_empty());
        assert!(!swings(&rest, 0.02).is_empty(), "by itself it is");
    }

    #[test]
    fn errors_stand_by_swing_and_frequency() {
        let swing = |volts, hertz, off_um| Swing { volts, hertz, off_um };
        let training = [swing(100.0, 1.0, 0.1), swing(98.0, 1.1, 0.3), swing(51.0, 3.0, 0.5), swing(0.1, 100.0, 0.7)];
        let of = BySwing::of(&[swing(100.0, 0.9, 1.0)], &training);
        assert_eq!(of.frequencies, ["about 1\u{a0}Hz", "about 3\u{a0}Hz", "about 100\u{a0}Hz"]);
        let names: Vec<&str> = of.rows.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["about 100\u{a0}V", "about 50\u{a0}V", "about 6.25\u{a0}V, or less"]);
        let words = |um: &str| Some(um.to_owned());
        assert_eq!(of.rows[0].1[0], Some(Cell { held_out: words("1.00"), training: words("0.200") }));
        assert_eq!(of.rows[1].1, [None, Some(Cell { held_out: None, training: words("0.500") }), None]);
        assert_eq!(BySwing::of(&[], &[]), BySwing::default());
    }
}
