//! Why a model was chosen, in words.

use identification::{CrossValidation, LeftOut, Reason};

/// Why a model was chosen, as the end of a sentence.
pub fn reason(reason: &Reason) -> String {
    match reason {
        Reason::AskedFor => "it was asked for.".to_owned(),
        Reason::LeastInTraining => "no other comes near its error in training; --model takes another.".to_owned(),
        Reason::CrossValidated(of) => cross_validated(of),
    }
}

fn cross_validated(of: &CrossValidation) -> String {
    let (score, parts) = (of.score(), of.score().parts_um.len());
    let left_out = match of.left_out {
        LeftOut::Logs => format!("{parts} parts of the training logs"),
        LeftOut::Blocks => format!("{parts} stretches of the training data"),
    };
    let best = match (of.chosen, of.scores.first(), of.scores.get(1)) {
        (0, _, Some(next)) => format!(
            "it does best on what it was not fitted to: {:.3} µm where {left_out} were left out in turn; next is {} with \
             {:.3} µm",
            score.error_um, next.model, next.error_um
        ),
        (_, Some(best), _) => format!(
            "of the models that do as well as the best on what they were not fitted to it is the simplest: {:.3} µm where \
             {left_out} were left out in turn; the best is {} with {:.3} µm, a difference within its standard error",
            score.error_um, best.model, best.error_um
        ),
        // There are at least two scores where there is a choice.
        _ => format!("{:.3} µm where {left_out} were left out in turn", score.error_um),
    };
    let unseen = if of.amplitudes { "" } else { ", all of one amplitude, which says nothing of others" };
    format!("{best}{unseen}. --model takes another.")
}
