//! Reasons not to trust an identification. Each doubt says what was seen, what it means and what helps.

use estimator_core::Model;
use serde::Serialize;
use std::fmt;

/// A reason not to trust a result.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "doubt", rename_all = "kebab-case")]
pub enum Doubt {
    /// The displacement of a log is an estimate.
    EstimatedDisplacement {
        /// Name of the log.
        log: String,
    },
    /// A searched coordinate ended at an end of its range.
    AtBound {
        /// Its name.
        gene: &'static str,
        /// Where it ended.
        value: f64,
    },
    /// The model does not describe the logs.
    PoorFit {
        /// Simulation MAE in training, % of the stroke.
        percent: f64,
    },
    /// The displacement falls while the voltage rises.
    FallsWithVoltage,
    /// A simpler or richer model found no admissible candidate.
    NotIdentified {
        /// Which.
        model: Model,
    },
    /// The error on what was held out is far from the training error.
    HeldOutFar {
        /// Simulation MAE in training, µm.
        training_um: f64,
        /// Simulation MAE on what was held out, µm.
        held_out_um: f64,
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
    /// Hardly any hysteresis was exercised.
    FewReversals {
        /// How many.
        reversals: usize,
    },
    /// All half cycles last about the same.
    SingleFrequency,
    /// All swings are about as large.
    SingleAmplitude {
        /// The model has terms that need several.
        extremum_terms: bool,
    },
    /// The estimate is off by a constant on what was held out.
    Drift {
        /// Median of estimate − measurement, µm.
        offset_um: f64,
    },
    /// The f32 core does not follow the reference.
    SinglePrecision {
        /// Largest difference, µm.
        difference_um: f64,
    },
    /// A held-out log goes where the training logs did not.
    BeyondTraining {
        /// Its name.
        log: String,
    },
    /// The voltage is read with more noise than the deadband.
    NoisyVoltage {
        /// Reversals that the deadband lets through.
        reversals: usize,
        /// Those of at least 10 % of the span.
        large: usize,
    },
    /// A converter's span does not cover what the table needs.
    ConverterSpan {
        /// Which converter, and its option.
        converter: &'static str,
    },
    /// The ADC and DAC calibration is a placeholder.
    CalibrationAssumed,
    /// The delay that was found is the largest that was tried.
    DelayAtBound {
        /// The delay, ms.
        delay_ms: f64,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EstimatedDisplacement { log } => write!(
                f,
                "the displacement of {log} is a device's estimate (piezo record), no sensor's: fitted to it the model learns \
                 that estimator with its errors, and an error on it looks too good; use logs with a real sensor's \
                 displacement"
            ),
            Self::AtBound { gene, value } => write!(
                f,
                "`{gene}` ended at the end of its range ({value:.4}): the optimum may lie beyond, or the logs do not \
                 determine it; record more frequencies and amplitudes, or choose a simpler --model"
            ),
            Self::PoorFit { percent } => write!(
                f,
                "in training the error is {percent:.1} % of the stroke: the model does not describe these logs; are the \
                 columns, units and zeros right, and is the sensor's delay within reason (--delay)?"
            ),
            Self::FallsWithVoltage => write!(
                f,
                "the displacement falls while the voltage rises: is the sensor mounted the other way (--displacement-scale \
                 -1), or the voltage inverted (--voltage-scale -1)?"
            ),
            Self::NotIdentified { model } => write!(
                f,
                "for the model {model} no admissible candidate was found: search longer (--generations, --rounds) or raise \
                 --limit"
            ),
            Self::HeldOutFar { training_um, held_out_um } => write!(
                f,
                "on the held-out data the error is {held_out_um:.3} µm, in training {training_um:.3} µm: the model has \
                 learnt this recording rather than the actuator, or the two were recorded under other conditions"
            ),
            Self::NothingHeldOut => {
                write!(
                    f,
                    "nothing was held out, so nothing is known of data it has not seen: use --validate-on or --hold-out"
                )
            }
            Self::Diverges { fed_um, simulation_um } => write!(
                f,
                "fed with the measured displacement the error is {fed_um:.4} µm, but in simulation, which is what the \
                 estimator does, {simulation_um:.3} µm: use --cost simulation"
            ),
            Self::Transient { log, until_s } => write!(
                f,
                "{log} fits far worse in its first {until_s:.3} s than later, as a start-up transient does: cut it off \
                 with --skip-start"
            ),
            Self::FewReversals { reversals } => write!(
                f,
                "the training logs reverse direction only {reversals} times: hysteresis needs at least {FEW_REVERSALS}; \
                 record several cycles"
            ),
            Self::SingleFrequency => write!(
                f,
                "the training logs have a single frequency: lag and hysteresis cannot be told apart, and at other \
                 frequencies the estimate may be wrong; record several"
            ),
            Self::SingleAmplitude { extremum_terms: true } => write!(
                f,
                "the training logs have a single amplitude, which teaches a single loop: the extremum terms are not \
                 determined and can be far off at other amplitudes; record several, or use --model voigt"
            ),
            Self::SingleAmplitude { extremum_terms: false } => write!(
                f,
                "the training logs have a single amplitude, which teaches a single loop: at other amplitudes the error \
                 is unknown; record several"
            ),
            Self::Drift { offset_um } => write!(
                f,
                "on the held-out data the estimate is off by a constant {offset_um:+.3} µm (creep, drift, or where the \
                 session started), which no sensorless estimate can know: set the zero again at rest"
            ),
            Self::SinglePrecision { difference_um } => {
                write!(
                    f,
                    "the f32 core differs from the f64 reference by up to {difference_um:.2e} µm: use a deadband above the \
                     noise (--deadband) or a longer tick (--tick-us)"
                )
            }
            Self::BeyondTraining { log } => {
                write!(
                    f,
                    "{log} has voltages beyond the training logs: there the estimate holds the nearest known voltage; \
                     train on logs that reach as far"
                )
            }
            Self::NoisyVoltage { reversals, large } => write!(
                f,
                "the voltage reverses {reversals} times, but only {large} times by more than 10 % of its span: noise passes \
                 for reversals; give a --deadband above it"
            ),
            Self::ConverterSpan { converter } => write!(
                f,
                "the {converter} does not cover what the logs need: there the converter will stand at its end"
            ),
            Self::CalibrationAssumed => write!(
                f,
                "the ADC and DAC calibration is assumed (their ranges span the logs): state --adc-span and --dac-span \
                 before flashing"
            ),
            Self::DelayAtBound { delay_ms } => write!(
                f,
                "the estimated delay is the largest tried ({delay_ms} ms): the logs do not determine it; give --delay \
                 from the sensor's data sheet"
            ),
        }
    }
}

/// Fewer reversals than this teach no hysteresis.
pub const FEW_REVERSALS: usize = 6;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_doubt_says_what_helps() {
        let all = [
            Doubt::EstimatedDisplacement { log: "c".into() },
            Doubt::AtBound { gene: "p", value: 2.5 },
            Doubt::PoorFit { percent: 40.0 },
            Doubt::FallsWithVoltage,
            Doubt::NotIdentified { model: Model::Enhanced },
            Doubt::HeldOutFar { training_um: 0.1, held_out_um: 1.0 },
            Doubt::NothingHeldOut,
            Doubt::Diverges { fed_um: 0.01, simulation_um: 3.0 },
            Doubt::Transient { log: "a".into(), until_s: 0.3 },
            Doubt::FewReversals { reversals: 2 },
            Doubt::SingleFrequency,
            Doubt::SingleAmplitude { extremum_terms: true },
            Doubt::SingleAmplitude { extremum_terms: false },
            Doubt::Drift { offset_um: -0.2 },
            Doubt::SinglePrecision { difference_um: 0.1 },
            Doubt::BeyondTraining { log: "b".into() },
            Doubt::NoisyVoltage { reversals: 900, large: 20 },
            Doubt::ConverterSpan { converter: "ADC (--adc-span)" },
            Doubt::CalibrationAssumed,
            Doubt::DelayAtBound { delay_ms: 5.0 },
        ];
        for doubt in all {
            let text = doubt.to_string();
            assert!(text.len() > 40 && !text.contains("  "), "{text}");
        }
    }
}
