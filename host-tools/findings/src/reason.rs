//! Why a model was chosen, in words.

use crate::micrometres::Micrometres;
use identification::{CrossValidation, LeftOut, Reason, Undecided};

/// Why a model was chosen, as the end of a sentence.
pub fn reason(reason: &Reason) -> String {
    match reason {
        Reason::AskedFor => "it was asked for.".to_owned(),
        Reason::Least(Undecided::ByFar) => {
            "once the start of each log has settled, no other comes near its error in training; --model takes another."
                .to_owned()
        }
        Reason::Least(Undecided::Undivided) => least("the logs are too short to leave a part out"),
        Reason::Least(Undecided::WithoutParts) => least("without a part of the logs no model was found"),
        Reason::CrossValidated(of) => cross_validated(of),
        Reason::OnceMore { validated, first } => {
            let why = match validated {
                Some(of) => cross_validated(of),
                None => "on the whole logs it is off by far less in training; --model takes another.".to_owned(),
            };
            format!(
                "{why} By the part that was not held out it was {first}, which was far off on what was: the choice was made once more, \
                 on the whole logs, among the models that were nearest there, so that what was held out has had a say in it."
            )
        }
    }
}

/// Why nothing but the training chose.
fn least(since: &str) -> String {
    format!(
        "once the start of each log has settled, its error in training is the least, and there is no other measure: {since}; \
         --model takes another."
    )
}

/// What is said where the mean logarithm of the next model's errors, beside the best's, is no more than
/// its standard error.
fn close((difference, error): (f64, f64)) -> String {
    let percent = |logarithm: f64| 100.0 * logarithm.exp_m1();
    match difference <= error {
        true => format!(
            ", and the choice is close: {:.1} % more, with a standard error of {:.1} %",
            percent(difference),
            percent(error)
        ),
        false => String::new(),
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
             {:.3} µm{}",
            Micrometres(score.error_um),
            next.model,
            Micrometres(next.error_um),
            close(of.by(next))
        ),
        (_, Some(best), _) => format!(
            "of the models that do as well as the best on what they were not fitted to it is {}: {:.3} µm where {left_out} were \
             left out in turn; the best is {} with {:.3} µm, a difference within its standard error",
            if 2 * score.parameters <= best.parameters {
                "the simplest"
            } else {
                "the one that says most of other amplitudes"
            },
            Micrometres(score.error_um),
            best.model,
            Micrometres(best.error_um)
        ),
        // There are at least two scores where there is a choice.
        _ => format!("{:.3} µm where {left_out} were left out in turn", Micrometres(score.error_um)),
    };
    let unseen = if of.amplitudes { "" } else { "; the stretches all have one amplitude, and say nothing of others" };
    format!("{best}{unseen}. --model takes another.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Model;
    use identification::validate::score::Score;

    #[test]
    fn a_choice_that_is_close_is_said_to_be() {
        let score = |model, parts: [f64; 4]| Score {
            model,
            parameters: 9,
            error_um: parts.iter().product::<f64>().powf(0.25),
            parts_um: parts.to_vec(),
        };
        let said = |next: [f64; 4]| {
            let scores = vec![score(Model::BoucWen, [0.08, 0.081, 0.082, 0.081]), score(Model::Duhem, next)];
            cross_validated(&CrossValidation { left_out: LeftOut::Logs, scores, chosen: 0, amplitudes: true })
        };
        let close = said([0.078, 0.085, 0.08, 0.089]);
        assert!(close.contains("the choice is close: 2.3 % more, with a standard error of 3.0 %"), "{close}");
        let clear = said([0.18, 0.185, 0.182, 0.181]);
        assert!(!clear.contains("close"), "{clear}");
    }
}
