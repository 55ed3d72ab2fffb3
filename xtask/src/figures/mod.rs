//! `cargo xtask figures`: the figures that documents state are those that commands print.

mod ceiling;
mod cells;
mod command;
mod document;
mod firmware;
mod list;
mod resistors;

use std::{
    fs,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, builder::PossibleValuesParser};
use xshell::{Shell, cmd};

use crate::{
    artifact,
    tool::{self, CMAKE, EMBEDDED, LIBCLANG, MAKE, PKG_CONFIG, QEMU, Tool},
};
use command::{Printed, bytes};
use document::{Content, Document, alike};
use list::{FIGURES, Figure};

/// What the commands need beyond cargo.
pub const TOOLS: &[&Tool] = &[&EMBEDDED, &QEMU, &CMAKE, &MAKE, &PKG_CONFIG, &LIBCLANG];

/// What is to be done about which figures.
#[derive(Args)]
pub struct Arguments {
    /// Figures to see to instead of all
    #[arg(value_name = "FIGURE", value_parser = names())]
    names: Vec<String>,
    /// Write nothing; fail if a document states another figure than its command prints
    #[arg(long)]
    check: bool,
    /// Print the figures, one a line, and run nothing
    #[arg(long)]
    list: bool,
}

fn names() -> PossibleValuesParser {
    FIGURES.iter().map(|figure| figure.name).collect::<Vec<_>>().into()
}

/// Runs the commands, and writes the figures or compares them.
///
/// # Errors
/// A command fails, a marker is wrong, or, with `--check`, a figure is.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    if arguments.list {
        FIGURES.iter().for_each(|figure| println!("{}", figure.name));
        return Ok(());
    }
    tool::require(sh, TOOLS)?;
    let named = |figure: &&Figure| arguments.names.is_empty() || arguments.names.iter().any(|name| name == figure.name);
    let figures: Vec<&Figure> = FIGURES.iter().filter(named).collect();
    let wrong = see_to(sh, artifact::piezo(sh)?, &figures, arguments.check)?;
    ensure!(wrong.is_empty(), "{}\n{REMEDY}", wrong.join("\n"));
    Ok(())
}

/// Compares all figures with what the documents state.
///
/// # Errors
/// See [`run`].
pub fn check(sh: &Shell, piezo: PathBuf) -> Result<()> {
    let wrong = see_to(sh, piezo, &FIGURES.iter().collect::<Vec<_>>(), true)?;
    ensure!(wrong.is_empty(), "{}\n{REMEDY}", wrong.join("\n"));
    Ok(())
}

const REMEDY: &str =
    "`cargo xtask figures` writes what the commands print; look at what it changes before you commit it";

/// Makes the figures and either writes them or returns what is wrong with those that are stated.
fn see_to(sh: &Shell, piezo: PathBuf, figures: &[&Figure], check: bool) -> Result<Vec<String>> {
    let mut documents = documents(sh)?;
    // Before the commands run, which takes minutes.
    for figure in figures.iter().filter(|figure| figure.file.is_none()) {
        let stated = |document: &Document| Ok(document.places()?.iter().any(|place| place.name == figure.name));
        let stated = documents.iter().map(stated).collect::<Result<Vec<bool>>>()?;
        ensure!(
            stated.contains(&true),
            "no document states the figure `{0}`: put `<!-- figures: {0} -->` and `<!-- /figures -->` round it, or take it out \
             of FIGURES, xtask/src/figures/list.rs",
            figure.name
        );
    }
    let printed = Printed::new(sh, piezo)?;
    if figures.len() == FIGURES.len() {
        printed.all()?;
    }
    let mut wrong = Vec::new();
    for figure in figures {
        let content = (figure.make)(&printed).with_context(|| format!("figure `{}`", figure.name))?;
        if let (Some(path), Content::File(bytes)) = (figure.file, &content) {
            file(sh, Path::new(path), bytes, check, &mut wrong)?;
        }
        for document in &mut documents {
            in_document(document, figure, &content, &mut wrong)?;
        }
    }
    if !check {
        wrong.clear();
        for Document { path, text } in documents {
            if fs::read_to_string(&path)? != text {
                println!("{} has changed", path.display());
                fs::write(&path, text)?;
            }
        }
    }
    Ok(wrong)
}

/// The documents of the repository, all of whose figures are known.
fn documents(sh: &Shell) -> Result<Vec<Document>> {
    let mut documents = Vec::new();
    for path in cmd!(sh, "git ls-files -- *.md").read()?.lines() {
        let path = sh.current_dir().join(path);
        let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
        let document = Document { path, text };
        for place in document.places()? {
            if !FIGURES.iter().any(|figure| figure.name == place.name) {
                let (path, line) = (document.path.display(), place.line);
                bail!("{path}:{line}: there is no figure `{}`; `cargo xtask figures --list` names all", place.name);
            }
        }
        documents.push(document);
    }
    Ok(documents)
}

/// Replaces a figure in a document, and tells what it was.
fn in_document(document: &mut Document, figure: &Figure, content: &Content, wrong: &mut Vec<String>) -> Result<()> {
    // The last first, so that the places before keep theirs.
    for place in document.places()?.into_iter().rev().filter(|place| place.name == figure.name) {
        let at = format!("{}:{}: figure `{}`", document.path.display(), place.line, place.name);
        let found = &document.text[place.body.clone()];
        let expected = content.written(found).with_context(|| at.clone())?;
        if figure.slack > 0.0 && alike(found, &expected, figure.slack) {
            continue;
        }
        let [there, here] = [found, expected.as_str()].map(|text| text.lines().collect::<Vec<_>>());
        let missing = here.iter().filter(|line| !there.contains(line));
        let surplus = there.iter().filter(|line| !here.contains(line));
        if found != expected {
            let lines = surplus
                .map(|line| format!("\n  states   {line}"))
                .chain(missing.map(|line| format!("\n  should be {line}")));
            wrong.push(format!("{at}{}", lines.collect::<String>()));
        }
        document.text.replace_range(place.body, &expected);
    }
    Ok(())
}

/// Writes a figure that is a file, or compares it.
fn file(sh: &Shell, path: &Path, expected: &[u8], check: bool, wrong: &mut Vec<String>) -> Result<()> {
    let full = sh.current_dir().join(path);
    if bytes(&full).is_ok_and(|found| found == expected) {
        return Ok(());
    }
    if check {
        wrong.push(format!("{}: is not the picture that its command draws", path.display()));
    } else {
        println!("{} has changed", path.display());
        fs::write(&full, expected).with_context(|| full.display().to_string())?;
    }
    Ok(())
}
