//! The report of an identification: one HTML file that needs nothing else, for a screen, a phone or paper.

mod axis;
mod comparison;
pub mod drawn;
mod errors;
mod loops;
mod number;
mod page;
mod picture;
mod reproduction;
mod rows;
mod section;
mod svg;
mod thin;
mod traces;

#[cfg(test)]
mod tests;

use askama::Template;
pub use comparison::{ComparisonReport, comparison};
use identification::{Baseline, Candidate};
pub use picture::picture;
pub use reproduction::{ReproductionReport, reproduction};
pub use section::{Grid, Picture, Section, shown, yes};
pub use thin::turns;

/// What a report says.
#[derive(Clone, Copy, Debug)]
pub struct Report<'a> {
    /// Heading.
    pub title: &'a str,
    /// How good the estimate is, in plain sentences.
    pub verdict: &'a [String],
    /// When not to trust it; may be empty.
    pub doubts: &'a [String],
    /// The model that was chosen.
    pub chosen: &'a Candidate,
    /// All identified models, the chosen one included.
    pub candidates: &'a [Candidate],
    /// What every model is to better.
    pub straight_line: Option<&'a Baseline>,
    /// Provenance: log digests, options, seed, version.
    pub facts: &'a [(String, String)],
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The template refused.
    #[error("the report could not be written: {0}")]
    Template(#[from] askama::Error),
    /// A log without anything to draw.
    #[error("log '{log}' has no measured instant after its first: nothing to draw; cut off less of it")]
    Nothing {
        /// Its name.
        log: String,
    },
}

/// The report as HTML.
///
/// # Errors
/// [`ReportError::Template`] where the template cannot be rendered.
pub fn render(report: &Report<'_>) -> Result<String, ReportError> {
    Ok(page::Page::new(report).render()?)
}
