//! Why nothing was identified, compared, reproduced or read as a table.

use super::log::prepare;
use super::paste::{log, quoted, value, verb, with};
use ::calibration::ConverterMismatch;
use ::calibration::drive::SetpointMismatch;
use comparison::ComparisonError;
use estimator_core::TableError;
use fleet::{Unit, UnitError};
use identification::cost::UnusedWeight;
use identification::validate::{Bound, ScopeError, UnmeasuredError};
use identification::{CandidateError, JobError};
use recordings::{LogUse, Role};
use result_files::FileError;
use std::error::Error;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use table_files::{OtherFace, Refused, TableFileError};
use thesis::ThesisError;

/// What Ctrl-C does while learn identifies.
pub const ENDS: &str = "Ctrl-C: it ends when this part has, and a second Ctrl-C ends it at once. What was recorded is kept: the same line learns \
                        from it";

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(of) = error.downcast_ref::<UnmeasuredError>() {
        return match of {
            UnmeasuredError::Prepare(inner) => super::log::told(inner),
            UnmeasuredError::Zero(inner) => Some(scope(inner)),
            UnmeasuredError::Start { .. } => Some(format!(
                "{of}: state it by that zero, or with --zero-at <S>:<UM> where it is known at a later time"
            )),
            UnmeasuredError::Beyond { .. } => {
                Some(format!("{of}: tell it at another time, or train on logs that reach as far"))
            }
        };
    }
    error
        .downcast_ref()
        .map(job)
        .or_else(|| error.downcast_ref().map(candidate))
        .or_else(|| error.downcast_ref().map(compare))
        .or_else(|| error.downcast_ref().map(thesis))
        // That of an item, which is boxed since it is one of the same kind.
        .or_else(|| error.downcast_ref::<Box<ThesisError>>().map(|of_an_item| thesis(of_an_item)))
        .or_else(|| error.downcast_ref().map(unused_weight))
        .or_else(|| error.downcast_ref().map(scope))
        .or_else(|| error.downcast_ref().map(table))
        .or_else(|| error.downcast_ref().map(refused_file))
        .or_else(|| error.downcast_ref().map(refused))
        .or_else(|| error.downcast_ref().map(other_face))
        .or_else(|| error.downcast_ref().map(file))
        .or_else(|| error.downcast_ref().map(setpoint))
        .or_else(|| error.downcast_ref().map(unit))
}

/// Refuses a folder that has a unit's file, or one that may be: what it says would be of tables that are gone.
///
/// # Errors
/// There is such a file; the sentence says what helps.
pub fn of_no_unit(path: &Path) -> Result<(), String> {
    let remedy = "name another folder with --out";
    match Unit::read(path) {
        Err(UnitError::Missing { .. }) => Ok(()),
        Ok(Unit { unit, .. }) => Err(format!("{}: says what came of {unit}: add --unit, or {remedy}", path.display())),
        Err(error) => Err(format!("{error}: {remedy}")),
    }
}

fn unit(error: &UnitError) -> String {
    let remedy = match error {
        UnitError::Missing { .. } => "identify it with `piezo identify LOG --unit NAME --out FOLDER`",
        UnitError::NoUnit { .. } | UnitError::Version { .. } => {
            "have it made again with `piezo identify LOG --unit NAME --out FOLDER --force`, or leave the folder out"
        }
        UnitError::Unreadable { .. } => "look at its permissions, and at what it is",
        UnitError::Program { .. } => "leave --unit out, or have the program where it can be read",
        UnitError::Name { .. } => "give --unit another",
    };
    format!("{error}: {remedy}")
}

/// What does not fit between a table and its converters.
pub fn mismatch(mismatch: &ConverterMismatch) -> String {
    let remedy = match mismatch {
        ConverterMismatch::Adc { .. } => "a wider --adc-span, by another divider",
        ConverterMismatch::SafeOutput => "another --dac-span",
        ConverterMismatch::Dac { .. } => "a wider --dac-span",
    };
    format!("{mismatch}: {remedy}")
}

fn setpoint(error: &SetpointMismatch) -> String {
    let remedy = match error {
        SetpointMismatch::NoDrive => "--drive-span and --drive-slew say how it drives",
        SetpointMismatch::NoSpan => "--setpoint-span says it, µm at code 0 and at full scale",
    };
    format!("{error}: {remedy}")
}

fn job(error: &JobError) -> String {
    match error {
        JobError::Prepare(error) => prepare(error),
        JobError::Rests { .. } => format!(
            "{error}: choose another part with --hold-out, --skip-start and --skip-end, or hold out another log with \
             --validate-on"
        ),
        JobError::LagTooLong { .. } => {
            format!("{error}: --lag takes ms; what of it is the sensor's is stated by --delay")
        }
        JobError::FallsWithVoltage { .. } => {
            const SCALE: &str = "--displacement-scale";
            // What was typed has been applied.
            let turned = |scale| -value(scale).and_then(|typed| typed.parse::<f64>().ok()).unwrap_or(1.0);
            let (volts, turned) = (turned("--voltage-scale"), turned(SCALE).to_string());
            let turn = match verb("identify") || verb("compare") {
                true => with(Path::new(""), &[(SCALE, &turned)]),
                false => format!(" give identify {SCALE} {turned}"),
            };
            format!(
                "{error}: are the columns the right ones? If the voltage is inverted give --voltage-scale {volts}; if the sensor is mounted the other \
                 way{turn}"
            )
        }
        JobError::SameLog { rewritten: true, .. } => {
            format!("{error}: name the recording once; hold out another, or a part of this one with --hold-out")
        }
        JobError::NoReversal { .. } => format!(
            "{error}: record several cycles, up and down over the range; if the log has them, what is fitted to is cut off too early \
             (--hold-out, --skip-start, --skip-end), or --deadband, which takes V, is not needed: it is chosen from the noise"
        ),
        JobError::Noise { .. } => format!(
            "{error}: did the actuator rest, or was the sensor off? Record it moving; else are the columns the right ones (--columns)?"
        ),
        JobError::Whole { source } => {
            format!(
                "{error} ({}): --as-judged delivers it as it was judged, learnt without what was held out",
                job(source)
            )
        }
        _ => error.to_string(),
    }
}

fn candidate(error: &CandidateError) -> String {
    match error {
        CandidateError::NothingFound => format!(
            "{error}: try logs of more amplitudes, a longer search (--evaluations, --budget) or another --limit"
        ),
        CandidateError::Unbounded(_) => {
            format!("{error}: search longer (--generations, --rounds, --evaluations, --budget) or raise --limit")
        }
        CandidateError::Refused(_) => error.to_string(),
    }
}

fn compare(error: &ComparisonError) -> String {
    match error {
        ComparisonError::Job(error) => job(error),
        ComparisonError::NothingHeldOut => format!("{error}: use --hold-out or --validate-on"),
    }
}

fn thesis(error: &ThesisError) -> String {
    match error {
        ThesisError::Job(error) => job(error),
        ThesisError::Candidate(error) => candidate(error),
        ThesisError::NothingHeldOut => {
            format!("{error}: name logs with --validate-on, or a fraction with --hold-out")
        }
        ThesisError::OwnRecordings => format!("{error}: leave out --logs"),
        ThesisError::OtherZeros => format!("{error}: leave out --voltage-zero and --displacement-zero"),
        _ => error.to_string(),
    }
}

fn unused_weight(_: &UnusedWeight) -> String {
    "--feedback-weight is of --cost multi-step alone: leave it out, or add that".to_owned()
}

fn scope(error: &ScopeError) -> String {
    let option = |bound: &Bound| match bound {
        Bound::From => "--from",
        Bound::To => "--to",
        Bound::ZeroAt => "--zero-at",
    };
    match error {
        ScopeError::Outside { bound: Bound::ZeroAt, at_s, begins_s, .. } if at_s == begins_s && verb("estimate") => {
            format!("{error}: choose a --zero-at within it; --start-at says where the actuator is at the first sample")
        }
        ScopeError::Outside { bound, .. } => format!("{error}: choose a {} within it", option(bound)),
        ScopeError::Order { bound, .. } => format!("{error}: choose a --to later than {}", option(bound)),
        ScopeError::TooFew { .. } => format!("{error}: choose --from and --to further apart, or an earlier --zero-at"),
        ScopeError::NoCycle => format!("{error}: choose another --told, or a longer part with --from and --to"),
    }
}

/// Why a table is refused.
pub(super) fn refused(error: &TableError) -> String {
    match error {
        TableError::Version { .. } => format!("{error}: make the table again with `piezo emit`"),
        _ => error.to_string(),
    }
}

/// The same of a table in a file.
fn refused_file(error: &Refused) -> String {
    match error {
        Refused::Table(error) => refused(error),
        _ => error.to_string(),
    }
}

fn other_face(error: &OtherFace) -> String {
    let faces = [&error.named, &error.beside];
    match faces.into_iter().find(|face| face.ends_with("table.toml")) {
        // It makes no other faces.
        Some(toml) if *toml == error.beside && error.its.is_none() => {
            format!("{error}: move {} away, or make it anew from its logs", quoted(&error.beside.display().to_string()))
        }
        Some(toml) => {
            let other = if *toml == error.named { &error.beside } else { &error.named };
            let folder = toml.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let [of_toml, of_folder] = [toml, folder].map(|path| quoted(&path.display().to_string()));
            format!(
                "{error}: which is meant? If {of_toml}, make its other faces again:\n    piezo emit {of_toml} --out {of_folder}\nif \
                 {}, move {of_toml} away",
                other.display()
            )
        }
        None => format!("{error}: move away the one that is not meant"),
    }
}

fn file(error: &FileError) -> String {
    match error {
        FileError::Busy { .. } => format!("{error}: wait until it has ended, or name another folder with --out"),
        FileError::Growing { .. } => format!("{error}: wait until it has ended, or name another file with --out"),
        FileError::Left { path } => {
            let free = numbered(&path.with_extension(""));
            let [left, free] = [path, &free].map(|path| quoted(&path.display().to_string()));
            format!("{error}: give it a name of its own:\n    mv {left} {free}")
        }
        FileError::Write { .. } | FileError::Folder { .. } => error.to_string(),
    }
}

/// The first name of a log with a number behind it at which nothing is.
fn numbered(log: &Path) -> PathBuf {
    let stem = log.file_stem().unwrap_or_default().display();
    let end = log.extension().map_or(String::new(), |end| format!(".{}", end.display()));
    let name = |number: u32| log.with_file_name(format!("{stem}-{number}{end}"));
    (1..u32::MAX).map(name).find(|path| path.symlink_metadata().is_err()).unwrap_or_else(|| name(u32::MAX))
}

/// The command that makes a table of an earlier version anew from the logs that it names: files of one name in several
/// folders cannot be told from each other, and are left to be filled in.
fn anew(logs: &[LogUse]) -> String {
    let of = |role| {
        let mut of: Vec<&LogUse> = logs.iter().filter(|log| log.role == role).collect();
        of.dedup_by(|a, b| a.sha256 == b.sha256);
        of
    };
    let named = |of: &LogUse| {
        let ambiguous = logs.iter().any(|other| other.file == of.file && other.sha256 != of.sha256);
        if ambiguous { PLACEHOLDER.to_owned() } else { log(&of.file) }
    };
    let (training, held_out) = (of(Role::Training), of(Role::HeldOut));
    let others = held_out.iter().filter(|log| training.iter().all(|of| of.sha256 != log.sha256));
    let held_out: String = others.map(|of| format!(" --validate-on {}", named(of))).collect();
    let training = if training.is_empty() {
        PLACEHOLDER.to_owned()
    } else {
        training.into_iter().map(named).collect::<Vec<_>>().join(" ")
    };
    format!("\n    piezo identify {training}{held_out} --out '<FOLDER>'")
}

const PLACEHOLDER: &str = "'<LOG>'";

fn table(error: &TableFileError) -> String {
    const WANTED: &str = "name the table.toml that `identify` or `emit` wrote";
    const LEARNT: &str = "model/table.toml";
    match error {
        TableFileError::Unreadable { path, error } => {
            let (directory, path) = (path, path.display());
            match error.kind() {
                ErrorKind::NotFound => format!("{path}: no such file: {WANTED}"),
                ErrorKind::IsADirectory => match directory.join(LEARNT).is_file() {
                    true => format!("{path}: is a directory: name {path}/{LEARNT}, which `learn` wrote"),
                    false => format!("{path}: is a directory: {WANTED} into it"),
                },
                ErrorKind::InvalidData => format!("{path}: is not text: {WANTED}"),
                ErrorKind::InvalidInput | ErrorKind::FileTooLarge => {
                    format!("{path}: cannot be read ({error}): {WANTED}")
                }
                ErrorKind::PermissionDenied => format!("{path}: cannot be read ({error}): check its permissions"),
                _ => format!("{path}: cannot be read ({error})"),
            }
        }
        TableFileError::OtherFace(error) => other_face(error),
        TableFileError::Doubts { .. } => {
            format!("{error}: mend that file, or move it away where it is not of this table")
        }
        TableFileError::Earlier { logs, .. } => {
            format!("{error}: make it anew, where its logs are and with the options of then{}", anew(logs))
        }
        // A log in the place of the table, or another face of it.
        TableFileError::NoTable { path, .. } if path.extension().is_none_or(|extension| extension != "toml") => {
            let logs = if ["validate", "estimate", "pil"].into_iter().any(verb) { ", and logs after it" } else { "" };
            format!("{}: is no table.toml: {WANTED}{logs}", path.display())
        }
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sentence;
    use super::*;
    use device_link::table::RunningTableError;

    #[test]
    fn a_table_of_another_version_is_to_be_made_again_wherever_it_lies() {
        let version = TableError::Version { found: 3, read: 9 };
        let (path, source) = ("table.bin".into(), Refused::Table(version));
        let wherever: [&dyn Error; 3] =
            [&version, &TableFileError::Refused { path, line: None, source }, &RunningTableError::Refused(version)];
        for error in wherever {
            let said = sentence(error);
            assert!(said.ends_with("reads version 9: make the table again with `piezo emit`"), "{said}");
        }
        assert!(!version.to_string().contains("piezo"), "{version}");
    }
}
