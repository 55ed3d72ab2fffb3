//! What the template shows: figures, tables and words, in the order of the report.

use super::error::ReportError;
use super::number::quantity;
use super::rows::{self, CandidateRow, ERRORS, GeneRow, ParameterRow};
use super::svg::Drawing;
use super::swings::{BySwing, Swing, map, swings};
use super::thin::retreat;
use super::{branches, errors, loops, traces};
use askama::Template;
use estimator_core::Model;
use identification::validate::Comparison;
use identification::{Baseline, Candidate};

/// Points of all lines together: what keeps the file below 1 MB.
const POINTS: usize = 50_000;
/// Most points of a line: more than a screen has columns.
const POINTS_OF_A_LINE: usize = 1_400;
/// Logs whose loops are drawn at most.
const LOOPS: usize = 24;
/// Held-out logs whose traces are drawn at most.
const HELD_OUT_TRACES: usize = 8;
/// Training logs whose traces are drawn at most.
const TRAINING_TRACES: usize = 3;
/// Flaws that are listed at most.
const FLAWS: usize = 60;

/// What a report says.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// Heading.
    pub title: &'a str,
    /// How good the estimate is, in plain sentences.
    pub verdict: &'a [String],
    /// When not to trust it; may be empty.
    pub doubts: &'a [String],
    /// The model that was chosen, as it was judged: its errors are what is drawn.
    pub chosen: &'a Candidate,
    /// The same as it is delivered, learnt from what had been held out, too.
    pub learnt: &'a Candidate,
    /// All identified models, the chosen one included.
    pub candidates: &'a [Candidate],
    /// What every model is to better.
    pub straight_line: Option<&'a Baseline>,
    /// What in the logs is no measurement.
    pub flaws: &'a [Mark],
    /// Provenance: log digests, options, seed, version.
    pub facts: &'a [(String, String)],
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

/// A plot with its caption.
pub struct Figure {
    /// Inline SVG.
    pub svg: String,
    /// What it shows: a log's name, or a title.
    pub name: String,
    /// "held out", "training" or nothing.
    pub role: &'static str,
    /// The rest of the caption.
    pub caption: String,
}

/// Text in pieces, each with whether it is code.
type Sentence<'a> = Vec<(bool, &'a str)>;

/// The page.
#[derive(Template)]
#[template(path = "report.html")]
pub struct Page<'a> {
    title: &'a str,
    model: Model,
    verdict: Vec<Sentence<'a>>,
    doubts: Vec<Sentence<'a>>,
    headings: [&'static str; 5],
    candidates: Vec<CandidateRow>,
    held_out: bool,
    loops: Vec<Figure>,
    loops_left_out: Vec<&'a str>,
    places: Vec<Figure>,
    by_swing: BySwing,
    traces: Vec<Figure>,
    traces_left_out: Vec<&'a str>,
    flaws: &'a [Mark],
    flaws_left_out: usize,
    search: Vec<Figure>,
    /// What is delivered is not what was judged.
    learnt_anew: bool,
    genes: Vec<GeneRow>,
    parameters: Vec<ParameterRow>,
    table: Vec<ParameterRow>,
    facts: &'a [(String, String)],
}

/// A log, and whether it was held out.
#[derive(Clone, Copy)]
struct Shown<'a> {
    log: &'a Comparison,
    role: &'static str,
}

/// The report as HTML.
///
/// # Errors
/// [`ReportError::Template`] where the template cannot be rendered.
pub fn render(report: &Report<'_>) -> Result<String, ReportError> {
    Ok(Page::new(report).render()?)
}

impl<'a> Page<'a> {
    /// The page of a report.
    pub fn new(report: &Report<'a>) -> Self {
        let chosen = report.chosen;
        let role = |role| move |log| Shown { log, role };
        let held_out: Vec<Shown<'a>> = chosen.held_out.iter().map(role("held out")).collect();
        let training: Vec<Shown<'a>> = chosen.training.iter().map(role("training")).collect();

        let (looped, loops_left_out) = split(held_out.iter().chain(&training), LOOPS);
        let (mut traced, mut traces_left_out) = split(held_out.iter(), HELD_OUT_TRACES);
        let (fitted, not_traced) = split(training.iter(), TRAINING_TRACES);
        traced.extend(fitted);
        traces_left_out.extend(not_traced);
        let limit = (POINTS / (2 * looped.len() + 4 * traced.len() + 2)).min(POINTS_OF_A_LINE);

        let voltages = chosen.training.iter().chain(&chosen.held_out).flat_map(|log| log.trace.voltage.iter().copied());
        let retreat = retreat(voltages, chosen.table.retreat_v().into());
        let of_all = |logs: &[Comparison]| logs.iter().flat_map(|log| swings(log, retreat)).collect::<Vec<Swing>>();
        let (of_held_out, of_training) = (of_all(&chosen.held_out), of_all(&chosen.training));

        Self {
            title: report.title,
            model: chosen.fit.model,
            verdict: report.verdict.iter().map(|text| sentence(text)).collect(),
            doubts: report.doubts.iter().map(|text| sentence(text)).collect(),
            headings: ERRORS,
            candidates: (report.candidates.iter().map(|candidate| CandidateRow::new(candidate, chosen)))
                .chain(report.straight_line.map(CandidateRow::straight_line))
                .collect(),
            held_out: !held_out.is_empty(),
            loops: looped.into_iter().map(|shown| loop_figure(shown, limit)).collect(),
            loops_left_out,
            places: place_figures(chosen, &of_held_out, &of_training, retreat),
            by_swing: BySwing::of(&of_held_out, &of_training),
            traces: traced.into_iter().map(|shown| trace_figure(shown, report.flaws, limit)).collect(),
            traces_left_out,
            flaws: &report.flaws[..report.flaws.len().min(FLAWS)],
            flaws_left_out: report.flaws.len().saturating_sub(FLAWS),
            search: search_figures(report, limit),
            learnt_anew: report.learnt.table.parameters != chosen.table.parameters,
            genes: report.learnt.fit.genes.iter().map(GeneRow::new).collect(),
            parameters: rows::parameters(&report.learnt.table),
            table: rows::table(&report.learnt.table),
            facts: report.facts,
        }
    }
}

/// The first logs that have something to draw, and the names of the others.
fn split<'a: 'b, 'b>(logs: impl Iterator<Item = &'b Shown<'a>>, count: usize) -> (Vec<Shown<'a>>, Vec<&'a str>) {
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

fn loop_figure(Shown { log, role }: Shown<'_>, limit: usize) -> Figure {
    let (drawing, drawn) = loops::draw(&log.trace, limit);
    let mut caption = rows::sentence(log);
    if drawn.periods < drawn.of {
        caption += &format!(" {} of {} periods are drawn.", drawn.periods, drawn.of);
    }
    let label = format!("Displacement over voltage of {} ({role}): sensor and estimate. {caption}", log.name);
    Figure { svg: drawing.inline(&label), name: log.name.clone(), role, caption }
}

fn trace_figure(Shown { log, role }: Shown<'_>, flaws: &[Mark], limit: usize) -> Figure {
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
    Figure { svg: drawing.inline(&label), name: log.name.clone(), role, caption }
}

/// The errors by branch, and where the logs' swings lie.
fn place_figures(chosen: &Candidate, held_out: &[Swing], training: &[Swing], retreat: f64) -> Vec<Figure> {
    let (logs, role) =
        if chosen.held_out.is_empty() { (&chosen.training, "training") } else { (&chosen.held_out, "held out") };
    let mut figures = Vec::new();
    let mut add = |name: &str, role, caption: &str, drawing: Option<Drawing>| {
        let label = format!("{name}. {caption}");
        figures.extend(drawing.map(|drawing| Figure {
            svg: drawing.inline(&label),
            name: name.to_owned(),
            role,
            caption: caption.to_owned(),
        }));
    };
    add(
        "Error by branch",
        role,
        "Mean error over the voltage, beside each log's own constant. What both branches share is a mean curve that is bent \
         otherwise than the model's; what tells them apart is hysteresis that the model has too much or too little of.",
        branches::draw(logs, retreat),
    );
    add(
        "What the logs cover",
        "",
        "Each swing of the voltage by its frequency and size. Where no circle of the training is near, the error is unknown.",
        map(held_out, training),
    );
    figures
}

fn search_figures(report: &Report<'_>, limit: usize) -> Vec<Figure> {
    let chosen = report.chosen;
    let mut figures = Vec::new();
    // The genetic algorithm has the Voigt family, other methods the rest.
    let step = if chosen.fit.model.is_voigt() { "generation" } else { "step of the search" };
    if let Some(drawing) = errors::convergence(&chosen.fit.convergence, step, limit) {
        let caption = format!(
            "Error of the best candidate after each {step} ({}; held out always in simulation). Where the training error \
             still falls and the held-out error rises, the model learns the recording and no longer the actuator.",
            chosen.fit.minimised
        );
        let name = "Convergence".to_owned();
        figures.push(Figure { svg: drawing.inline(&format!("{name}. {caption}")), name, role: "", caption });
    }
    let caption = if chosen.held_out.is_empty() {
        "How the errors on the training logs are distributed; each log weighs the same."
    } else {
        "How the errors on the held-out and on the training logs are distributed; each log weighs the same."
    };
    let drawing = errors::histogram(&chosen.training, &chosen.held_out);
    let (name, caption) = ("Residuals".to_owned(), caption.to_owned());
    figures.push(Figure { svg: drawing.inline(&format!("{name}. {caption}")), name, role: "", caption });
    figures
}

/// A sentence in pieces: what stands between back-ticks, and every `--option`, is code.
fn sentence(text: &str) -> Sentence<'_> {
    let mut pieces = Vec::new();
    for (n, piece) in text.split('`').enumerate() {
        let mut rest = piece;
        while let Some(start) = rest.find("--").filter(|_| n % 2 == 0) {
            let letters = |c: char| c.is_ascii_alphanumeric() || c == '-';
            let end = rest[start..].find(|c| !letters(c)).map_or(rest.len(), |length| start + length);
            pieces.extend([(false, &rest[..start]), (true, &rest[start..end])]);
            rest = &rest[end..];
        }
        pieces.push((n % 2 == 1, rest));
    }
    pieces.retain(|(_, piece)| !piece.is_empty());
    pieces
}
