//! Rules of this repository that no compiler checks.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use xshell::{Shell, cmd};

use crate::{changelog, circles, comments};

/// The folder of the host's crates.
const HOST: &str = "host-tools";
/// The command line, and the crates of the sentences that name its options; the others are libraries, which
/// know of none.
const COMMAND_LINE: [&str; 3] = ["piezo", "remedy", "findings"];
/// Libraries beyond the host's, which know of none either.
const OTHERS: [&str; 6] = ["estimator-core", "estimator-c", "firmware", "parameter-store", "protocol", "python"];
/// The files of the program's verbs.
const VERBS: &str = "host-tools/piezo/src/verb";
/// What stands in files and on the page for whoever finds them, and names the verb that makes them.
const KNOWN_BY: [&str; 3] =
    ["// Made by `piezo emit`", "make its other faces again: piezo emit", "<title>piezo monitor</title>"];
/// How a file's own tests begin.
const TESTS: &str = "#[cfg(test)]\nmod tests {";
/// What starts another program, with that program's flags.
const STARTS_ANOTHER: &str = "host-tools/device-link/src/probe.rs";
/// What each release says of itself.
const CHANGELOG: &str = "CHANGELOG.md";
/// What a crate's manifest says where its documentation has no example, so that no time goes into looking for one.
const NO_EXAMPLES: &str = "doctest = false";
/// Most lines of a crate's sources.
const MOST_LINES: usize = 5500;
/// The identification is a library for others, too: it must not bring them a command line, a serial port or a terminal.
const IDENTIFICATION: &str = "identification";
const NOT_OF_IDENTIFICATION: [&str; 6] = ["clap", "anyhow", "serialport", "askama", "crossterm", "indicatif"];

/// Checks them.
///
/// # Errors
/// Those that are broken, each with its place and its remedy.
pub fn check(sh: &Shell) -> Result<()> {
    let mut broken = Vec::new();
    let files = sh.read_dir(VERBS)?;
    let verbs: Vec<_> = files.iter().filter_map(|file| file.file_stem()?.to_str()).collect();
    let others = OTHERS.map(|library| sources(sh, &sh.current_dir().join(library).join("src")));
    for path in others.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten() {
        let place = path.strip_prefix(sh.current_dir()).unwrap_or(&path);
        broken.extend(of_the_command_line(place, &sh.read_file(&path)?, &verbs));
    }
    for folder in sh.read_dir(HOST)?.iter().filter(|folder| folder.join("Cargo.toml").is_file()) {
        let name = folder.file_name().and_then(|name| name.to_str()).context("a crate's folder is not UTF-8")?;
        let mut lines = 0;
        for path in sources(sh, &folder.join("src"))? {
            let text = sh.read_file(&path)?;
            lines += text.lines().count();
            let place = path.strip_prefix(sh.current_dir()).unwrap_or(&path);
            if COMMAND_LINE.contains(&name) || place == Path::new(STARTS_ANOTHER) {
                continue;
            }
            broken.extend(of_the_command_line(place, &text, &verbs));
        }
        if lines > MOST_LINES {
            broken.push(format!("{HOST}/{name} has {lines} lines, more than {MOST_LINES}: split it"));
        }
    }
    broken.extend(untested_examples(sh)?);
    broken.extend(changelog::without_format(&sh.read_file(CHANGELOG)?));
    broken.extend(circles::of_repository(sh)?);
    broken.extend(comments::of_repository(sh)?);
    let tree = cmd!(sh, "cargo tree --package {IDENTIFICATION} --edges normal --prefix none").read()?;
    for foreign in NOT_OF_IDENTIFICATION {
        if tree.lines().any(|line| line.split(' ').next() == Some(foreign)) {
            broken.push(format!(
                "{IDENTIFICATION} depends on {foreign}: `cargo tree --package {IDENTIFICATION} --edges normal --invert \
                 {foreign}` says through what"
            ));
        }
    }
    ensure!(broken.is_empty(), "{}", broken.join("\n"));
    Ok(())
}

/// What a library says of the command line.
fn of_the_command_line(place: &Path, text: &str, verbs: &[&str]) -> Vec<String> {
    let place = place.display();
    let may = COMMAND_LINE.join(" and ");
    let flags = flags(text)
        .map(|(line, code)| format!("{place}:{line}: `{code}` names a flag, which only {may} may: say it there"));
    let verbs = named_verbs(text, verbs)
        .map(|(line, code)| format!("{place}:{line}: `{code}` names a verb, which only {may} may: say it there"));
    flags.chain(verbs).collect()
}

/// Examples in the documentation of crates whose manifest has cargo test none.
fn untested_examples(sh: &Shell) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for manifest in cmd!(sh, "git ls-files -- *Cargo.toml").read()?.lines().map(Path::new) {
        let source = sh.current_dir().join(manifest.with_file_name("src"));
        if !source.is_dir() || !sh.read_file(manifest)?.lines().any(|line| line == NO_EXAMPLES) {
            continue;
        }
        for path in sources(sh, &source)? {
            let place = path.strip_prefix(sh.current_dir()).unwrap_or(&path).display();
            broken.extend(examples(&sh.read_file(&path)?).into_iter().map(|line| {
                format!(
                    "{place}:{line}: no check runs this example: take `{NO_EXAMPLES}` out of {}, or mark what is no Rust with ```text",
                    manifest.display()
                )
            }));
        }
    }
    Ok(broken)
}

/// Lines on which an example begins in comments of documentation: in Rust, or in nothing that is named.
fn examples(text: &str) -> Vec<usize> {
    let mut within = false;
    let mut begins = |line: &str| {
        let fence =
            line.trim().strip_prefix("//!").or_else(|| line.trim().strip_prefix("///"))?.trim().strip_prefix("```")?;
        within = !within;
        Some(within && !["text", "toml"].contains(&fence))
    };
    (1..).zip(text.lines()).filter_map(|(number, line)| (begins(line) == Some(true)).then_some(number)).collect()
}

/// The Rust files of a folder and of those in it.
fn sources(sh: &Shell, folder: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in sh.read_dir(folder)? {
        if path.is_dir() {
            files.extend(sources(sh, &path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(files)
}

/// Lines with `--word`, which Rust has in strings and comments only, and their numbers; comments do not count.
fn flags(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let names_flag = |code: &str| {
        let after = code.match_indices("--").filter_map(|(at, dashes)| code[at + dashes.len()..].chars().next());
        after.into_iter().any(|first| first.is_ascii_lowercase())
    };
    (1..).zip(text.lines().map(str::trim)).filter(move |(_, code)| !code.starts_with("//") && names_flag(code))
}

/// Lines of code with the program's name and one of its verbs, but for those within tests, which quote what others say.
fn named_verbs<'a>(text: &'a str, verbs: &[&str]) -> impl Iterator<Item = (usize, &'a str)> {
    let names_verb = |code: &str| {
        let mut words =
            code.split("piezo ").skip(1).filter_map(|after| after.split(|c: char| !c.is_ascii_alphabetic()).next());
        words.any(|word| verbs.contains(&word)) && !KNOWN_BY.iter().any(|known| code.contains(known))
    };
    let code = text.split(TESTS).next().unwrap_or_default();
    (1..).zip(code.lines().map(str::trim)).filter(move |(_, code)| !code.starts_with("//") && names_verb(code))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_found_in_strings_and_not_in_comments() {
        let text = "/// With --out.\nlet a = \"say --out\";\nlet b = \"1 -- 2\";\n// --out\n  use --delay \\\n----";
        assert_eq!(flags(text).map(|(line, _)| line).collect::<Vec<_>>(), [2, 5]);
    }

    #[test]
    fn verbs_are_found_with_the_programs_name_and_not_in_tests_or_what_a_file_is_known_by() {
        let text = format!(
            "/// By `piezo emit`.\nlet a = \"try `piezo emit`\";\nlet b = \"a piezo actuator\";\nlet c = \"{}\";\n{TESTS}\nlet d = \"piezo emit\";",
            KNOWN_BY[0]
        );
        assert_eq!(named_verbs(&text, &["emit", "push"]).map(|(line, _)| line).collect::<Vec<_>>(), [2]);
    }

    #[test]
    fn an_example_in_rust_is_found_and_a_drawing_is_not() {
        let text =
            "//! ```text\n//! a → b\n//! ```\n//! ```\n//! a();\n//! ```\n/// ```rust\n/// ```\nlet a = \"```\";";
        assert_eq!(examples(text), [4, 7]);
    }
}
