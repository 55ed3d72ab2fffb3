//! One log as a picture of its own, for a README: loop on the left, the last periods and their error on the right,
//! where there is an interval in its band.

use super::error::ReportError;
use super::svg::{Drawing, Frame};
use super::traces::{ERROR, Lines};
use super::{loops, rows, thin};
use identification::validate::{Comparison, Estimates};

const LIMIT: usize = 1500;

/// How a log's estimates went on since a zero.
#[derive(Clone, Debug)]
pub struct Zeroed {
    /// When it was, s.
    pub at_s: f64,
    /// The estimates with their half-width.
    pub estimates: Estimates,
    /// The half-width is that of a table that was learnt from this log, too.
    pub learnt: bool,
}

/// A standalone SVG, 900 units wide on white: the estimate against the sensor, and on an axis of its own the error:
/// since a zero and within ± where there was one, else as it is.
///
/// # Errors
/// [`ReportError::Nothing`] where the log has no measured instant after its first.
pub fn picture(comparison: &Comparison, title: &str, zeroed: Option<&Zeroed>) -> Result<String, ReportError> {
    let trace = &comparison.trace;
    if trace.time_s.is_empty() {
        return Err(ReportError::Nothing { log: comparison.name.clone() });
    }
    let mut drawing = Drawing::new(900.0, 430.0, 14.0);
    drawing.heading((14.0, 30.0), title);
    let errors = zeroed.and_then(|_| rows::without_constant(comparison));
    let errors = errors.unwrap_or_else(|| rows::mean_and_largest(&comparison.mil));
    drawing.text((14.0, 53.0), "start", &errors);

    loops::draw_in(&mut drawing, Frame { left: 58.0, top: 92.0, width: 352.0, height: 290.0 }, trace, LIMIT);
    let lines = Lines::of(trace);
    let (lines, error, band) = match zeroed {
        Some(Zeroed { at_s, estimates, learnt }) => {
            let banded = estimates.instants.iter().any(|instant| instant.half_width.is_some());
            let band = match (banded, *learnt) {
                (false, _) => "",
                (true, false) => "Shaded: the ± of the table",
                (true, true) => "Shaded: the ± of the table once it had learnt this log",
            };
            (lines.since_zero(estimates), format!("{ERROR}, since a zero at {at_s:.1} s"), band)
        }
        None => (lines, ERROR.to_owned(), ""),
    };
    let shown = lines.cut(&thin::last_periods(&trace.voltage));
    let frame = |top, height| Frame { left: 486.0, top, width: 400.0, height };
    let upper = shown.displacement(&mut drawing, frame(92.0, 112.0), LIMIT);
    drawing.legend(&upper, &[("sensor", "sensor"), ("estimate", "estimate")]);
    // A line of its own above the axis's title, which has no room for it.
    drawing.text((441.0, 232.0), "start", band);
    shown.error(&mut drawing, frame(260.0, 122.0), LIMIT, &error, None);
    Ok(drawing.standalone(&format!("{title}: {errors}")))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check, log};
    use super::*;
    use estimator_core::Status;
    use identification::validate::Instant;

    /// What a zero leaves of the error lies in its band; what came before the zero is not drawn, nor is a band where
    /// there is none.
    #[test]
    fn the_error_since_a_zero_stands_in_its_band() {
        let beside = log("a", 2000, |_| 0.1);
        let instants = |half_width: Option<f64>| {
            let rows = beside.trace.time_s.iter().zip(&beside.trace.measured);
            let rows = rows.map(|(&time_s, &displacement)| Instant {
                time_s,
                voltage: 0.0,
                displacement: Some(displacement),
                estimate: displacement + 0.01,
                half_width,
                status: Status::empty(),
                scored: time_s > 0.9,
            });
            Estimates { log: "a".to_owned(), instants: rows.collect(), zero: None, starts_um: None, left_out: 0 }
        };
        let drawn = |half_width, learnt| {
            let zeroed = Zeroed { at_s: 0.9, estimates: instants(half_width), learnt };
            picture(&beside, "a", Some(&zeroed)).unwrap()
        };
        let (with, without) = (drawn(Some(0.2), false), drawn(None, false));
        let learnt = drawn(Some(0.2), true);
        assert!(with.contains("Shaded: the ± of the table<") && learnt.contains("once it had learnt this log"));
        check(&with, &[]);
        assert!(with.contains("since a zero at 0.9 s") && with.contains(r#"<polygon class="band""#));
        assert!(!without.contains("<polygon") && !without.contains("Shaded"));
        for text in learnt.split("<text x=").skip(1).filter(|text| text.contains("\"start\"")) {
            let (x, words) = (text.split('"').nth(1).unwrap(), text.split(['<', '>']).nth(1).unwrap());
            let end = x.parse::<f64>().unwrap() + words.chars().count() as f64 * 0.55 * 14.0;
            assert!(end < 900.0, "'{words}' ends at {end}");
        }
        let points = |svg: &str| {
            svg.split(r#"class="error" points=""#).nth(1).unwrap().split('"').next().unwrap().matches(',').count()
        };
        assert_eq!(points(&with), 200);
    }
}
