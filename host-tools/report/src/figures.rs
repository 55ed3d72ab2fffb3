//! The report's pictures, each with its caption and its numbers.

use super::csv::Csv;
use super::number::quantity;
use super::svg::Drawing;
use super::swings::{Swing, map};
use super::{branches, errors, loops, rows, traces, whole};
use identification::Candidate;
use identification::validate::Comparison;

/// A plot with its caption.
pub struct Figure {
    /// The picture as inline SVG.
    pub svg: String,
    /// What it shows: a log's name, or a title.
    pub name: String,
    /// "held out", "training" or nothing.
    pub role: &'static str,
    /// The rest of the caption.
    pub caption: String,
    /// The numbers behind it, where they are its own.
    pub csv: Option<Csv>,
}

/// A place in a log that is no measurement.
#[derive(Clone, PartialEq, Debug)]
pub struct Mark {
    /// Name of the log.
    pub log: String,
    /// Time within the log at which it begins, s.
    pub from_s: f64,
    /// When it ends, s.
    pub to_s: f64,
    /// What it is, in words.
    pub what: String,
}

/// A log, and whether it was held out.
#[derive(Clone, Copy)]
pub struct Shown<'a> {
    /// The log that is shown.
    pub log: &'a Comparison,
    /// "held out" or "training".
    pub role: &'static str,
}

/// The first logs that have something to draw, and the names of the others.
pub fn split<'a: 'b, 'b>(logs: impl Iterator<Item = &'b Shown<'a>>, count: usize) -> (Vec<Shown<'a>>, Vec<&'a str>) {
    let (mut drawn, mut left_out) = (Vec::new(), Vec::new());
    for &shown in logs {
        if drawn.len() < count && !shown.log.trace.time_s.is_empty() {
            drawn.push(shown);
        } else {
            left_out.push(shown.log.name.as_str());
        }
    }
    (drawn, left_out)
}

/// Loops of a log.
pub fn loop_figure(Shown { log, role }: Shown<'_>, limit: usize) -> Figure {
    let (drawing, drawn) = loops::draw(&log.trace, limit);
    let mut caption = rows::sentence(log);
    if drawn.periods < drawn.of {
        caption += &format!(" {} of {} periods are drawn.", drawn.periods, drawn.of);
    }
    let label = format!("Displacement over voltage of {} ({role}): sensor and estimate. {caption}", log.name);
    Figure { svg: drawing.inline(&label), name: log.name.clone(), role, caption, csv: None }
}

/// A log over time, one of so many.
pub fn trace_figure(Shown { log, role }: Shown<'_>, flaws: &[Mark], limit: usize, logs: usize) -> Figure {
    let of_log = flaws.iter().filter(|flaw| flaw.log == log.name).map(|flaw| (flaw.from_s, flaw.to_s));
    let (drawing, detail, flawed) = traces::draw(&log.trace, of_log.collect(), limit);
    let mut caption = match detail {
        Some((from, to)) => format!(
            "The last {} and their error; below, the error over the whole log, in which they are shaded.",
            quantity(to - from, "s")
        ),
        None => "The whole log and its error.".to_owned(),
    };
    if flawed {
        caption += " What is no measurement is marked behind the error.";
    }
    let label = format!("Displacement of {} over time ({role}): sensor, estimate, error. {caption}", log.name);
    let csv = Some(whole::csv(&log.trace, &log.name, role, logs));
    Figure { svg: drawing.inline(&label), name: log.name.clone(), role, caption, csv }
}

/// The errors by branch, and where the logs' swings lie; `learnt_anew` where the table was told what had been
/// held out, too.
pub fn place_figures(
    chosen: &Candidate,
    held_out: &[Swing],
    training: &[Swing],
    retreat: f64,
    learnt_anew: bool,
) -> Vec<Figure> {
    let (logs, role) =
        if chosen.held_out.is_empty() { (&chosen.training, "training") } else { (&chosen.held_out, "held out") };
    let mut figures = Vec::new();
    let mut add = |name: &str, role, caption: &str, drawn: Option<(Drawing, Csv)>| {
        let label = format!("{name}. {caption}");
        figures.extend(drawn.map(|(drawing, csv)| Figure {
            svg: drawing.inline(&label),
            name: name.to_owned(),
            role,
            caption: caption.to_owned(),
            csv: Some(csv),
        }));
    };
    add(
        "Error by branch",
        role,
        "Mean error over the voltage, beside each log's own constant. What both branches share is a mean curve that is bent \
         otherwise than the model's; what tells them apart is hysteresis that the model has too much or too little of.",
        branches::draw(logs, retreat),
    );
    let covered = if learnt_anew {
        "Each swing of the voltage by its frequency and size. The table has learnt all of them. Where no circle is near, the error is unknown."
    } else {
        "Each swing of the voltage by its frequency and size. Where no circle of the training is near, the error is unknown."
    };
    add("What the logs cover", "", covered, map(held_out, training));
    figures
}

/// The course of the search, and how the errors are distributed.
pub fn search_figures(chosen: &Candidate, limit: usize) -> Vec<Figure> {
    let mut figures = Vec::new();
    // The genetic algorithm has the Voigt family, other methods the rest.
    let step = if chosen.fit.model.is_voigt() { "generation" } else { "step of the search" };
    if let Some((drawing, csv)) = errors::convergence(&chosen.fit.convergence, step, limit) {
        let caption = format!(
            "Error of the best candidate after each {step} ({}; held out always in simulation). Where the training error \
             still falls and the held-out error rises, the model learns the recording and no longer the actuator.",
            chosen.fit.minimised
        );
        let name = "Convergence".to_owned();
        figures.push(Figure {
            svg: drawing.inline(&format!("{name}. {caption}")),
            name,
            role: "",
            caption,
            csv: Some(csv),
        });
    }
    let caption = if chosen.held_out.is_empty() {
        "How the errors on the training logs are distributed; each log weighs the same."
    } else {
        "How the errors on the held-out and on the training logs are distributed; each log weighs the same."
    };
    let (drawing, csv) = errors::histogram(&chosen.training, &chosen.held_out);
    let (name, caption) = ("Residuals".to_owned(), caption.to_owned());
    figures.push(Figure {
        svg: drawing.inline(&format!("{name}. {caption}")),
        name,
        role: "",
        caption,
        csv: Some(csv),
    });
    figures
}
