//! What the training determines of an actuator, in words.

use crate::micrometres::Micrometres;
use identifiability::{Determination, Experiment, Found, Told, Unknown};

/// What the lines of [`determination`] are.
pub const DETERMINED: &str =
    "\nWhat the training says of the actuator, ± a standard error, as if the model were right:";

/// What it says, a line each: what it is of, the number with its standard error, and what to record where that
/// is too large.
pub fn determination(of: Result<&Determination, &Unknown>) -> Vec<(String, String)> {
    let of = match of {
        Ok(of) => of,
        Err(why) => return vec![("The training".to_owned(), format!("nothing is known of that: {}", unknown(*why)))],
    };
    let worth = format!(
        "{} readings; once settled, {:.3} µm off on average without each log's own offset; neighbours repeat one another, so they count as {:.0} independent ones",
        of.readings,
        Micrometres(of.mae_um),
        of.effective_readings
    );
    let found = of.found.iter().map(|found| {
        let Found { experiment, value_um, standard_error_um, told, .. } = *found;
        let (what, record) = words(experiment);
        let (value, error) = (Micrometres(value_um), Micrometres(standard_error_um));
        // As many digits of the value as its error leaves.
        let by_model = format!("{value_um:.0$} ± {standard_error_um:.0$} µm", error.decimals(2));
        let said = match told {
            _ if standard_error_um <= 0.0 => "this model has none".to_owned(),
            Told::Well => by_model,
            Told::Partly => format!("{by_model}; to narrow it, record {record}, or more of it"),
            Told::Slower => format!("not known, no log goes as far that fast: record {record}"),
            Told::OtherSwings => format!(
                "{value:.2} µm is what the model extrapolates, for in no log does the voltage swing about as far: record {record}"
            ),
            Told::Restless => format!(
                "{value:.2} µm is what the model extrapolates, for in no log does the voltage stand still so long after a step: record {record}"
            ),
            Told::Not => format!("{by_model}, hardly by these logs: record {record}, or more of it"),
        };
        (what, said)
    });
    std::iter::once(("The training".to_owned(), worth)).chain(found).collect()
}

/// What the lines of [`taught`] are.
pub const TAUGHT: &str = "It would tell of an emulated actuator, beside a sensor of a noise of 0.02 % of its span, ± a standard error in % of the stroke:";

/// What a drive would tell of an actuator, a line each: what it is of, and its standard error or what the drive lacks.
pub fn taught(of: &Determination) -> Vec<(String, String)> {
    let stroke =
        of.found.iter().find(|found| found.experiment == Experiment::Stroke).map_or(f64::NAN, |found| found.value_um);
    let said = |found: &Found| {
        let known = format!("± {:.2} %", 100.0 * found.standard_error_um / stroke);
        let told = match found.told {
            Told::Well => known,
            Told::Partly | Told::Not => format!("{known}; longer (--minutes) narrows it"),
            Told::Slower => "not told: nothing goes as far that fast; faster (--up-to) does".to_owned(),
            Told::OtherSwings => "not told: nothing swings about as far".to_owned(),
            Told::Restless => "not told: no step is held as long; longer (--minutes) does".to_owned(),
        };
        (words(found.experiment).0, told)
    };
    of.found.iter().map(said).collect()
}

fn unknown(why: Unknown) -> &'static str {
    match why {
        Unknown::NothingRead => "there are no two readings, or their voltage rests",
        Unknown::Exact => "the model fits without an error, which says nothing of how uncertain its numbers are",
        Unknown::NoNumber => "the model has no number that a log could tell",
        Unknown::Held => "none of the model's numbers can be a little other without breaking a rule of its tables",
        Unknown::Unstable => {
            "a small change of the model's numbers changes the estimate beyond what can be computed with; another --model may do better"
        }
    }
}

/// What is read off an experiment, and what recording would tell it.
fn words(experiment: Experiment) -> (String, String) {
    match experiment {
        Experiment::Stroke => ("Stroke over its voltages, sine of 1 Hz".to_owned(), "more cycles".to_owned()),
        Experiment::Width { part: 1.0, hz } => {
            (format!("Width of the full loop, sine of {hz} Hz"), format!("the full range at {hz} Hz"))
        }
        Experiment::Width { part, hz } => (
            format!("Width of a loop over the lower {:.0} %, {hz} Hz", 100.0 * part),
            format!("swings of {:.0} % of the range", 100.0 * part),
        ),
        Experiment::Creep => {
            ("Creep from 0.1 to 10 s, after a full step".to_owned(), "a step, and a hold of 10 s".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_is_told_what_it_lacks() {
        let found = |experiment, told, standard_error_um| Found {
            experiment,
            value_um: 10.0,
            standard_error_um,
            before_um: 1.0,
            told,
        };
        let found = vec![found(Experiment::Stroke, Told::Well, 0.01), found(Experiment::Creep, Told::Restless, 0.2)];
        let of = Determination {
            readings: 9,
            effective_readings: 3.0,
            mae_um: 0.01,
            numbers: 1,
            held: 0,
            condition: 1.0,
            found,
        };
        let [stroke, creep] = <[_; 2]>::try_from(taught(&of)).unwrap();
        assert_eq!(stroke.1, "± 0.10 %");
        assert!(creep.1.starts_with("not told: no step is held as long"), "{creep:?}");
    }

    #[test]
    fn what_is_hardly_told_says_why_and_what_to_record() {
        let of = |told, experiment| {
            let found = Found { experiment, value_um: 0.14, standard_error_um: 0.02, before_um: 1.0, told };
            let of = Determination {
                readings: 1_000,
                effective_readings: 100.0,
                mae_um: 0.01,
                numbers: 3,
                held: 0,
                condition: 10.0,
                found: vec![found],
            };
            determination(Ok(&of)).pop().unwrap().1
        };
        let said = of(Told::Restless, Experiment::Creep);
        let why = "in no log does the voltage stand still so long after a step: record a step, and a hold of 10 s";
        assert!(said.starts_with("0.14 µm is what the model extrapolates") && said.ends_with(why), "{said}");
        assert_eq!(of(Told::Well, Experiment::Creep), "0.140 ± 0.020 µm");
        assert!(
            of(Told::Slower, Experiment::Width { part: 1.0, hz: 10.0 }).ends_with("record the full range at 10 Hz")
        );
    }
}
