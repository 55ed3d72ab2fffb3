//! Why nothing came of a job.

use crate::candidate::CandidateError;
use estimator_core::Model;
use recordings::prepare::PrepareError;
use std::path::PathBuf;

/// Why nothing came of a job.
#[derive(Debug, thiserror::Error)]
pub enum JobError {
    /// A log cannot be brought to the tick.
    #[error(transparent)]
    Prepare(#[from] PrepareError),
    /// A log is to be fitted to twice, or held out, too.
    #[error(
        "{}: {} {}", log.display(),
        if *rewritten { "holds the samples of the training log, written by another program," } else { "holds the same bytes as the training log" },
        training.display()
    )]
    SameLog {
        /// The log that is held out, or fitted to as well.
        log: PathBuf,
        /// The log that is fitted to.
        training: PathBuf,
        /// The bytes are others, the samples are not.
        rewritten: bool,
    },
    /// The actuator rests in a part of a log: nothing can be learnt or proven there.
    #[error(
        "{}: the {signal} does not move between {from_s:.2} and {to_s:.2} s, which is what is {}",
        log.display(),
        if *held_out { "held out" } else { "used" }
    )]
    Rests {
        /// Path of the log.
        log: PathBuf,
        /// "voltage" or "displacement".
        signal: &'static str,
        /// Start of the part, s from the start of the log.
        from_s: f64,
        /// Its end, s.
        to_s: f64,
        /// The part is held out, not fitted to.
        held_out: bool,
    },
    /// The lag that was stated is longer than any that is searched.
    #[error("a lag of {} ms is longer than any that is searched, {} ms", 1e3 * lag_s, 1e3 * longest_s)]
    LagTooLong {
        /// What was stated, s.
        lag_s: f64,
        /// The longest delay and the longest lag together, s.
        longest_s: f64,
    },
    /// The displacement falls while the voltage rises.
    #[error("{log}: the displacement falls while the voltage rises")]
    FallsWithVoltage {
        /// Name of the log.
        log: String,
    },
    /// The voltages only rise, or only fall.
    #[error(
        "{log}: the voltage never reverses by more than a deadband of {deadband_v:.6} V, and hysteresis is what it does then"
    )]
    NoReversal {
        /// Name of the first log.
        log: String,
        /// What was stated, or follows from the noise.
        deadband_v: f64,
    },
    /// The displacements are a sensor's noise.
    #[error("{log}: the displacement is noise ({span_um:.4} µm), which does not go with the voltage")]
    Noise {
        /// Name of the first log.
        log: String,
        /// What it goes over, µm.
        span_um: f64,
    },
    /// The model that counts has no admissible candidate.
    #[error("model {model}")]
    Failed {
        /// The model without a candidate.
        model: Model,
        /// Why it has none.
        source: CandidateError,
    },
    /// The chosen model was judged, and cannot be learnt once more from all of the training logs.
    #[error("the chosen model was judged, and cannot be learnt once more from the whole of each log")]
    Whole {
        /// Why it could not be identified.
        source: Box<JobError>,
    },
    /// No model has an admissible candidate.
    #[error("of no model an admissible candidate was found")]
    NothingFound,
}
