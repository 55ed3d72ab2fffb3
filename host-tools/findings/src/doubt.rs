//! Reasons not to trust an identification. Each doubt says what was seen, what it means and what helps.

use crate::flaw::flawed;
use crate::micrometres::Micrometres;
use crate::raised::remarks;
use crate::short::short;
use calibration::{Assumed, CalibrationOptions};
use estimator_core::{DuhemCondition, Range, Status};
use identification::validate::{OutOfStep, Raised, compare};
use identification::{Candidate, Converter, Doubt, FEW_REVERSALS, Outcome};
use log_survey::{Ahead, Hum, Implausible, OtherScale};
use recordings::session::Session;
use serde_json::{Value, json};

/// A half-width beyond this percentage of the stroke says next to nothing.
const WIDE: f64 = 10.0;
/// What is untrained for less of the time, %, is a glitch.
const RARE: f64 = 1.0;

/// A doubt as the user reads it.
pub fn doubt(doubt: &Doubt) -> String {
    match doubt {
        Doubt::EstimatedDisplacement { log } => format!(
            "the displacement of {log} is a device's estimate (piezo record), no sensor's: fitted to it the model learns \
             that estimator with its errors, and an error on it looks too good; use logs with a real sensor's \
             displacement"
        ),
        Doubt::RunsAhead { log, by: Ahead { percent, loops } } => format!(
            "in {log} {}; if they are the right ones, the voltage was read later than the displacement: record both at once",
            runs_ahead(&Ahead { percent: *percent, loops: *loops })
        ),
        Doubt::OutOfStep { log, of: OutOfStep::VoltageLate { by_s } } => format!(
            "in {log} the displacement comes before the voltage, by {} ms more than a model can have, and that is most of the error: is \
             the voltage filtered, or read by another converter that is late? Record both at once",
            short(by_s * 1e3)
        ),
        Doubt::OutOfStep { log, of: OutOfStep::ClocksDiffer { by_s } } => format!(
            "in {log} the displacement is {} ms {} at the end than at the beginning: do two instruments with clocks of their own record \
             voltage and displacement? Record both by one clock",
            short((by_s * 1e3).abs()),
            if *by_s > 0.0 { "later" } else { "earlier" }
        ),
        Doubt::OtherGain { log, factor } => {
            let (percent, what) = ((100.0 * (factor - 1.0)).abs(), if *factor > 1.0 { "farther" } else { "less far" });
            format!(
                "the sensor of {log} goes {percent:.0} % {what} than the others' where the voltage goes as far, and the model goes in between: \
                 has it another range, scale or mount there, or the actuator another load? Record it again as the others were, or learn \
                 without it"
            )
        }
        Doubt::AtBound { gene: "delay", value } => format!(
            "`delay`, how many ticks the displacement is behind the voltage, ended at the end of its range ({value:.4}): where the sensor \
             is later, state by how much with --delay (its data sheet, or a step, says so), or have it looked for with --delay auto and \
             a --max-delay beyond; else the logs do not determine it: record more frequencies, or a step"
        ),
        Doubt::AtBound { gene, value } => format!(
            "`{gene}` ended at the end of its range ({value:.4}): the optimum may lie beyond, or the logs do not \
             determine it; record more frequencies and amplitudes, or choose a simpler --model"
        ),
        Doubt::PoorFit { log, percent } => format!(
            "in training the error on {log} is {percent:.1} % of the stroke, a constant offset aside: the model does not describe this log; are \
             its columns and units right, is the sensor's delay within reason (--delay), and was the amplifier at its limit?"
        ),
        Doubt::Flawed { log, worst, count, left_out, most } => flawed(log, worst, *count, *left_out, *most),
        Doubt::Unfinished { missing } => format!("{missing}: identify again once it is whole, or record another"),
        Doubt::HeldOutFar { training_um, held_out_um, learnt_since } => format!(
            "on the held-out data the error without offset is {:.3} µm, in training {:.3} µm: the model \
             has learnt this recording rather than the actuator, the two were recorded under other conditions, or what was held out goes as nothing \
             that was learnt from did{}",
            Micrometres(*held_out_um),
            Micrometres(*training_um),
            if *learnt_since { ". The table was learnt from both since; how far off the table is, only another recording says (piezo validate)" } else { "" }
        ),
        Doubt::LearntWorse { whole_um, judged_um } => format!(
            "the table was learnt once more from the whole logs, and is off by {:.3} µm on them without offset, where the model before was by {:.3} µm \
             at most: something changed within a log (the sensor's gain, the load, the mounting), and the errors above are not the table's; \
             record it again, or keep one part with --skip-start or --skip-end",
            Micrometres(*whole_um),
            Micrometres(*judged_um)
        ),
        Doubt::NothingHeldOut => {
            "nothing was held out, so nothing is known of data it has not seen: use --validate-on or --hold-out"
                .to_owned()
        }
        Doubt::Diverges { fed_um, simulation_um } => format!(
            "fed with the measured displacement the error is {:.4} µm, but in simulation, which is what the \
             estimator does, {:.3} µm: use --cost simulation",
            Micrometres(*fed_um),
            Micrometres(*simulation_um)
        ),
        Doubt::Transient { log, until_s } => format!(
            "{log} fits far worse in its first {until_s:.3} s than later, as a start-up transient does: look at it in the \
             report. A start from rest is worth keeping, since creep and memory begin there; what is no measurement cut off \
             with --skip-start"
        ),
        Doubt::UnmetCondition { condition } => format!(
            "the identified set breaks a condition of Duhem's model (thesis, 3.3), {condition}: beyond the logs' voltages, \
             or after other reversals than theirs, {}; record wider swings with smaller ones inside, or choose --model \
             bouc-wen",
            match condition {
                DuhemCondition::Increasing | DuhemCondition::Rising =>
                    "the displacement may fall while the voltage rises",
                DuhemCondition::Even => "the two branches of a loop may not meet at its ends",
                DuhemCondition::Lagging => "the displacement may run ahead of the voltage",
            }
        ),
        Doubt::FewReversals { reversals } => format!(
            "hysteresis needs at least {FEW_REVERSALS} reversals of the voltage, and the training logs have {reversals}: record \
             several cycles"
        ),
        Doubt::SingleFrequency { lag_known: false } => {
            "the training logs have a single frequency: lag and hysteresis cannot be told apart, and at other \
             frequencies the estimate may be wrong; record a held step besides (readings at most 5 ms apart) or several \
             frequencies, or state --lag by a data sheet"
            .to_owned()
        }
        Doubt::SingleFrequency { lag_known: true } => {
            "the training logs have a single frequency: at others the estimate may be wrong; record several"
            .to_owned()
        }
        Doubt::NoFastMove => {
            "in no training log does the voltage go fast from one level to another and stand still then (readings at most 5 ms apart), \
             so that nothing shows how the actuator comes to rest: there the ± may be too narrow; record a staircase besides"
                .to_owned()
        }
        Doubt::SingleAmplitude { extremum_terms: true } => {
            "the training logs have a single amplitude, which teaches a single loop: the extremum terms are not \
             determined and can be far off at other amplitudes; record several, or use --model voigt"
            .to_owned()
        }
        Doubt::SingleAmplitude { extremum_terms: false } => {
            "the training logs have a single amplitude, which teaches a single loop: at other amplitudes the error \
             is unknown; record several"
            .to_owned()
        }
        Doubt::Drift { log, offset_um } => format!(
            "on {log}, held out, the estimate is off by a constant {:+.3} µm (creep, drift, where the \
             session started, or a sensor that was zeroed anew), which no sensorless estimate can know: set the zero again at rest",
            Micrometres(*offset_um)
        ),
        Doubt::Trend { log, by_um, within_s } => format!(
            "on {log}, held out, the error goes by {:+.3} µm within {within_s:.0} s, in one direction: the sensor drifts or was moved, or the \
             actuator or its mount warms up, and some of that may be learnt as creep, or the actuator creeps, and this model does not (most have no \
             creep; --model generalised-prandtl-ishlinskii has); let them come to a steady temperature, and record it again",
            Micrometres(*by_um)
        ),
        Doubt::SinglePrecision { difference_um } => {
            format!(
                "the f32 core differs from the f64 reference by up to {difference_um:.2e} µm: use a deadband above the \
                 noise (--deadband) or a longer tick (--tick-us)"
            )
        }
        Doubt::OtherScale(of) => other_scale(of),
        Doubt::BeyondTraining { log, reaches, trained } => format!(
            "the voltage of {log} goes beyond the training logs (it reads {} … {} V, and they {} … {} V): there the estimate holds the \
             nearest known voltage; train on logs that reach as far",
            short(reaches.min),
            short(reaches.max),
            short(trained.min),
            short(trained.max)
        ),
        Doubt::Untrained { log, percent, first_s } => format!(
            "on {log} {}; learn from logs with swings such as these, too",
            remarks(&[Raised { bit: Status::UNTRAINED, percent: *percent, first_s: *first_s }])
        ),
        Doubt::Hums { log, hum: Hum { hertz, amplitude_um, percent } } => format!(
            "the error on {log} swings by ±{:.4} µm at {hertz} Hz most of the time, {percent:.0} % of its mean square, as mains hum does that the \
             sensor's or the monitor's cable picks up: it is in every error that is said here, and no motion; shield the cables, or ground \
             them at one end, and record again",
            Micrometres(*amplitude_um)
        ),
        Doubt::NoisyVoltage { reversals, large } => format!(
            "the voltage reverses {reversals} times, but only {large} times by more than 10 % of its span: noise passes \
             for reversals; give a --deadband above it"
        ),
        Doubt::NoBetterThanLine { error_um, line_um } => format!(
            "without offset the model is off by {:.4} µm and a straight line by {:.4} µm, no better than a straight line: the logs show no \
             hysteresis that it could learn, or it is none for them; record the full range, slowly, or choose another --model",
            Micrometres(*error_um),
            Micrometres(*line_um)
        ),
        Doubt::WideInterval { half_um, percent } => format!(
            "the ± beside the estimate is ±{:.3} µm at least, {percent:.0} % of the stroke: another table made from logs like these \
             could be as far off; record several amplitudes and frequencies over the full range, or choose another --model",
            Micrometres(*half_um)
        ),
        Doubt::ConverterSpan { converter, needs: Range { min, max } } => format!(
            "the span of the {} does not cover the logs, which need {} … {} {} of it: beyond, the converter stands at its end{}; state the \
             span that its wiring has",
            named(*converter),
            short(*min),
            short(*max),
            if *converter == Converter::Adc { "V" } else { "µm" },
            if *converter == Converter::Adc { ", and a board's estimate is wrong" } else { "" }
        ),
        Doubt::ImplausibleStroke(of) => implausible(of),
        Doubt::CalibrationAssumed { converters } => match converters {
            Assumed::Both => "the ADC and DAC calibration is assumed (their ranges span the logs): state --adc-span and --dac-span \
                              before flashing",
            Assumed::Adc => "the ADC's calibration is assumed (its range spans the logs), the DAC's is stated: state --adc-span, too, \
                             before flashing",
            Assumed::Dac => "the DAC's calibration is assumed (its range spans the estimate's limits), the ADC's is stated: state \
                             --dac-span or --drive-span, too, before flashing",
        }
        .to_owned(),
        Doubt::DelayUndetermined { late_ms } => format!(
            "--delay auto found no delay that a lag would not do as well as: what the displacement is behind the voltage by, {late_ms:.2} ms or so, \
             is taken for the amplifier's and the actuator's; where it is the sensor's, state it with --delay by its data sheet, or record a step or \
             higher frequencies"
        ),
        Doubt::DelayAtBound { delay_ms } => format!(
            "the sensor is later than the most that --delay auto may take ({delay_ms} ms): give --delay from its data sheet, or a --max-delay \
             beyond"
        ),
    }
}

/// Adds to the doubts of an outcome that the session of its logs is not whole, where something is `missing` of it.
pub fn doubt_session(outcome: &mut Outcome, missing: Option<String>) {
    outcome.doubts.extend(missing.map(|missing| Doubt::Unfinished { missing }));
    outcome.doubts.sort_by_key(Doubt::rank);
}

/// Adds to the doubts of an outcome those of its interval, which come after them: where it is wide, and where the
/// voltage of a held-out log goes as it never went in the training, which no table without an interval says.
pub fn doubt_interval(outcome: &mut Outcome) {
    let untrained: Vec<Doubt> =
        outcome.learnt_from().validation().filter_map(|log| untrained(&outcome.learnt.candidate, log)).collect();
    outcome.doubts.extend(untrained);
    outcome.doubts.extend(wide(&outcome.learnt.candidate));
    outcome.doubts.sort_by_key(Doubt::rank);
}

/// How often the voltage of a held-out log goes as it never went in the training, where that is more than rare.
fn untrained(candidate: &Candidate, session: &Session) -> Option<Doubt> {
    let raised = compare(&candidate.table, session).raised;
    let Raised { percent, first_s, .. } = raised.into_iter().find(|raised| raised.bit == Status::UNTRAINED)?;
    (percent > RARE).then(|| Doubt::Untrained { log: session.name.clone(), percent, first_s })
}

/// The interval of a candidate, where it is wide.
fn wide(candidate: &Candidate) -> Option<Doubt> {
    let half_um = f64::from(candidate.table.interval?.misfit_um);
    let percent = 100.0 * half_um / candidate.training_figures()?.stroke_um;
    (percent > WIDE).then_some(Doubt::WideInterval { half_um, percent })
}

/// What a displacement that runs ahead of the voltage may be.
pub fn runs_ahead(Ahead { percent, loops }: &Ahead) -> String {
    format!(
        "the displacement runs ahead of the voltage, by {percent:.1} % of its way on the {loops} slowest loops, as no actuator's does: are \
         the two columns exchanged? Then exchange their names in the file's header, or, where it has none, name them in --columns"
    )
}

/// What the other scale of a log may be.
fn other_scale(OtherScale { log, um_per_v, others_um_per_v, others }: &OtherScale) -> String {
    let (those, which) = if *others == 1 { ("other log", "one of the two") } else { ("other logs", "it") };
    format!(
        "{log} moves {} µm a volt and the {those} {} µm, which is not one actuator: is {which} in other volts (the actuator's beside a \
         monitor's), by another sensor's scale, or of another actuator? Options such as --voltage-scale hold for all logs: multiply the \
         column in its file by the factor between them, or leave the log out",
        short(*um_per_v),
        short(*others_um_per_v)
    )
}

/// What is doubtful of a stroke.
pub fn implausible(of: &Implausible) -> String {
    let monitor = match of.um_per_v() > Implausible::MOST_UM_PER_V {
        true => {
            "is the voltage a monitor's, or the amplifier's input (--voltage-scale <N>, 20 of a monitor 1:20)? Else "
        }
        false => "",
    };
    format!(
        "the displacement goes over {} µm and the voltage over {} V, {} µm/V, which is no piezo actuator's ({} … {} µm/V, {} mm at \
         most): {monitor}is the unit right, and the sensor's scale? --columns and --sensor state another",
        short(of.stroke_um),
        short(of.span_v),
        short(of.um_per_v()),
        Implausible::LEAST_UM_PER_V,
        Implausible::MOST_UM_PER_V,
        1e-3 * Implausible::LARGEST_UM
    )
}

/// Brings what is said of a table's calibration to what is stated now, beside what was before.
pub fn calibrated(doubts: &mut Vec<String>, now: &CalibrationOptions) {
    let said = |assumed: &Assumed| doubt(&Doubt::CalibrationAssumed { converters: *assumed });
    let all = [Assumed::Adc, Assumed::Dac, Assumed::Both];
    let Some((at, before)) = all.iter().find_map(|of| Some((doubts.iter().position(|doubt| *doubt == said(of))?, of)))
    else {
        return;
    };
    doubts.remove(at);
    let left = match (before, now.assumed()) {
        (_, None) | (Assumed::Adc, Some(Assumed::Dac)) | (Assumed::Dac, Some(Assumed::Adc)) => None,
        (Assumed::Both, left) => left,
        (before, Some(_)) => Some(*before),
    };
    doubts.splice(at..at, left.map(|left| said(&left)));
}

/// A doubt for machines.
pub fn doubt_json(doubt: &Doubt) -> serde_json::Result<Value> {
    let mut value = serde_json::to_value(doubt)?;
    if let Doubt::ConverterSpan { converter, .. } = doubt {
        value["converter"] = json!(named(*converter));
    }
    Ok(value)
}

/// A converter and its option.
fn named(converter: Converter) -> &'static str {
    match converter {
        Converter::Adc => "ADC (--adc-span)",
        Converter::Dac => "DAC (--dac-span)",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use log_survey::{Flaw, Stretch};

    const FLAW: Flaw = Flaw::Spike { at: Stretch { from_s: 1.0, to_s: 1.0 }, leap_um: 9.0, back: true };

    #[test]
    fn a_stroke_is_doubted_by_the_limits_that_are_asked() {
        let said = implausible(&Implausible { stroke_um: 1e4, span_v: 40.0 });
        assert!(said.contains("250 µm/V, which is no piezo actuator's (0.0002 … 200 µm/V, 2 mm at most)"), "{said}");
        let small = implausible(&Implausible { stroke_um: 0.015, span_v: 100.0 });
        assert!(said.contains("--voltage-scale <N>") && !small.contains("--voltage-scale"), "{said} {small}");
    }

    #[test]
    fn a_delay_at_its_end_has_the_option_that_states_it() {
        let said = doubt(&Doubt::AtBound { gene: "delay", value: 15.0 });
        assert!(said.contains("state by how much with --delay") && said.contains("--max-delay"), "{said}");
    }

    #[test]
    fn every_doubt_says_what_helps() {
        let all = [
            Doubt::EstimatedDisplacement { log: "c".into() },
            Doubt::AtBound { gene: "p", value: 2.5 },
            Doubt::PoorFit { log: "d".into(), percent: 40.0 },
            Doubt::Flawed { log: "e".into(), worst: FLAW, count: 3, left_out: false, most: false },
            Doubt::Unfinished { missing: "the session ended before its time".into() },
            Doubt::HeldOutFar { training_um: 0.1, held_out_um: 1.0, learnt_since: true },
            Doubt::LearntWorse { whole_um: 1.5, judged_um: 0.039 },
            Doubt::NothingHeldOut,
            Doubt::Diverges { fed_um: 0.01, simulation_um: 3.0 },
            Doubt::Transient { log: "a".into(), until_s: 0.3 },
            Doubt::UnmetCondition { condition: DuhemCondition::Rising },
            Doubt::UnmetCondition { condition: DuhemCondition::Lagging },
            Doubt::FewReversals { reversals: 2 },
            Doubt::SingleFrequency { lag_known: false },
            Doubt::SingleFrequency { lag_known: true },
            Doubt::NoFastMove,
            Doubt::SingleAmplitude { extremum_terms: true },
            Doubt::SingleAmplitude { extremum_terms: false },
            Doubt::RunsAhead { log: "f".into(), by: Ahead { percent: 9.0, loops: 5 } },
            Doubt::OutOfStep { log: "f".into(), of: OutOfStep::VoltageLate { by_s: 6e-3 } },
            Doubt::OutOfStep { log: "f".into(), of: OutOfStep::ClocksDiffer { by_s: -6e-3 } },
            Doubt::OtherGain { log: "f".into(), factor: 0.91 },
            Doubt::Untrained { log: "g".into(), percent: 13.79, first_s: 2.0 },
            Doubt::AtBound { gene: "delay", value: 15.0 },
            Doubt::Drift { log: "h".into(), offset_um: -0.2 },
            Doubt::Trend { log: "h".into(), by_um: -0.8, within_s: 16.4 },
            Doubt::SinglePrecision { difference_um: 0.1 },
            Doubt::BeyondTraining {
                log: "b".into(),
                reaches: Range { min: -1.0, max: 140.0 },
                trained: Range { min: 0.0, max: 100.0 },
            },
            Doubt::OtherScale(OtherScale { log: "c".into(), um_per_v: 0.006, others_um_per_v: 0.12, others: 1 }),
            Doubt::Hums { log: "i".into(), hum: Hum { hertz: 50, amplitude_um: 0.02, percent: 91.0 } },
            Doubt::NoisyVoltage { reversals: 900, large: 20 },
            Doubt::NoBetterThanLine { error_um: 0.2179, line_um: 0.2153 },
            Doubt::WideInterval { half_um: 2.887, percent: 22.0 },
            Doubt::ConverterSpan { converter: Converter::Adc, needs: Range { min: -1.0, max: 100.0 } },
            Doubt::ImplausibleStroke(Implausible { stroke_um: 1e4, span_v: 40.0 }),
            Doubt::CalibrationAssumed { converters: Assumed::Both },
            Doubt::CalibrationAssumed { converters: Assumed::Adc },
            Doubt::CalibrationAssumed { converters: Assumed::Dac },
            Doubt::DelayAtBound { delay_ms: 5.0 },
            Doubt::DelayUndetermined { late_ms: 3.1 },
        ];
        for doubt in all {
            let text = super::doubt(&doubt);
            assert!(text.len() > 40 && !text.contains("  "), "{text}");
        }
    }
}
