//! The error over the steps of a search (Fig. 4.9), and how it is distributed.

use super::axis::Axis;
use super::csv::Csv;
use super::svg::{Drawing, Frame};
use super::thin::{Point, extent, thin};
use identification::Convergence;
use identification::validate::Comparison;

const FRAME: Frame = Frame { left: 42.0, top: 22.0, width: 300.0, height: 208.0 };
const SIZE: (f64, f64, f64) = (350.0, 262.0, 11.0);
const BINS: usize = 40;

/// Training and held-out error after each generation, or what else the search's steps are called, with their numbers;
/// `None` where there is nothing to draw.
pub fn convergence(course: &[Convergence], step: &str, limit: usize) -> Option<(Drawing, Csv)> {
    let line = |of: &dyn Fn(&Convergence) -> Option<f64>| -> Vec<Point> {
        let numbered = course.iter().enumerate();
        numbered.filter_map(|(n, after)| Some((n as f64, of(after).filter(|&error| drawable(error))?))).collect()
    };
    let training = line(&|after| Some(after.training));
    let held_out = line(&|after| after.validation);
    if training.is_empty() {
        return None;
    }
    let (width, height, font) = SIZE;
    let mut drawing = Drawing::new(width, height, font);
    let errors = training.iter().chain(&held_out).map(|point| point.1);
    let steps = Axis::tight([0.0, course.len().saturating_sub(1).max(1) as f64], 3);
    let panel = drawing.panel(FRAME, steps, Axis::logarithmic(errors), (step, "error, µm"));
    let lines = [("training", "training", thin(training, limit)), ("error", "held out", thin(held_out, limit))];
    let drawn = || lines.iter().filter(|(.., points)| !points.is_empty());
    for (class, _, points) in drawn() {
        drawing.line(&panel, class, points);
    }
    drawing.legend(&panel, &drawn().map(|(class, word, _)| (*class, *word)).collect::<Vec<_>>());
    let curves: Vec<(&str, &[Point])> = drawn().map(|(_, word, points)| (*word, points.as_slice())).collect();
    Some((drawing, Csv::of_curves("convergence", ["step", "error_um"], &curves)))
}

/// Whether a logarithmic axis can show it.
fn drawable(error: f64) -> bool {
    error.is_finite() && error > 1e-12
}

/// How the errors of the logs are distributed, held out and trained on, with the numbers; each log weighs the same.
pub fn histogram(training: &[Comparison], held_out: &[Comparison]) -> (Drawing, Csv) {
    let sets = [errors(held_out), errors(training)];
    let all = sets.iter().flatten().flatten().copied();
    let (min, max) = match extent(all) {
        Some((min, max)) if max - min > 1e-9 * max.abs().max(min.abs()) => (min, max),
        Some((value, _)) => (value - 0.5 * value.abs().max(1e-3), value + 0.5 * value.abs().max(1e-3)),
        None => (-1.0, 1.0),
    };
    let sets = sets.map(|logs| shares(&logs, min, max));

    let (width, height, font) = SIZE;
    let mut drawing = Drawing::new(width, height, font);
    let highest = sets.iter().flatten().copied().fold(0.0, f64::max).max(1e-3);
    let vertical = Axis::tight([0.0, 1.08 * highest], 4);
    let panel = drawing.panel(FRAME, Axis::linear([min, max], 3), vertical, ("estimate − sensor, µm", "samples, %"));
    let edge = |bin: usize| min + (max - min) * bin as f64 / BINS as f64;
    let [held_out, training] = sets;
    let numbers = |shares: &[f64]| -> Vec<Point> {
        let middle = |bin: usize| (edge(bin) + edge(bin + 1)) / 2.0;
        shares.iter().enumerate().map(|(bin, &share)| (middle(bin), share)).collect()
    };
    let curves = [("held out", numbers(&held_out)), ("training", numbers(&training))];
    let curves = curves.each_ref().map(|(part, points)| (*part, points.as_slice()));
    let csv = Csv::of_curves("residuals", ["error_um", "samples_percent"], &curves);
    let (bars, outline) = if held_out.is_empty() { (training, Vec::new()) } else { (held_out, training) };
    for (bin, &share) in bars.iter().enumerate().filter(|(_, share)| **share > 0.0) {
        drawing.bar(&panel, "share", (edge(bin), 0.0), (edge(bin + 1), share));
    }
    if outline.is_empty() {
        return (drawing, csv);
    }
    let mut steps: Vec<Point> = vec![(min, 0.0)];
    steps.extend(outline.iter().enumerate().flat_map(|(bin, &y)| [(edge(bin), y), (edge(bin + 1), y)]));
    steps.push((max, 0.0));
    drawing.line(&panel, "training", &steps);
    drawing.legend(&panel, &[("swatch", "held out"), ("training", "training")]);
    (drawing, csv)
}

fn errors(logs: &[Comparison]) -> Vec<Vec<f64>> {
    let of = |log: &Comparison| log.trace.estimated.iter().zip(&log.trace.measured).map(|(e, m)| e - m).collect();
    logs.iter().map(of).collect()
}

/// Share of the samples in each bin, %; empty without samples.
fn shares(logs: &[Vec<f64>], min: f64, max: f64) -> Vec<f64> {
    let inside = |log: &Vec<f64>| -> Vec<f64> { log.iter().copied().filter(|e| (min..=max).contains(e)).collect() };
    let logs: Vec<Vec<f64>> = logs.iter().map(inside).filter(|log| !log.is_empty()).collect();
    if logs.is_empty() {
        return Vec::new();
    }
    let mut shares = vec![0.0; BINS];
    for log in &logs {
        for error in log {
            let bin = ((error - min) / (max - min) * BINS as f64) as usize;
            shares[bin.min(BINS - 1)] += 100.0 / (log.len() * logs.len()) as f64;
        }
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_log_weighs_the_same() {
        let shares = shares(&[vec![-1.0; 10], vec![1.0], vec![]], -1.0, 1.0);
        assert!((shares[0] - 50.0).abs() < 1e-9 && (shares[BINS - 1] - 50.0).abs() < 1e-9);
    }
}
