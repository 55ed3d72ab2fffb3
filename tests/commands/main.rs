//! Whole commands, as a user types them, on the measured log and on the synthetic rig.

#[cfg(unix)]
mod asked;
mod assumed;
mod bench;
mod calibrate;
mod columns;
mod compare;
mod demo;
mod device;
mod divider;
mod documented;
mod doubted;
mod doubts;
mod estimate;
mod faces;
mod feedforward;
mod fleet;
mod follow;
mod found;
mod full;
#[cfg(unix)]
mod full_driving;
mod info;
mod instruments;
mod killed;
mod killed_driving;
mod killed_learn;
mod linearise;
mod locale;
mod logs;
mod manual;
mod mistakes;
mod monitor;
mod options;
mod order;
mod pil;
mod record;
mod recorded;
mod reproduce;
mod rig;
mod sets;
mod severed;
mod validate;
mod waveform;
mod zero;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The `piezo` binary, run from the repository's root.
fn piezo() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
    command.current_dir(root()).env_remove("PIEZO_PORT");
    command
}

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// A file of `tests/data`.
fn data(name: &str) -> PathBuf {
    root().join("tests/data").join(name)
}

/// Runs a command that must succeed and parses what it prints.
fn json(command: &mut Command) -> Value {
    let output = command.assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).expect("--json prints JSON")
}

/// Runs a dry run of what would be refused, and parses what it prints.
fn refused_json(command: &mut Command) -> Value {
    let output = command.assert().code(1).get_output().stdout.clone();
    serde_json::from_slice(&output).expect("--json prints JSON")
}

/// A number inside a JSON value.
fn number(value: &Value, pointer: &str) -> f64 {
    value.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("no number at {pointer} in {value}"))
}

/// Runs a command that must fail with code 2 and say each of these; returns what it says.
fn refused(arguments: &[&str], says: &[&str]) -> String {
    let output = piezo().args(arguments).assert().code(2).get_output().clone();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    for part in says {
        assert!(message.contains(part), "{arguments:?} should say {part:?}, but says: {message}");
    }
    assert!(!message.contains("panicked"), "{message}");
    message
}

fn text(path: &Path) -> &str {
    path.to_str().expect("temporary folders have UTF-8 names here")
}

const MEASURED: &str = "tests/data/picma-p885-1hz.csv";
