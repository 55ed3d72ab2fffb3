//! The language of the machine changes no number, neither read nor printed.

use super::{MEASURED, piezo, text};

#[test]
fn a_machine_in_german_reads_and_prints_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let said = |language: &str, verb: &[&str]| {
        let mut command = piezo();
        command.args(verb);
        for variable in ["LC_ALL", "LC_NUMERIC", "LANG", "LANGUAGE"] {
            command.env(variable, language);
        }
        let output = command.output().unwrap();
        assert!(output.status.success(), "{output:?}");
        (output.stdout, output.stderr)
    };
    let emitted = |language: &str| {
        let out = folder.path().join(language);
        said(language, &["emit", "tests/data/table/table.toml", "--adc-span", "-22.5:22.5", "--out", text(&out)]);
        std::fs::read_to_string(out.join("table.toml")).unwrap()
    };
    assert_eq!(emitted("de_DE.UTF-8"), emitted("C"));
    for verb in [
        &["look", MEASURED][..],
        &["look", MEASURED, "--json"],
        &["validate", "tests/data/table/table.toml", MEASURED, "--from", "20.5"],
        &["divider", "--monitor", "0:10", "--amplifier", "0:100.5"],
    ] {
        assert_eq!(said("de_DE.UTF-8", verb), said("C", verb), "{verb:?}");
    }
}

/// Numbers of a C library are those of no language until a program asks for one by these functions, whatever languages
/// are installed here; one that goes by the variables itself has their names.
#[test]
fn the_program_asks_for_no_language() {
    let program = std::fs::read(env!("CARGO_BIN_EXE_piezo")).unwrap();
    let program = String::from_utf8_lossy(&program);
    // A variable that it reads, and the function that it reads it with.
    assert!(program.contains("PIEZO_PORT") && (cfg!(not(unix)) || program.contains("getenv")));
    for asks in ["setlocale", "newlocale", "uselocale", "localeconv", "nl_langinfo", "LC_ALL", "LC_NUMERIC"] {
        assert!(!program.contains(asks), "{asks}");
    }
}
