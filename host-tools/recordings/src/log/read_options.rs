//! What is said about a log besides its file.

use super::columns::Columns;
use super::sensitivity::Sensitivity;

/// What becomes of a log without a quantity, and of the quantity of a log that has it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Need {
    /// A log without it is refused.
    Required,
    /// It is read where the log has it.
    Optional,
    /// Its column is not looked at, whatever it holds.
    Ignored,
}

/// What the user says about a log that its file does not.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// Which column holds what. Needed where no header says so.
    pub columns: Option<Columns>,
    /// The sensor's scale. Needed where its volts were recorded.
    pub sensor: Option<Sensitivity>,
    /// Sample rate, Hz. Needed where the file states no time; checked where it does.
    pub sample_rate: Option<f64>,
    /// Take a voltage or a displacement that is no finite number, and samples that the time stamps leave out, for holes
    /// ([`Log::holes`](super::Log::holes)), instead of refusing the log.
    pub holes: bool,
    /// Whether a log has to have a displacement.
    pub displacement: Need,
    /// Refuse one without voltage. A wanted trajectory has none.
    pub voltage_required: bool,
}

impl ReadOptions {
    /// The same for a displacement that is one already: without a sensor's scale.
    #[must_use]
    pub fn of_length(mut self) -> Self {
        self.sensor = None;
        if let Some(displacement) = self.columns.as_mut().and_then(|columns| columns.displacement.as_mut()) {
            displacement.sensor = None;
        }
        self
    }
}

impl Default for ReadOptions {
    /// Nothing stated, voltage and displacement required.
    fn default() -> Self {
        Self {
            columns: None,
            sensor: None,
            sample_rate: None,
            holes: false,
            displacement: Need::Required,
            voltage_required: true,
        }
    }
}
