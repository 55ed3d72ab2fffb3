//! What the template shows: figures, tables and words, in the order of the report.

use super::error::ReportError;
use super::figures::{Figure, Mark, Shown, loop_figure, place_figures, search_figures, split, trace_figure};
use super::rows::{self, CandidateRow, ERRORS, GeneRow, ParameterRow};
use super::swings::{BySwing, Swing, swings};
use super::thin::retreat;
use super::zoom;
use askama::Template;
use estimator_core::Model;
use identification::validate::Comparison;
use identification::{Baseline, Candidate};

/// Points of all drawn lines together, beside which a page has room for the logs' numbers below 1 MB.
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
    /// Heading of the page.
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

/// Logs that a heading names.
const NAMED: usize = 3;

/// A report's heading: a unit's name where there is one, and the logs that were trained on, of many the first.
pub fn heading(unit: Option<&str>, logs: &[&str]) -> String {
    let named = logs[..logs.len().min(NAMED)].join(", ");
    let more = match logs.len().saturating_sub(NAMED) {
        0 => String::new(),
        1 => " and 1 more log".to_owned(),
        more => format!(" and {more} more logs"),
    };
    unit.map_or(String::new(), |unit| format!("{unit}: ")) + &named + &more
}

/// Text in pieces, each with whether it is code.
type Sentence<'a> = Vec<(bool, &'a str)>;

/// The page that the template fills.
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
    /// Style and script of what draws a whole log; empty where there is none.
    zoom_style: &'static str,
    zoom_script: &'static str,
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
        let logs = traced.len();
        let limit = (POINTS / (2 * looped.len() + 4 * traced.len() + 2)).min(POINTS_OF_A_LINE);

        let voltages = chosen.training.iter().chain(&chosen.held_out).flat_map(|log| log.trace.voltage.iter().copied());
        let retreat = retreat(voltages, chosen.table.retreat_v().into());
        let of_all = |logs: &[Comparison]| logs.iter().flat_map(|log| swings(log, retreat)).collect::<Vec<Swing>>();
        let (of_held_out, of_training) = (of_all(&chosen.held_out), of_all(&chosen.training));
        let learnt_anew = report.learnt.table.parameters != chosen.table.parameters;
        let traces: Vec<_> = traced.into_iter().map(|shown| trace_figure(shown, report.flaws, limit, logs)).collect();
        let zoomed = traces.iter().any(|figure| figure.csv.as_ref().is_some_and(|csv| csv.rows.is_some()));

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
            places: place_figures(chosen, &of_held_out, &of_training, retreat, learnt_anew),
            by_swing: BySwing::of(&of_held_out, &of_training),
            traces,
            traces_left_out,
            zoom_style: if zoomed { uplot::STYLE } else { "" },
            zoom_script: if zoomed { &zoom::SCRIPT } else { "" },
            flaws: &report.flaws[..report.flaws.len().min(FLAWS)],
            flaws_left_out: report.flaws.len().saturating_sub(FLAWS),
            search: search_figures(chosen, limit),
            learnt_anew,
            genes: report.learnt.fit.genes.iter().map(GeneRow::new).collect(),
            parameters: rows::parameters(&report.learnt.table),
            table: rows::table(&report.learnt.table),
            facts: report.facts,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_names_the_unit_and_the_first_of_many_logs() {
        assert_eq!(heading(None, &["a.csv", "b.csv"]), "a.csv, b.csv");
        assert_eq!(heading(Some("SN7"), &["a.csv"; 7]), "SN7: a.csv, a.csv, a.csv and 4 more logs");
        assert_eq!(heading(None, &["a.csv"; 4]), "a.csv, a.csv, a.csv and 1 more log");
    }
}
