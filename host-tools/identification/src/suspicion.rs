//! When to doubt a result: the thresholds, and what is compared with them.

use crate::candidate::Candidate;
use crate::cost::{Cost, Norm};
use crate::doubt::{Converter, Doubt, FEW_REVERSALS};
use crate::validate::statistics::mean;
use crate::validate::{Baseline, Comparison, Figures, Trace, other_gain};
use estimator_core::{AdcCode, DacCode, Parameters, Range};
use log_survey::reversals::reversals;
use log_survey::{Character, Hum, hum};
use std::slice;

/// More reversals than this multiple of the large ones are noise.
const NOISY: usize = 3;
/// Training error, without its constant offset, beyond this percentage of the stroke is no description.
const POOR: f64 = 5.0;
/// Held-out error beyond this multiple of the training error, each beside the logs' own constants.
const FAR: f64 = 1.5;
/// and beyond this fraction of the stroke: of less, noise and drift decide which part of a log is fitted better.
const FAR_STROKE: f64 = 2e-3;
/// The error of what was learnt from all beyond this multiple of what was judged.
const WORSE: f64 = 2.0;
/// Simulation error beyond this multiple of the error that a fit with feedback has with it, and
const DIVERGED: f64 = 10.0;
/// beyond this fraction of the stroke.
const DIVERGED_STROKE: f64 = 0.1;
/// An error of more than this part of a straight line's is none that a model is for.
const BETTER: f64 = 0.9;
/// Parts of a lag that was said by which the found one may differ.
const LAG: f64 = 0.1;
/// A constant offset beyond this fraction of the held-out error.
const DRIFT: f64 = 0.5;
/// A constant offset within this fraction of the stroke is nothing that a zero is set again for.
const OFFSET: f64 = 1e-3;
/// Reversals by this part of the voltage's range, of which a log has to have so many for its error to have a trend.
const SWING: f64 = 0.3;
const SWINGS: usize = 4;
/// An error that grows by more than this fraction of the stroke, and
const GROWS: f64 = 0.01;
/// by so many times the rms of what a straight line leaves of it, drifts.
const STEADY: f64 = 3.0;
/// f32 may differ from f64 by this fraction of the stroke.
const SINGLE_PRECISION: f64 = 1e-4;

/// Every doubt about a candidate that is delivered, gravest first. `judged` is what the same model was before what had
/// been held out was learnt from, too.
pub fn doubts(
    candidate: &Candidate,
    judged: &Candidate,
    character: &Character,
    cost: Cost,
    lag_s: Option<f64>,
) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    let model = candidate.table.model();
    let in_chain =
        matches!(candidate.table.parameters, Parameters::VoigtChain(of) if of.voltage_extremum_um_per_v != 0.0);
    let extremum_terms = in_chain || model.has_voltage_term() || model.has_displacement_term();
    let training = candidate.training_figures();
    if let (true, Some(training)) = (cost.weight() > 0.0, training) {
        let simulation_um = match cost.norm {
            Norm::L1 => training.mae_um,
            Norm::L2 => training.rmse_um,
        };
        let fed_um = candidate.fit.cost;
        if simulation_um > DIVERGED * fed_um && simulation_um > DIVERGED_STROKE * training.stroke_um {
            doubts.push(Doubt::Diverges { fed_um, simulation_um });
        }
    }
    doubts.extend(out_of_step(&candidate.training));
    doubts.extend(poor(candidate.training.iter().map(|log| (&*log.name, log.figures()))));
    let off_um = judged.training_off_um().zip(judged.held_out_off_um());
    match (judged.training_figures(), judged.held_out_figures(), off_um) {
        (Some(training), Some(held_out), Some((training_um, held_out_um))) => {
            if far(training_um, held_out_um, training.stroke_um) {
                let learnt_since = candidate.held_out.is_empty();
                doubts.push(Doubt::HeldOutFar { training_um, held_out_um, learnt_since });
            }
            let whole = candidate.training_off_um();
            doubts.extend(whole.and_then(|whole_um| worse(whole_um, training_um.max(held_out_um), training.stroke_um)));
            let offsets = judged.held_out.iter().map(|log| (&*log.name, log.mil.offset_um));
            doubts.extend(trend(&judged.held_out, training.stroke_um).or_else(|| drift(offsets, &held_out)));
        }
        _ => doubts.push(Doubt::NothingHeldOut),
    }
    for comparison in &candidate.training {
        if let Some(until_s) = comparison.trace.transient_s() {
            doubts.push(Doubt::Transient { log: comparison.name.clone(), until_s });
        }
    }
    let gain = other_gain(candidate.training.iter().map(|log| (&*log.name, &log.trace)));
    doubts.extend(gain.map(|(log, factor)| Doubt::OtherGain { log: log.to_owned(), factor }));
    doubts.extend(hums(&candidate.training));
    doubts.extend(unmet_condition(&candidate.table.parameters));
    if character.reversals < FEW_REVERSALS {
        doubts.push(Doubt::FewReversals { reversals: character.reversals });
    }
    if character.reversals_at_deadband > NOISY * character.reversals.max(1) {
        let (reversals, large) = (character.reversals_at_deadband, character.reversals);
        doubts.push(Doubt::NoisyVoltage { reversals, large });
    }
    doubts.extend(spans(candidate));
    if character.single_amplitude() {
        doubts.push(Doubt::SingleAmplitude { extremum_terms });
    }
    if character.single_frequency() {
        let lag_known = character.steps > 0 || lag_s.is_some_and(|said| kept(said, candidate));
        doubts.push(Doubt::SingleFrequency { lag_known });
    } else if character.steps == 0 && character.fast_moves == 0 {
        doubts.push(Doubt::NoFastMove);
    }
    for comparison in &candidate.held_out {
        if comparison.status.contains(estimator_core::Status::VOLTAGE_OUT_OF_RANGE) {
            let zero_v = candidate.table.voltage_zero_v.into();
            let volts = |logs: &[Comparison]| reached(logs, |trace| &trace.voltage, zero_v);
            let (reaches, trained) = (volts(slice::from_ref(comparison)), volts(&candidate.training));
            doubts.push(Doubt::BeyondTraining { log: comparison.name.clone(), reaches, trained });
        }
    }
    let at_bound = candidate.fit.genes.iter().filter(|(gene, value)| gene.undetermined(*value));
    doubts.extend(at_bound.map(|(gene, value)| Doubt::AtBound { gene: gene.name, value: *value }));
    let all = candidate.training.iter().chain(&judged.held_out);
    let difference_um = all.clone().map(|comparison| comparison.mil_sil_um).fold(0.0, f64::max);
    if all.clone().any(|comparison| comparison.mil_sil_um > SINGLE_PRECISION * comparison.mil.stroke_um) {
        doubts.push(Doubt::SinglePrecision { difference_um });
    }
    doubts
}

/// The log whose voltage and displacement are most out of step.
fn out_of_step(logs: &[Comparison]) -> Option<Doubt> {
    let of = |log: &Comparison| Some((log.name.clone(), log.trace.out_of_step(log.mil.stroke_um)?));
    let most = logs.iter().filter_map(of).max_by(|(_, a), (_, b)| a.by_s().abs().total_cmp(&b.by_s().abs()));
    most.map(|(log, of)| Doubt::OutOfStep { log, of })
}

/// An error on a log, its constant offset aside, that is much of the stroke of all logs: a small swing's may be much of
/// its own, and a sensor may be zeroed anew for each. The log with the largest is named.
fn poor<'a>(logs: impl Iterator<Item = (&'a str, Figures)> + Clone) -> Option<Doubt> {
    let stroke_um = logs.clone().map(|(_, figures)| figures.stroke_um).fold(0.0, f64::max);
    let (log, worst) = logs.max_by(|(_, a), (_, b)| a.mae_without_offset_um.total_cmp(&b.mae_without_offset_um))?;
    let percent = 100.0 * worst.mae_without_offset_um / stroke_um;
    (percent > POOR).then_some(Doubt::PoorFit { log: log.to_owned(), percent })
}

/// Constants that are much of the error: of several logs one may be off up and another down. The largest is named.
fn drift<'a>(offsets_um: impl Iterator<Item = (&'a str, f64)> + Clone, held_out: &Figures) -> Option<Doubt> {
    let mean_um = mean(&offsets_um.clone().map(|(_, offset)| offset.abs()).collect::<Vec<_>>());
    let (log, offset_um) = offsets_um.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
    (mean_um > (DRIFT * held_out.mae_um).max(OFFSET * held_out.stroke_um))
        .then(|| Doubt::Drift { log: log.to_owned(), offset_um })
}

/// An error that grows from the beginning of a log to its end by much of the stroke (µm), and by more than what it does
/// beside. The log with the largest is named.
fn trend(logs: &[Comparison], stroke_um: f64) -> Option<Doubt> {
    let of = |log: &Comparison| {
        // A part of a cycle has the course of its own error.
        let swings = reversals(&log.trace.voltage, SWING * Range::of_values(log.trace.voltage.iter().copied()).span());
        let (by_um, left_um) = log.trace.trend_um().filter(|_| swings.len() >= SWINGS)?;
        let within_s = log.trace.time_s.last()? - log.trace.time_s.first()?;
        let steady = by_um.abs() > (GROWS * stroke_um).max(STEADY * left_um);
        steady.then(|| Doubt::Trend { log: log.name.clone(), by_um, within_s })
    };
    let size = |doubt: &Doubt| if let Doubt::Trend { by_um, .. } = doubt { by_um.abs() } else { 0.0 };
    logs.iter().filter_map(of).max_by(|a, b| size(a).total_cmp(&size(b)))
}

/// Whether an error on held-out data is larger than the training's, each beside the logs' own constants, for a stroke;
/// µm.
pub(crate) fn far(training_um: f64, held_out_um: f64, stroke_um: f64) -> bool {
    held_out_um > (FAR * training_um).max(FAR_STROKE * stroke_um)
}

/// A table whose error on the whole logs is larger than the judged model's on either part of them, for a stroke; µm.
fn worse(whole_um: f64, judged_um: f64, stroke_um: f64) -> Option<Doubt> {
    let worse = whole_um > (WORSE * judged_um).max(FAR_STROKE * stroke_um);
    worse.then_some(Doubt::LearntWorse { whole_um, judged_um })
}

/// A straight line that does as well as a candidate.
pub(crate) fn no_better(candidate: &Candidate, line: &Baseline) -> Option<Doubt> {
    let held_out = candidate.held_out_off_um().zip(line.held_out);
    let (error_um, line) = held_out.or(candidate.training_off_um().map(|of| (of, line.training)))?;
    let line_um = line.mae_without_offset_um;
    (error_um > BETTER * line_um).then_some(Doubt::NoBetterThanLine { error_um, line_um })
}

/// The log whose errors hum most.
fn hums(logs: &[Comparison]) -> Option<Doubt> {
    let of = |log: &Comparison| {
        let errors: Vec<f64> = log.trace.estimated.iter().zip(&log.trace.measured).map(|(e, m)| e - m).collect();
        Some((log.name.clone(), hum(&log.trace.time_s, &log.trace.voltage, &errors)?))
    };
    let most = |(_, a): &(String, Hum), (_, b): &(String, Hum)| a.amplitude_um.total_cmp(&b.amplitude_um);
    logs.iter().filter_map(of).max_by(most).map(|(log, hum)| Doubt::Hums { log, hum })
}

/// Whether a table has the lag that was said, s.
fn kept(said: f64, candidate: &Candidate) -> bool {
    let generalised = matches!(candidate.table.parameters, Parameters::GeneralisedPrandtlIshlinskii(_));
    generalised && (candidate.late_s() - said).abs() <= (LAG * said).max(candidate.table.sample_period())
}

/// What a Duhem set does not meet of the thesis's Section 3.3. Admission does not ask for it: the set is bounded
/// all the same.
fn unmet_condition(parameters: &Parameters) -> Option<Doubt> {
    let Parameters::Duhem(of) = parameters else { return None };
    of.unmet_condition().map(|condition| Doubt::UnmetCondition { condition })
}

/// What the logs go over, with this zero.
fn reached(logs: &[Comparison], of: fn(&Trace) -> &[f64], zero: f64) -> Range<f64> {
    Range::of_values(logs.iter().flat_map(|log| of(&log.trace)).map(|value| value + zero))
}

/// Converters whose span is narrower than the training logs.
fn spans(candidate: &Candidate) -> Vec<Doubt> {
    let table = &candidate.table;
    let needed = |values, zero| reached(&candidate.training, values, zero);
    let volts = |code| table.adc.voltage::<f64>(AdcCode(code));
    let um = |code| table.dac.displacement::<f64>(DacCode(code));
    let adc = [volts(0), volts(table.adc.full_scale)];
    let dac = [um(0), um(table.dac.full_scale)];
    let found = [
        (Converter::Adc, adc, needed(|trace| &trace.voltage, table.voltage_zero_v.into())),
        (Converter::Dac, dac, needed(|trace| &trace.estimated, 0.0)),
    ];
    let covers = |span: Range<f64>, needs: &Range<f64>| span.contains(needs.min) && span.contains(needs.max);
    let narrow = found.into_iter().filter(|(_, span, needs)| !covers(Range::of_values(*span), needs));
    narrow.map(|(converter, _, needs)| Doubt::ConverterSpan { converter, needs }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_held_out_is_far_off_where_it_is_worse_than_training_and_more_than_noise() {
        let is_far = |training, held_out| far(training, held_out, 10.0);
        assert!(is_far(0.1, 0.151) && !is_far(0.1, 0.149));
        assert!(is_far(0.001, 0.021) && !is_far(0.001, 0.019), "two thousandths of the stroke");
        assert!(worse(0.21, 0.1, 10.0).is_some() && worse(0.19, 0.1, 10.0).is_none());
    }

    #[test]
    fn a_log_that_is_missed_is_a_poor_fit_and_offsets_of_either_sign_are_a_drift() {
        let of = |stroke: f64, error: f64| Figures::of(&[error, stroke - error], &[0.0, stroke], stroke);
        let [large, small] = [of(10.0, 0.03), of(0.1, 0.03)];
        assert_eq!(poor([("large", large), ("small", small)].into_iter()), None);
        let zeroed = Figures::of(&[5.0, 15.1], &[0.0, 10.0], 10.0);
        assert_eq!(poor([("large", large), ("zeroed anew", zeroed)].into_iter()), None);
        let missed = [("large", large), ("missed", of(8.0, 1.0)), ("small", small)];
        let found = poor(missed.into_iter());
        assert!(
            matches!(found, Some(Doubt::PoorFit { log, percent }) if log == "missed" && (percent - 10.0).abs() < 1e-9)
        );
        let [coarse, fine] = [of(10.0, 1.0), of(10.0, 0.01)];
        let drifts = |offsets: &[f64], held_out| drift(["a", "b"].into_iter().zip(offsets.iter().copied()), held_out);
        let found = drifts(&[0.9, -1.0], &coarse);
        assert!(matches!(found, Some(Doubt::Drift { log, offset_um: -1.0 }) if log == "b"));
        assert!(drifts(&[0.1, -0.1], &coarse).is_none() && drifts(&[], &coarse).is_none());
        assert!(drifts(&[0.012], &fine).is_some() && drifts(&[0.009], &fine).is_none(), "a thousandth of the stroke");
    }
}
