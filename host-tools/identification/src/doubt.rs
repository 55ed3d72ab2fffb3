//! Reasons not to trust an identification. Each doubt holds what was seen.

use calibration::Assumed;
use estimator_core::{DuhemCondition, Range};
use log_survey::{Ahead, Flaw, Hum, Implausible, OtherScale};
use serde::Serialize;
use validation::OutOfStep;

/// A reason not to trust a result.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "doubt", rename_all = "kebab-case")]
pub enum Doubt {
    /// The displacement of a log is an estimate.
    EstimatedDisplacement {
        /// Name of the log.
        log: String,
    },
    /// The displacement of a training log runs ahead of its voltage.
    RunsAhead {
        /// Name of the log.
        log: String,
        /// By how much the displacement is early.
        #[serde(flatten)]
        by: Ahead,
    },
    /// What the model leaves of a training log goes with how fast it moves.
    OutOfStep {
        /// Name of the log.
        log: String,
        /// How its voltage and displacement are out of step.
        #[serde(flatten)]
        of: OutOfStep,
    },
    /// A log moves much further a volt than the others, or much less far.
    OtherScale(OtherScale),
    /// A searched coordinate ended at an end of its range.
    AtBound {
        /// Name of the coordinate.
        gene: &'static str,
        /// The value that the search ended at.
        value: f64,
    },
    /// The model does not describe the logs.
    PoorFit {
        /// Name of the log on which the error is largest.
        log: String,
        /// Simulation MAE on it in training without its constant offset, % of the stroke of all logs.
        percent: f64,
    },
    /// A log holds what is no measurement.
    Flawed {
        /// Name of the log.
        log: String,
        /// The gravest of a kind.
        worst: Flaw,
        /// How many there are of that kind.
        count: usize,
        /// They were left out of what is fitted to and judged by.
        left_out: bool,
        /// That was asked for, and not done: what is no measurement is most of the log.
        most: bool,
    },
    /// The training session that the logs are of is not whole.
    Unfinished {
        /// What is missing of it.
        missing: String,
    },
    /// The error on what was held out is far from the training error.
    HeldOutFar {
        /// Simulation MAE without offset in training, µm.
        training_um: f64,
        /// Simulation MAE without offset on what was held out, µm.
        held_out_um: f64,
        /// The table was learnt from what was held out, too, since.
        learnt_since: bool,
    },
    /// What was learnt once more from the whole logs describes them worse than the judged model did each part.
    LearntWorse {
        /// Simulation MAE without offset on the whole logs, µm.
        whole_um: f64,
        /// The judged model's on the part where it is larger, µm.
        judged_um: f64,
    },
    /// Nothing was held out.
    NothingHeldOut,
    /// Fitted with the measured displacement fed back, it runs away from the sensor without.
    Diverges {
        /// Error with the feedback, µm.
        fed_um: f64,
        /// Error in simulation, µm, in the same norm; both in training.
        simulation_um: f64,
    },
    /// A training log begins with something that fits much worse than the rest.
    Transient {
        /// Name of the log.
        log: String,
        /// When it ends, s from the start of what was used.
        until_s: f64,
    },
    /// An identified Duhem set does not meet a condition of the thesis's Section 3.3 at some voltage within its
    /// saturation, which the logs need not have reached.
    UnmetCondition {
        /// The first that it does not meet.
        condition: DuhemCondition,
    },
    /// Hardly any hysteresis was exercised.
    FewReversals {
        /// How many reversals there are.
        reversals: usize,
    },
    /// All half cycles last about the same.
    SingleFrequency {
        /// Somebody says what the lag is, or a step of the voltage shows it.
        lag_known: bool,
    },
    /// No fast move of the voltage from one rest to another shows how the actuator comes to rest.
    NoFastMove,
    /// All swings are about as large.
    SingleAmplitude {
        /// The model has terms that need several.
        extremum_terms: bool,
    },
    /// The estimate is off by a constant on what was held out.
    Drift {
        /// Name of the held-out log on which it is largest.
        log: String,
        /// Median of estimate − measurement, µm.
        offset_um: f64,
    },
    /// The error on what was held out grows steadily.
    Trend {
        /// Name of the held-out log on which it grows most.
        log: String,
        /// By how much estimate − measurement changes, µm, and
        by_um: f64,
        /// within what time, s.
        within_s: f64,
    },
    /// The f32 core does not follow the reference.
    SinglePrecision {
        /// Largest difference, µm.
        difference_um: f64,
    },
    /// A held-out log goes where the training logs did not.
    BeyondTraining {
        /// Name of the log.
        log: String,
        /// Where its voltage goes, V.
        reaches: Range<f64>,
        /// Where that of the training goes, V.
        trained: Range<f64>,
    },
    /// On a held-out log the voltage goes as it never went in the training.
    Untrained {
        /// Name of the log.
        log: String,
        /// How much of the time, %.
        percent: f64,
        /// When first, s since the log's first sample.
        first_s: f64,
    },
    /// The sensor of a training log goes farther than those of the others where the voltage does not, or less far.
    OtherGain {
        /// Name of the log.
        log: String,
        /// By which factor.
        factor: f64,
    },
    /// What the model leaves of a training log hums at a frequency of the mains.
    Hums {
        /// Name of the log that hums most.
        log: String,
        /// How it does.
        #[serde(flatten)]
        hum: Hum,
    },
    /// The voltage is read with more noise than the deadband.
    NoisyVoltage {
        /// Reversals that the deadband lets through.
        reversals: usize,
        /// Those of at least 10 % of the span.
        large: usize,
    },
    /// A straight line through the training does as well.
    NoBetterThanLine {
        /// Simulation MAE without offset on what was held out, else in training, µm.
        error_um: f64,
        /// The line's, µm.
        line_um: f64,
    },
    /// The interval beside the estimate is wide.
    WideInterval {
        /// Its least half-width, µm.
        half_um: f64,
        /// The same in % of the training stroke.
        percent: f64,
    },
    /// A converter's span does not cover what the table needs.
    ConverterSpan {
        /// Which converter it is.
        converter: Converter,
        /// What the training needs of it: voltages, V, of the ADC; estimates, µm, of the DAC.
        needs: Range<f64>,
    },
    /// The stroke is none of a piezo actuator's, by the training logs' voltages.
    ImplausibleStroke(Implausible),
    /// The calibration of a converter is a placeholder, or of both.
    CalibrationAssumed {
        /// The converters whose calibration it is.
        converters: Assumed,
    },
    /// A delay was looked for, and the logs do not tell one from a lag.
    DelayUndetermined {
        /// How late the displacement is, of which none is taken for the sensor's, ms.
        late_ms: f64,
    },
    /// The delay that was found is larger than the largest that was to be looked for.
    DelayAtBound {
        /// That largest one, which is taken, ms.
        delay_ms: f64,
    },
}

impl Doubt {
    /// Whether the table is not to be used before it is mended.
    pub fn grave(&self) -> bool {
        self.rank() < OTHER
    }

    /// Where it stands among others: the gravest first.
    pub fn rank(&self) -> u8 {
        match self {
            // What is no measurement may be the cause of every other doubt.
            Self::EstimatedDisplacement { .. } => 0,
            Self::Flawed { worst, left_out: false, .. } if worst.repairable() => 0,
            Self::OtherScale(_) | Self::ImplausibleStroke(_) | Self::RunsAhead { .. } | Self::OutOfStep { .. } => 1,
            Self::Diverges { .. }
            | Self::PoorFit { .. }
            | Self::LearntWorse { .. }
            | Self::NoBetterThanLine { .. }
            | Self::Trend { .. }
            | Self::WideInterval { .. }
            | Self::FewReversals { .. } => 2,
            _ => OTHER,
        }
    }
}

/// The rank of a doubt that is not grave.
const OTHER: u8 = 3;

/// A converter of the target.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Converter {
    /// The one that reads the voltage.
    Adc,
    /// The one that shows the displacement.
    Dac,
}

/// Fewer reversals than this teach no hysteresis.
pub const FEW_REVERSALS: usize = 6;
