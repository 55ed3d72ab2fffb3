//! Why there is no page.

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The template refused.
    #[error("the report could not be written: {0}")]
    Template(#[from] askama::Error),
    /// A log without anything to draw.
    #[error("log '{log}' has no measured instant after its first: nothing to draw; cut off less of it")]
    Nothing {
        /// Name of the log.
        log: String,
    },
}
