//! Every line of a document that calls `piezo` is one that the program takes, and so is every example of its own help.

#[path = "lines.rs"]
mod lines;

use super::Cli;
use clap::{CommandFactory, Parser as _};
use lines::{called, code, continued, documents, words};

/// Why the program does not take the line.
fn refused(line: &str) -> Option<String> {
    let line = called(line).unwrap();
    let refused = Cli::try_parse_from(["piezo".to_owned()].into_iter().chain(words(line))).err()?;
    refused.use_stderr().then(|| refused.to_string())
}

/// Why a call within a line, which may leave arguments out, is none: its verb or an option of it is not there.
fn unknown(call: &str) -> Option<String> {
    let cli = Cli::command();
    let mut words = call.split_whitespace();
    let verb = words.next()?;
    // "piezo …" stands for any of them; an option may follow the name itself.
    if !verb.starts_with(char::is_alphabetic) || verb == "help" || verb.chars().all(char::is_uppercase) {
        return None;
    }
    let Some(verb) = cli.find_subcommand(verb) else { return Some(format!("there is no verb {verb}")) };
    let known =
        |option: &str| option == "help" || verb.get_arguments().any(|argument| argument.get_long() == Some(option));
    let option = words.filter_map(|word| word.strip_prefix("--")).find(|option| !known(option))?;
    Some(format!("{} has no --{option}", verb.get_name()))
}

#[test]
fn the_program_takes_every_line_of_the_documents() {
    let mut lines = 0;
    for (path, text) in documents() {
        let (code, within) = code(&text);
        for line in code.iter().filter(|line| called(line).is_some()) {
            lines += 1;
            assert_eq!(refused(line), None, "{}: {line}", path.display());
        }
        for call in within.iter().filter_map(|call| call.strip_prefix("piezo ")) {
            assert_eq!(unknown(call), None, "{}: `piezo {call}`", path.display());
        }
    }
    assert!(lines > 20, "only {lines} lines were found");
}

#[test]
fn the_program_takes_every_example_of_its_own_help() {
    for verb in Cli::command().get_subcommands() {
        let help = verb.get_after_help().unwrap_or_else(|| panic!("{} has no example", verb.get_name())).to_string();
        let help = continued(&help);
        let examples: Vec<&str> =
            help.split(['\n', ';']).filter_map(|line| line.find("piezo ").map(|at| &line[at..])).collect();
        assert!(!examples.is_empty(), "{}: {help}", verb.get_name());
        for example in examples {
            assert_eq!(refused(example), None, "{}: {example}", verb.get_name());
        }
    }
}

#[test]
fn what_the_program_does_not_take_is_found() {
    for wrong in
        ["piezo frobnicate a.csv", "piezo identify a.csv", "piezo look a.csv --colour red", "piezo look --fs x a.csv"]
    {
        assert!(refused(wrong).is_some(), "{wrong}");
    }
    assert_eq!(refused("cargo run --release -- emit a.toml --adc-span <V0>:<VS> --out b   # measured"), None);
    assert!(unknown("frobnicate").is_some() && unknown("zero --over-cycles").is_some());
    assert_eq!((unknown("zero --over-cycle"), unknown("…"), unknown("VERB --help")), (None, None, None));
}
