//! A whole log as numbers, for a script that draws it to zoom into and for whoever wants them in another program: real
//! rows of the log, of a long one those that its curves are known by.

use super::csv::{Csv, decimals};
use super::thin::extent;
use identification::validate::Trace;

/// Rows of all logs together: what keeps the page small.
const ROWS: usize = 5_000;
/// Most rows of a log.
const ROWS_OF_A_LOG: usize = 2_500;
/// Rows that a stretch of a log is known by: its first, and those of the least and the largest of three curves.
const A_STRETCH: usize = 7;
/// A value is written to this part of its column's span, finer than a converter of 16 bits.
const RESOLUTION: f64 = 1e-5;
/// And a time to this part of the rows' distance.
const TIME_RESOLUTION: f64 = 0.1;

/// A log's rows in seconds, V, µm and µm, one of so many logs: all, or in each stretch its first and those at which
/// voltage, sensor and error are least and largest.
pub fn csv(trace: &Trace, name: &str, role: &str, logs: usize) -> Csv {
    let rows = rows(trace, (ROWS / logs.max(1)).clamp(A_STRETCH, ROWS_OF_A_LOG));
    let period = trace.time_s.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
    let places = |resolution: f64| (-resolution.log10()).ceil().clamp(0.0, 9.0) as usize;
    let of_span = |values: &[f64]| {
        let span = extent(values.iter().copied()).map_or(0.0, |(min, max)| max - min);
        places(if span > 0.0 { RESOLUTION * span } else { RESOLUTION })
    };
    let time = places(if period > 0.0 { TIME_RESOLUTION * period } else { RESOLUTION });
    // What spans more is a spike or an estimate that runs away, and takes no digit from the other.
    let (volts, um) = (of_span(&trace.voltage), of_span(&trace.measured).max(of_span(&trace.estimated)));
    let written = rows.iter().map(|&row| {
        let number = |values: &[f64], places| decimals(values[row], places);
        let [sensor, estimate] = [&trace.measured, &trace.estimated].map(|values| number(values, um));
        vec![number(&trace.time_s, time), number(&trace.voltage, volts), sensor, estimate]
    });
    let (kept, of) = (rows.len(), trace.time_s.len());
    let thinned = if kept < of { "-thinned" } else { "" };
    let columns = ["time_s", "voltage_v", "sensor_um", "estimate_um"];
    // One row is no stretch to zoom into.
    Csv { rows: (kept > 1).then_some((kept, of)), ..Csv::new(&format!("{name}-{role}{thinned}"), &columns, written) }
}

/// The rows that are kept, at most `limit` where it is at least [`A_STRETCH`].
fn rows(trace: &Trace, limit: usize) -> Vec<usize> {
    let count = [&trace.voltage, &trace.measured, &trace.estimated]
        .map(Vec::len)
        .into_iter()
        .fold(trace.time_s.len(), usize::min);
    let all: Vec<usize> = (0..count).filter(|&row| trace.time_s[row].is_finite()).collect();
    if all.len() <= limit {
        return all;
    }
    let curves: [&dyn Fn(usize) -> f64; 3] =
        [&|row| trace.voltage[row], &|row| trace.measured[row], &|row| trace.estimated[row] - trace.measured[row]];
    let mut kept = Vec::with_capacity(limit);
    for stretch in all.chunks(all.len().div_ceil(limit / A_STRETCH)) {
        let mut of_stretch = vec![stretch[0]];
        for curve in curves {
            let finite = || stretch.iter().copied().filter(|&row| curve(row).is_finite());
            of_stretch.extend(finite().min_by(|&a, &b| curve(a).total_cmp(&curve(b))));
            of_stretch.extend(finite().max_by(|&a, &b| curve(a).total_cmp(&curve(b))));
        }
        of_stretch.sort_unstable();
        of_stretch.dedup();
        kept.extend(of_stretch);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::super::tests::log;
    use super::*;

    #[test]
    fn a_long_log_is_known_by_its_extremes_and_a_short_one_by_all_its_rows() {
        let mut long = log("a", 40_000, |k| if k == 23_456 { 9.0 } else { 0.1 }).trace;
        long.voltage[12_345] = 77.0;
        long.measured[3] = f64::NAN;
        let kept = rows(&long, 1000);
        assert!(kept.len() <= 1000 && kept.len() > 500, "{}", kept.len());
        assert!(
            [0, 12_345, 23_456].iter().all(|row| kept.contains(row)) && kept.windows(2).all(|pair| pair[0] < pair[1])
        );
        let of_five = csv(&long, "a", "held out", 5);
        assert_eq!((of_five.file.as_str(), of_five.rows), ("a-held-out-thinned.csv", Some((kept.len(), 40_000))));
        assert!(of_five.address.contains("%0A6.173,77,"), "{}", &of_five.address[..200]);

        let short = csv(&log("b", 3, |_| 0.5).trace, "b", "training", 1);
        assert_eq!((short.file.as_str(), short.rows), ("b-training.csv", Some((3, 3))));
        let start = "data:text/csv,time_s,voltage_v,sensor_um,estimate_um%0A0.0005,0.";
        assert!(short.address.starts_with(start) && short.address.matches("%0A").count() == 4, "{}", short.address);
        assert_eq!(csv(&log("c", 1, |_| 0.5).trace, "c", "held out", 1).rows, None);
    }
}
