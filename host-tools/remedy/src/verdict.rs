//! How good an identification is, and what comes next, in words.

use super::paste::{quoted, typed, with_flag};
use estimator_core::{Parameters, Range};
use findings::Micrometres;
use identification::validate::Figures;
use identification::{Doubt, Outcome};
use std::path::Path;

/// An error of which less than this part is left without its constant offset is stated without it first.
const LEFT: f64 = 0.8;
/// A displacement that follows its voltage by so many s, or more, may do so by its sensor.
const LATE_S: f64 = 1e-3;

/// How good it is, in plain words. Of logs that a board recorded the volts are known.
pub fn verdict(outcome: &Outcome, by_board: bool) -> Vec<String> {
    let (candidate, learnt) = (outcome.judged(), &outcome.learnt);
    let mut sentences =
        vec![format!("Model: {}, since {}", candidate.table.model(), findings::reason(&outcome.reason))];
    if let Some(held_out) = candidate.held_out_figures() {
        sentences.push(unseen(&held_out, candidate.held_out.len()));
        if let Some(most) = learnt.logs.iter().filter_map(|log| log.stretches).max() {
            let stretches = if most == 1 { "a stretch".to_owned() } else { format!("up to {most} stretches") };
            sentences.push(format!(
                "What was held out is {stretches} of each log, and not its end, since the ends go through voltages, amplitudes or frequencies \
                 that nothing before them has. A drift shows less so."
            ));
        }
    } else if let Some(training) = candidate.training_figures() {
        sentences.push(format!(
            "On the data it was fitted to the estimate is on average {:.3} µm from the sensor ({:.2} % of the stroke), each log's \
             constant offset aside; on other data it was not tested.",
            Micrometres(training.mae_without_offset_um),
            training.mae_without_offset_percent
        ));
    }
    if learnt.whole.is_some() {
        sentences.push(
            "The table is this model learnt once more, from the whole of each training log. The error above is the model's before that: how far off \
             the table is, `piezo validate` says with a recording that it was not learnt from."
                .to_owned(),
        );
    }
    sentences.push(findings::proven(&learnt.candidate.table));
    let recipe = &learnt.context.recipe;
    sentences.push(format!("{}.", findings::zeros(recipe)));
    sentences.extend(late(outcome));
    let volts = outcome.learnt_from().training_voltages();
    let recorded = Range { min: volts.min + recipe.voltage_zero_v, max: volts.max + recipe.voltage_zero_v };
    if let Some(asked) = findings::monitor_asked(recorded).filter(|_| recipe.voltage_scale == 1.0 && !by_board) {
        sentences.push(format!("The voltage goes from {:.3} to {:.3} V: {asked}.", recorded.min, recorded.max));
    }
    sentences
}

/// How far off it was on so many logs that it had not seen: where a constant offset is much of that, without it first.
fn unseen(held_out: &Figures, logs: usize) -> String {
    let offset = held_out.mae_without_offset_um < LEFT * held_out.mae_um;
    let (mae_um, percent) = match offset {
        true => (held_out.mae_without_offset_um, held_out.mae_without_offset_percent),
        false => (held_out.mae_um, held_out.mae_percent),
    };
    let percent = match logs {
        1 => format!("{percent:.2} % of the {:.1} µm stroke", Micrometres(held_out.stroke_um)),
        _ => format!("{percent:.2} % of the stroke in what was held out of each, on average over {logs} logs"),
    };
    let constant = match logs {
        1 => format!("a constant offset of {:+.3} µm", Micrometres(held_out.offset_um)),
        _ => "a constant offset of each log's own".to_owned(),
    };
    let without = if offset { format!(" without {constant}") } else { String::new() };
    let with = match offset {
        true => format!(
            ". With it, which creep, drift, where the session started or a sensor zeroed anew may leave, it is {:.3} µm",
            Micrometres(held_out.mae_um)
        ),
        false => String::new(),
    };
    format!(
        "On data it had not seen, in simulation from the first sample, the estimate is on average {:.3} µm from the sensor \
         ({percent}){without}{with}, and {:.3} µm where it was furthest, which bounds no other recording.",
        Micrometres(mae_um),
        Micrometres(held_out.max_um)
    )
}

/// That a lateness which was learnt may be the sensor's, unless a doubt says so.
fn late(outcome: &Outcome) -> Option<String> {
    let candidate = &outcome.learnt.candidate;
    let generalised = matches!(candidate.table.parameters, Parameters::GeneralisedPrandtlIshlinskii(_));
    let doubted = |doubt: &Doubt| {
        matches!(
            doubt,
            Doubt::DelayUndetermined { .. } | Doubt::DelayAtBound { .. } | Doubt::AtBound { gene: "delay", .. }
        )
    };
    let late_s = candidate.late_s();
    (generalised && late_s >= LATE_S && !outcome.doubts.iter().any(doubted)).then(|| {
        format!(
            "In this model the displacement follows the voltage by {:.1} ms. Amplifier, actuator and mount may be that slow; but what of it is the \
             sensor's own (a filter, a converter) makes the estimate late by as much: state it with --delay.",
            late_s * 1e3
        )
    })
}

/// What the table is on a board, for whoever has one.
pub fn on_the_board(outcome: &Outcome) -> Vec<String> {
    let table = &outcome.learnt.candidate.table;
    let said = [Some(bench::time(table)), bench::wire_not_found(table)];
    said.into_iter().flatten().map(|said| format!("On the board {said}.")).collect()
}

/// What comes after a table was written to a folder: what to mend where a doubt is grave, which stand first.
pub fn next(doubts: &[Doubt], folder: &Path) -> String {
    let folder = quoted(&folder.display().to_string());
    let first = doubts.first().filter(|doubt| doubt.grave());
    if let Some(Doubt::Flawed { most: true, .. }) = first {
        return "Next: record it again without what is no measurement; until then the table belongs on no board. report.html shows where it is"
            .to_owned();
    }
    if let Some(Doubt::Flawed { .. }) = first {
        return format!(
            "Next: record it again without what is no measurement, or learn without it; until then the table belongs on no board. report.html \
             shows where it is{}",
            with_flag("--repair")
        );
    }
    if first.is_some() {
        return "Next: mend what the first doubt names, and identify again; until then the table belongs on no board. report.html shows the errors"
            .to_owned();
    }
    let board = if doubts.iter().any(|doubt| matches!(doubt, Doubt::ConverterSpan { .. })) {
        "it belongs on a board when the spans of its converters are those of the wiring, and cover the logs".to_owned()
    } else {
        let board =
            Some(typed("--board")).filter(|typed| !typed.is_empty()).unwrap_or(" --board board.toml".to_owned());
        format!("put it on a board with `piezo install {folder}{board}`")
    };
    format!(
        "Next: look at report.html; try the table on another recording with `piezo validate {folder}/table.toml LOG`; {board}"
    )
}

/// The doubts, the gravest first, or that there is none.
pub fn doubts(doubts: &[Doubt]) -> String {
    if doubts.is_empty() {
        return "No doubt was found. That is no proof: an actuator that is warmer, aged, differently loaded, or driven in another way than in \
                these logs may behave otherwise."
            .to_owned();
    }
    let said = doubts.iter().map(|doubt| format!("\n- {}", findings::doubt(doubt)));
    format!("When not to trust it:{}", said.collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_mostly_a_constant_is_said_without_it_first() {
        let measured = [0.0, 3.0, 6.0, 10.0];
        let of = |offset: f64| Figures::of(&[0.1, 2.9, 6.1, 9.9].map(|estimate| estimate + offset), &measured, 10.0);
        let said = unseen(&of(2.0), 1);
        assert!(
            said.contains("µm stroke) without a constant offset of +2.100 µm. With it")
                && said.contains(", it is 2.000 µm"),
            "{said}"
        );
        let said = unseen(&of(2.0), 2);
        assert!(said.contains("over 2 logs) without a constant offset of each log's own. With it"), "{said}");
        let said = unseen(&of(0.0), 1);
        assert!(said.contains("is on average 0.100 µm") && !said.contains("offset"), "{said}");
    }
}
