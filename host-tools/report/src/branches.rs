//! The mean error over the voltage, where it rises and where it falls: what both branches share is a mean curve that is
//! bent otherwise than the model's, what tells them apart is hysteresis that the model has too much or too little of.

use super::axis::Axis;
use super::csv::Csv;
use super::svg::{Drawing, Frame};
use super::thin::{Point, extent, gaps};
use identification::validate::Comparison;
use log_survey::reversals::reversals;

/// Parts of the voltage's range.
const BINS: usize = 30;
/// Fewer samples than this in a part are no mean.
const FEW: usize = 5;

/// A sum of errors and what it is of.
#[derive(Clone, Copy, Default)]
struct Sum {
    um: f64,
    samples: usize,
}

/// Mean errors, µm beside each log's own constant, over the voltage, V, of the rising branches and of the falling
/// ones. A reversal is what goes back by more than `retreat` V; where the voltage stands still by that measure it is
/// on no branch.
pub fn branches(logs: &[Comparison], retreat: f64) -> [Vec<Point>; 2] {
    let voltages = logs.iter().flat_map(|log| log.trace.voltage.iter().copied());
    let Some((min, max)) = extent(voltages).filter(|(min, max)| min < max) else { return Default::default() };
    let width = (max - min) / BINS as f64;
    let mut sums = [[Sum::default(); BINS]; 2];
    for log in logs {
        let trace = &log.trace;
        let pieces = [vec![0], gaps(&trace.time_s), vec![trace.voltage.len()]].concat();
        let ends = pieces.windows(2).flat_map(|piece| {
            let turns = reversals(&trace.voltage[piece[0]..piece[1]], retreat).into_iter().map(|turn| piece[0] + turn);
            let ends: Vec<usize> = [piece[0]].into_iter().chain(turns).chain([piece[1].saturating_sub(1)]).collect();
            ends.windows(2).map(|pair| [pair[0], pair[1]]).collect::<Vec<_>>()
        });
        for pair in ends {
            let (from, to) = (pair[0], pair[1]);
            let Some((before, after)) = trace.voltage.get(from).zip(trace.voltage.get(to)) else { continue };
            let branch = &mut sums[usize::from(after < before)];
            let mut reached = *before;
            for index in from..to {
                // A hold would weigh as all that moves at its voltage.
                let on = if after < before { trace.voltage[index] < reached } else { trace.voltage[index] > reached };
                if !on {
                    continue;
                }
                reached = trace.voltage[index];
                let um = trace.estimated[index] - trace.measured[index] - log.mil.offset_um;
                let bin = (((trace.voltage[index] - min) / width) as usize).min(BINS - 1);
                if um.is_finite() {
                    branch[bin] = Sum { um: branch[bin].um + um, samples: branch[bin].samples + 1 };
                }
            }
        }
    }
    sums.map(|branch| {
        let known = branch.iter().enumerate().filter(|(_, sum)| sum.samples >= FEW);
        known.map(|(bin, sum)| (min + width * (bin as f64 + 0.5), sum.um / sum.samples as f64)).collect()
    })
}

/// Draws them, with their numbers; `None` where neither branch has an error.
pub fn draw(logs: &[Comparison], retreat: f64) -> Option<(Drawing, Csv)> {
    let [rising, falling] = branches(logs, retreat);
    let all = || rising.iter().chain(&falling);
    all().next()?;
    let mut drawing = Drawing::new(350.0, 262.0, 11.0);
    let frame = Frame { left: 42.0, top: 22.0, width: 300.0, height: 208.0 };
    let voltages = Axis::linear(all().map(|point| point.0), 4);
    let errors = Axis::linear(all().map(|point| point.1).chain([0.0]), 3);
    let panel = drawing.panel(frame, voltages, errors, ("voltage, V", "mean error, µm"));
    drawing.zero(&panel);
    drawing.line(&panel, "estimate", &rising);
    drawing.line(&panel, "error", &falling);
    drawing.legend(&panel, &[("estimate", "rising"), ("error", "falling")]);
    let curves: [(&str, &[Point]); 2] = [("rising", &rising), ("falling", &falling)];
    Some((drawing, Csv::of_curves("error-by-branch", ["voltage_v", "mean_error_um"], &curves)))
}

#[cfg(test)]
mod tests {
    use super::super::tests::log;
    use super::*;

    /// A loop that is too wide by twice 0.2 µm, 1 µm off in all.
    #[test]
    fn too_wide_a_loop_is_off_up_on_one_branch_and_down_on_the_other() {
        // 10 Hz at 2 kHz: a period has 200 samples, of which the first and the last quarter rise.
        let rises = |k: usize| !(50..150).contains(&((k + 1) % 200));
        let mut wide = log("a", 4000, |k| 1.0 + if rises(k) { -0.2 } else { 0.2 });
        wide.mil.offset_um = 1.0;
        let [rising, falling] = branches(&[wide], 0.8);
        assert!(rising.len() > BINS - 3 && falling.len() > BINS - 3, "{} {}", rising.len(), falling.len());
        let middle = |branch: &[Point]| branch[branch.len() / 2].1;
        assert!(
            (middle(&rising) + 0.2).abs() < 0.02 && (middle(&falling) - 0.2).abs() < 0.02,
            "{rising:?} {falling:?}"
        );
    }

    #[test]
    fn nothing_moves_nothing_is_drawn() {
        let mut still = log("a", 100, |_| 0.1);
        still.trace.voltage.fill(3.0);
        assert!(draw(&[still], 0.1).is_none() && draw(&[], 0.1).is_none());
    }
}
