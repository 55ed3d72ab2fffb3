//! Every line of a document that calls `piezo` is one that the program takes, and so is every example of its own help.

use super::Cli;
use clap::{CommandFactory, Parser as _};
use pulldown_cmark::{Event, Parser, Tag, TagEnd};
use std::fs;
use std::path::{Path, PathBuf};

/// How a document calls the program: installed, or by cargo.
const CALLS: [&str; 2] = ["piezo ", "cargo run --release -- "];

/// A text with what a backslash continues on one line.
fn continued(text: &str) -> String {
    text.replace("\\\n", "")
}

/// Lines of code blocks, and code within a line, of a text in Markdown.
fn code(text: &str) -> (Vec<String>, Vec<String>) {
    let (mut lines, mut words, mut in_block) = (Vec::new(), Vec::new(), false);
    let text = continued(text);
    for event in Parser::new(&text) {
        match event {
            Event::Start(Tag::CodeBlock(_)) => in_block = true,
            Event::End(TagEnd::CodeBlock) => in_block = false,
            Event::Text(code) if in_block => lines.extend(code.lines().map(|line| line.trim().to_owned())),
            Event::Code(code) => words.push(code.into_string()),
            _ => {}
        }
    }
    (lines, words)
}

/// The documents that call the program, all found by themselves.
fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let chapters = fs::read_dir(root.join("book/src")).unwrap().map(|entry| entry.unwrap().path());
    let chapters = chapters.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    let named = ["README.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    let texts: Vec<_> =
        named.into_iter().chain(chapters).map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect();
    assert!(texts.len() > 5, "the book is somewhere else");
    texts
}

/// What follows a call.
fn called(line: &str) -> Option<&str> {
    CALLS.iter().find_map(|call| line.strip_prefix(call))
}

/// The words of a line, with a number for each `<placeholder>`.
fn words(line: &str) -> Vec<String> {
    let mut filled = String::new();
    let mut numbers = (0..).map(|n: u32| n.to_string());
    for (index, part) in line.split(['<', '>']).enumerate() {
        filled += &if index.is_multiple_of(2) { part.to_owned() } else { numbers.next().unwrap() };
    }
    shlex::split(&filled).unwrap_or_else(|| panic!("a shell does not take `{line}`"))
}

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
