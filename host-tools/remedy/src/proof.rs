//! What a table is good for on a board: the voltages that it was learnt on beside the board's, and what a
//! proof fails for.

use super::paste::typed;
use ::calibration::drive::trained_on;
use bench::{OtherRange, Proven, Shares};
use device_link::play::PlayError;
use estimator_core::{Range, Table};
use findings::Micrometres;
use findings::figures::{heading, row};
use std::path::Path;

/// What a table that was learnt on another range than the board's is good for.
pub fn other_range(of: &OtherRange) -> String {
    match of.lacks() {
        true => format!("{of}. {}", within(of)),
        false => {
            format!("{of}: it holds there, too. Is drive_range in board.toml right, and is it this actuator's table?")
        }
    }
}

/// The lines of a proof that went up to this frequency.
pub fn proof(proven: &Proven, up_to_hz: f64) -> Vec<String> {
    let Proven { figures, shares, verdict, log, .. } = proven;
    let held = shares.held_percent.zip(shares.half_width_um).map(|(held, half)| {
        format!("± {:.3} µm on average holds the sensor {held:.1} % of the time", Micrometres(half))
    });
    let went = format!(
        "{:.1} % of the time the voltage went as it never did in the training, {:.1} % it leapt, or it or the estimate was at a limit",
        shares.untrained_percent, shares.beyond_percent
    );
    let figures = [heading("the board's estimate, zeroed at rest"), row("random voltage", figures)];
    let judged = [went, log.display().to_string(), verdict.to_string()];
    let cure = (!verdict.passed).then(|| unproven(proven, up_to_hz));
    figures.into_iter().chain(held).chain(judged).chain(cure).chain([zeroed()]).collect()
}

/// What a proof has recorded that ended before its time.
pub fn proof_kept(log: &Path) -> String {
    format!(
        "nothing is proven; {} holds what was recorded since the zero: the next proof needs another --out",
        log.display()
    )
}

/// What a proof leaves that was interrupted, with the voltage at rest, and a log where it had come to that.
pub fn proof_interrupted(why: &PlayError, log: Option<&Path>) -> String {
    let log = log.map_or(String::new(), |log| {
        format!(
            "; {} holds what was recorded since the zero: the next proof needs another --out.\n{}",
            log.display(),
            zeroed()
        )
    });
    format!("{why}: nothing is proven, and the voltage has gone back to rest{log}")
}

/// What is said of a drive along a line that was interrupted, with the voltage on its way to rest, and a log where
/// there is one.
pub fn follow_interrupted(why: &PlayError, log: Option<&Path>) -> String {
    let log = log.map_or(String::new(), |log| format!("; {} holds what was recorded", log.display()));
    format!("{why}: the voltage goes back to rest, and the device estimates{log}")
}

/// What feeding a device that had been told its displacement leaves behind.
pub fn zero_lost() -> String {
    format!(
        "the estimate began anew, and its zero is lost: `piezo zero --at '<UM>'{}` tells it again.",
        typed("--port")
    )
}

/// What a proof leaves behind.
fn zeroed() -> String {
    format!(
        "The board calls the displacement at rest 0 since: `piezo zero --at '<UM>'{}` tells it another.",
        typed("--port")
    )
}

/// An error of so much of the stroke, %, is none that a longer training makes smaller.
const ANOTHER_S: f64 = 50.0;
/// Part of the time, %, in which the voltage went where the training did not, that a failed proof is put down to.
const OFTEN: f64 = 5.0;

/// An error so many times the table's own on what was held out is no longer this actuator's by this table; one of no
/// more than so many times is the model's.
const FAR: f64 = 3.0;
const ALIKE: f64 = 1.5;

/// What to do about a proof that fails, which went up to this frequency, and what the device does from now on.
fn unproven(proven: &Proven, up_to_hz: f64) -> String {
    format!(
        "{}\nThe board goes on with this table, of checksum {:08x}, until another is installed.",
        cure(proven, up_to_hz),
        proven.table
    )
}

fn cure(proven: &Proven, up_to_hz: f64) -> String {
    let Proven { figures, shares, verdict, learnt: Range { min, max }, held_out_um, .. } = proven;
    let train = format!("train as the proof goes: --up-to {up_to_hz} at least, over its --range");
    let longer = format!("rain again, longer (--minutes), --up-to {up_to_hz} at least");
    let another_s =
        "is it this actuator's table, is its load the same, and is what board.toml says right (`piezo calibrate`)?";
    if figures.mae_percent > ANOTHER_S {
        return format!("Longer training will not cure an error as large as this: {another_s}");
    }
    if shares.beyond_percent > OFTEN {
        let within = format!("prove within {min:.3} … {max:.3} V, which the table was learnt on (--range), or {train}");
        return beyond(shares, &within);
    }
    if shares.untrained_percent > OFTEN {
        return format!(
            "The proof went, within the {min:.3} … {max:.3} V that the table was learnt on, as the training never did: {train}"
        );
    }
    let times = held_out_um.filter(|um| *um > 0.0).map(|um| (Micrometres(um), figures.mae_um / um));
    match times {
        Some((um, times)) if times > FAR => format!(
            "The table is {times:.1} times as far off here as it was on what was held out when it was learnt, {um:.3} µm: {another_s} If all of it is so, \
             t{longer}."
        ),
        Some((um, times)) if times <= ALIKE && verdict.too_far_off() => format!(
            "The model was as far off on what was held out when it was learnt, {um:.3} µm, and longer training will not cure that: identify with \
             another --model, or without --model, so that it chooses."
        ),
        _ => format!("T{longer}."),
    }
}

/// Unlike the remedies of a status bit, these go by board.toml, which `prove` and `install` ask for.
const DIVIDER: &str = "less voltage, or a divider for more (piezo divider), then piezo calibrate and piezo install";
const WIRE: &str =
    "a sound, shielded wire; is amplifier_slew in board.toml what the amplifier can? then piezo install again";
/// A cause that was there for less of the time is no reason, and would be printed as 0.0, %.
const LEAST_SAID_PERCENT: f64 = 0.05;

/// How often the table said nothing of the actuator, by cause, and what to do about each: `within` where it
/// knows no more.
fn beyond(shares: &Shares, within: &str) -> String {
    let causes = [
        (shares.out_of_range_percent, "the voltage was beyond the table's range", within),
        (shares.clamped_percent, "the estimate was clamped to the table's limits", within),
        (shares.saturated_percent, "the voltage stood at an end of the ADC's range", DIVIDER),
        (shares.leapt_percent, "the voltage leapt as the amplifier cannot", WIRE),
    ];
    let raised = || causes.iter().filter(|(percent, ..)| *percent >= LEAST_SAID_PERCENT);
    let said: Vec<String> = raised().map(|(percent, what, _)| format!("{what} {percent:.1} % of the time")).collect();
    let mut remedies: Vec<&str> = raised().map(|(.., remedy)| *remedy).collect();
    remedies.dedup();
    format!("In the proof {}: {}", said.join(", "), remedies.join("; "))
}

/// How a table is kept to what it knows, or learns the rest.
fn within(of: &OtherRange) -> String {
    let stated =
        |option, else_: &str| Some(typed(option)).filter(|typed| !typed.is_empty()).unwrap_or(else_.to_owned());
    let learn = format!(
        "learn all of it:\n    piezo learn --range {}:{} --out '<FOLDER>'{}{}",
        of.driven.min,
        of.driven.max,
        stated("--board", " --board '<FILE>'"),
        typed("--port")
    );
    match of.common() {
        Some(Range { min, max }) => {
            format!(
                "Beyond that it takes the nearest voltage that it knows: prove with --range {min}:{max}, and install it with \
                 drive_range = [{min}, {max}] in board.toml, so that it is driven there alone; or {learn}"
            )
        }
        None => format!("It says nothing of the board's voltages: is it this actuator's? Else {learn}"),
    }
}

/// A table that was learnt on less of the ADC's range is remarked on.
const NARROW: f32 = 0.1;

/// What is to be said of a table that knows hardly any of what the board's ADC reads: one that was learnt from an
/// amplifier's input knows volts that are its output's many times over.
pub fn narrow(table: &Table) -> Option<String> {
    let reads = table.adc.gain_v_per_code * f32::from(table.adc.full_scale);
    let Range { min, max } = trained_on(table);
    ((max - min) < NARROW * reads).then(|| {
        format!(
            "the table was learnt on {min:.3} … {max:.3} V, {:.1} % of what the board's ADC reads: was it learnt from the amplifier's input? Then \
             identify with --voltage-scale, the amplifier's gain; else --narrow says that it may be installed",
            100.0 * (max - min) / reads
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use bench::{Shares, Verdict};
    use validation::Figures;

    #[test]
    fn a_proof_that_fails_says_what_the_training_lacks() {
        let said_of =
            |off_um: f64, untrained_percent, [out_of_range, clamped, saturated, leapt]: [f64; 4], held_out_um| {
                let figures = Figures::of(&[0.0 + off_um, 10.0 + off_um], &[0.0, 10.0], 10.0);
                let shares = Shares {
                    held_percent: None,
                    half_width_um: None,
                    untrained_percent,
                    beyond_percent: out_of_range + clamped + saturated + leapt,
                    out_of_range_percent: out_of_range,
                    saturated_percent: saturated,
                    leapt_percent: leapt,
                    clamped_percent: clamped,
                };
                let verdict = Verdict::of(&figures, &shares, None);
                let learnt = Range { min: 0.0, max: 40.0 };
                let (table, log) = (0x42a0_759b, "proven.csv".into());
                unproven(&Proven { figures, shares, verdict, learnt, held_out_um, table, log, home: Ok(()) }, 20.0)
            };
        let said = |off_um, untrained_percent, causes| said_of(off_um, untrained_percent, causes, None);
        assert!(
            said(1.0, 0.0, [0.0; 4])
                .ends_with("\nThe board goes on with this table, of checksum 42a0759b, until another is installed.")
        );
        // Beside what the table itself was off.
        let beside = |held_out_um| said_of(1.0, 0.0, [0.0; 4], Some(held_out_um));
        let said_of_another_s = beside(0.1);
        assert!(
            said_of_another_s.contains("10.0 times as far off here")
                && said_of_another_s.contains("is it this actuator's table"),
            "{said_of_another_s}"
        );
        assert!(beside(0.9).contains("identify with another --model, or without --model"), "{}", beside(0.9));
        assert!(beside(0.5).starts_with("Train again, longer"), "{}", beside(0.5));
        assert!(said(1.0, 0.0, [0.0; 4]).starts_with("Train again, longer (--minutes), --up-to 20"));
        let (beyond, leapt) = (said(1.0, 0.0, [6.0, 4.0, 0.0, 0.0]), said(1.0, 0.0, [0.0, 0.0, 0.0, 10.0]));
        assert!(beyond.contains("beyond the table's range 6.0 % of the time, the estimate was clamped"), "{beyond}");
        assert_eq!(beyond.matches("prove within 0.000 … 40.000 V").count(), 1, "{beyond}");
        assert!(leapt.contains("leapt as the amplifier cannot 10.0 % of the time: a sound, shielded wire"), "{leapt}");
        assert!(
            !leapt.contains("prove within") && !leapt.contains("clamped") && !leapt.contains("piezo info"),
            "{leapt}"
        );
        assert!(said(1.0, 10.0, [0.0; 4]).contains("as the training never did: train as the proof goes"));
        assert!(said(8.0, 10.0, [0.0; 4]).contains("is it this actuator's table"));
    }

    #[test]
    fn a_table_of_another_range_is_kept_to_its_own_or_learnt_anew_by_what_can_be_typed() {
        let of = |learnt, driven| other_range(&OtherRange { learnt, driven });
        let (board, part) = (Range { min: 0.0, max: 100.0 }, Range { min: 0.0, max: 40.0 });
        let said = of(part, board);
        for words in [
            "prove with --range 0:40",
            "drive_range = [0, 40]",
            "\n    piezo learn --range 0:100 --out '<FOLDER>' --board '<FILE>'",
        ] {
            assert!(said.contains(words), "{words:?} is missing in {said}");
        }
        assert!(!said.contains("drive with --range"), "only prove and feedforward have one: {said}");
        let said = of(Range { min: 200.0, max: 300.0 }, board);
        assert!(said.contains("says nothing of the board's voltages") && said.contains("--out '<FOLDER>'"), "{said}");
    }
}
