//! When not to trust an identification. Each doubt says what was seen, what it means and what helps.

use super::candidate::Candidate;
use super::character::Character;
use super::space::Gene;
use crate::session::Feedback;
use crate::validate::Trace;
use estimator_core::Model;
use serde::Serialize;
use std::fmt;

/// A reason not to trust a result.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "doubt", rename_all = "kebab-case")]
pub enum Doubt {
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
    /// Fitted one step ahead, it runs away from the sensor in simulation.
    Diverges {
        /// One-step error, µm.
        one_step_um: f64,
        /// Simulation MAE in training, µm.
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
    /// The ADC and DAC calibration is a placeholder.
    CalibrationAssumed,
    /// `--delay auto` ended at its largest delay.
    DelayAtBound {
        /// The delay, ms.
        delay_ms: f64,
    },
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
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
            Self::Diverges { one_step_um, simulation_um } => write!(
                f,
                "one step ahead the error is {one_step_um:.4} µm, but in simulation, which is what the estimator does, \
                 {simulation_um:.3} µm: use --cost simulation"
            ),
            Self::Transient { log, until_s } => write!(
                f,
                "{log} fits far worse in its first {until_s:.2} s than later, as a start-up transient does: cut it off \
                 with --skip-start {until_s:.2}"
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
const FEW_REVERSALS: usize = 6;
/// Training error beyond this percentage of the stroke is no description.
const POOR: f64 = 5.0;
/// Held-out error beyond this multiple of the training error.
const FAR: f64 = 1.5;
/// Simulation error beyond this multiple of the one-step error of a one-step fit, and
const DIVERGED: f64 = 10.0;
/// beyond this fraction of the stroke.
const DIVERGED_STROKE: f64 = 0.1;
/// A constant offset beyond this fraction of the held-out error.
const DRIFT: f64 = 0.5;
/// f32 may differ from f64 by this fraction of the stroke.
const SINGLE_PRECISION: f64 = 1e-4;
/// Errors in the first tenth of a log beyond this multiple of the largest later on are a transient.
const TRANSIENT: f64 = 2.0;
/// A coordinate this close to an end of its range, as a fraction of it, is at the end.
const AT_BOUND: f64 = 0.005;

/// Every doubt about a candidate, gravest first.
pub fn doubts(candidate: &Candidate, character: &Character, cost: Feedback) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    let model = candidate.table.model;
    let extremum_terms = model != Model::Voigt;
    let training = candidate.training_figures();
    let held_out = candidate.held_out_figures();
    if let (Feedback::Osp, Some(training)) = (cost, training) {
        let (one_step_um, simulation_um) = (candidate.fit.cost, training.mae_um);
        if simulation_um > DIVERGED * one_step_um && simulation_um > DIVERGED_STROKE * training.stroke_um {
            doubts.push(Doubt::Diverges { one_step_um, simulation_um });
        }
    }
    if let Some(training) = training.filter(|training| training.mae_percent > POOR) {
        doubts.push(Doubt::PoorFit { percent: training.mae_percent });
    }
    if candidate.training.iter().map(|comparison| covariance(&comparison.trace)).sum::<f64>() < 0.0 {
        doubts.push(Doubt::FallsWithVoltage);
    }
    match (training, held_out) {
        (Some(training), Some(held_out)) => {
            if held_out.mae_um > FAR * training.mae_um {
                doubts.push(Doubt::HeldOutFar { training_um: training.mae_um, held_out_um: held_out.mae_um });
            }
            if held_out.offset_um.abs() > DRIFT * held_out.mae_um {
                doubts.push(Doubt::Drift { offset_um: held_out.offset_um });
            }
        }
        _ => doubts.push(Doubt::NothingHeldOut),
    }
    for comparison in &candidate.training {
        if let Some(until_s) = transient(&comparison.trace) {
            doubts.push(Doubt::Transient { log: comparison.name.clone(), until_s });
        }
    }
    if character.reversals < FEW_REVERSALS {
        doubts.push(Doubt::FewReversals { reversals: character.reversals });
    }
    if character.single_amplitude() {
        doubts.push(Doubt::SingleAmplitude { extremum_terms });
    }
    if character.single_frequency() {
        doubts.push(Doubt::SingleFrequency);
    }
    for comparison in &candidate.held_out {
        if comparison.status.contains(estimator_core::Status::VOLTAGE_OUT_OF_RANGE) {
            doubts.push(Doubt::BeyondTraining { log: comparison.name.clone() });
        }
    }
    let at_bound = candidate.fit.genes.iter().filter(|(gene, value)| undetermined(gene, *value));
    doubts.extend(at_bound.map(|(gene, value)| Doubt::AtBound { gene: gene.name, value: *value }));
    let all = candidate.training.iter().chain(&candidate.held_out);
    let difference_um = all.clone().map(|comparison| comparison.mil_sil_um).fold(0.0, f64::max);
    if all.clone().any(|comparison| comparison.mil_sil_um > SINGLE_PRECISION * comparison.mil.stroke_um) {
        doubts.push(Doubt::SinglePrecision { difference_um });
    }
    doubts
}

/// Covariance of voltage and displacement.
fn covariance(trace: &Trace) -> f64 {
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
    let (v, y) = (mean(&trace.voltage), mean(&trace.measured));
    trace.voltage.iter().zip(&trace.measured).map(|(a, b)| (a - v) * (b - y)).sum()
}

/// How long the first tenth of a trace has errors beyond [`TRANSIENT`] times the largest of the rest, s.
fn transient(trace: &Trace) -> Option<f64> {
    let errors: Vec<f64> = trace.estimated.iter().zip(&trace.measured).map(|(e, m)| (e - m).abs()).collect();
    let (early, rest) = errors.split_at(errors.len() / 10);
    let large = TRANSIENT * rest.iter().copied().fold(0.0, f64::max);
    let last = early.iter().rposition(|&error| error > large)?;
    Some(trace.time_s[last] - trace.time_s[0])
}

/// At an end of its range, unless that end is a limit of the model itself: a sigmoid without curvature is the pure
/// exponential that β → ±∞ gives, and nothing lies beyond.
fn undetermined(gene: &Gene, value: f64) -> bool {
    let fraction = gene.fraction(value);
    let model_limit = gene.name == "curvature" && fraction < 0.5;
    !(AT_BOUND..=1.0 - AT_BOUND).contains(&fraction) && !model_limit
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(error: impl Fn(usize) -> f64) -> Trace {
        let measured = vec![0.0; 1000];
        Trace {
            time_s: (0..1000).map(|k| k as f64 * 0.01).collect(),
            voltage: measured.clone(),
            estimated: (0..1000).map(error).collect(),
            measured,
        }
    }

    #[test]
    fn only_a_large_error_at_the_beginning_is_a_transient() {
        let ripple = |k: usize| 0.1 * (k as f64).sin();
        assert_eq!(transient(&trace(ripple)), None);
        let until = transient(&trace(|k| ripple(k) + if k < 30 { 1.0 } else { 0.0 })).unwrap();
        assert!((until - 0.29).abs() < 1e-9, "{until}");
        assert_eq!(transient(&trace(|k| ripple(k) + if k % 200 < 30 { 1.0 } else { 0.0 })), None);
    }

    #[test]
    fn an_exponential_sigmoid_is_no_bound_but_every_other_end_is() {
        let gene = |name| Gene { name, unit: "", min: 1e-4, max: 2.0, scale: crate::identify::space::Scale::Linear };
        assert!(!undetermined(&gene("curvature"), 1e-4) && undetermined(&gene("curvature"), 2.0));
        assert!(undetermined(&gene("p"), 1e-4) && undetermined(&gene("p"), 1.999) && !undetermined(&gene("p"), 1.0));
    }

    #[test]
    fn every_doubt_says_what_helps() {
        let all = [
            Doubt::AtBound { gene: "p", value: 2.5 },
            Doubt::PoorFit { percent: 40.0 },
            Doubt::FallsWithVoltage,
            Doubt::NotIdentified { model: Model::Enhanced },
            Doubt::HeldOutFar { training_um: 0.1, held_out_um: 1.0 },
            Doubt::NothingHeldOut,
            Doubt::Diverges { one_step_um: 0.01, simulation_um: 3.0 },
            Doubt::Transient { log: "a".into(), until_s: 0.3 },
            Doubt::FewReversals { reversals: 2 },
            Doubt::SingleFrequency,
            Doubt::SingleAmplitude { extremum_terms: true },
            Doubt::SingleAmplitude { extremum_terms: false },
            Doubt::Drift { offset_um: -0.2 },
            Doubt::SinglePrecision { difference_um: 0.1 },
            Doubt::BeyondTraining { log: "b".into() },
            Doubt::CalibrationAssumed,
            Doubt::DelayAtBound { delay_ms: 5.0 },
        ];
        for doubt in all {
            let text = doubt.to_string();
            assert!(text.len() > 40 && !text.contains("  "), "{text}");
        }
    }
}
