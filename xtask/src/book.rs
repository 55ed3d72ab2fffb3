//! The documents, by what they point at: no chapter is left out of the book's summary, every link and anchor leads
//! somewhere, every path and test that is named exists, every message that is quoted is one of the sources, and `cargo
//! xtask` takes every line that calls it.
//!
//! The lines that call `piezo` are checked by its own tests (`tests/documents/commands.rs`), which have its arguments.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Component, Path, PathBuf},
};

use anyhow::{Result, ensure};
use clap::Command;
use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};
use xshell::{Shell, cmd};

/// The folder of the book's chapters, and the list of them.
const CHAPTERS: &str = "book/src";
const SUMMARY: &str = "book/src/SUMMARY.md";
/// What is read in a minute, and its most lines.
const FACE: (&str, usize) = ("README.md", 120);
/// The chapter that quotes messages, and what stands in a quotation for what differs.
const MESSAGES: &str = "book/src/errors.md";
const DIFFERS: char = '…';

/// What a document says that can be wrong, each with the number of its line.
#[derive(Default)]
struct Document {
    /// Anchors of the headings.
    anchors: BTreeSet<String>,
    /// Targets of links and pictures.
    links: Vec<(usize, String)>,
    /// Code within a line.
    words: Vec<(usize, String)>,
    /// Lines of code in blocks.
    code: Vec<(usize, String)>,
}

/// Checks every document of the repository; `xtask` is the command line of `cargo xtask`.
///
/// # Errors
/// What is wrong, each with its place.
pub fn check(sh: &Shell, xtask: &Command) -> Result<()> {
    let listed = cmd!(sh, "git ls-files").quiet().read()?;
    let files: BTreeSet<PathBuf> = listed.lines().map(PathBuf::from).collect();
    let mut documents = BTreeMap::new();
    for path in files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "md")) {
        documents.insert(path.clone(), Document::read(&sh.read_file(path)?));
    }
    let mut wrong = missing_chapters(&documents);
    for (path, document) in &documents {
        let mut add = |line: usize, what: String| wrong.push(format!("{}:{line}: {what}", path.display()));
        for (line, link) in &document.links {
            if let Some(what) = broken(path, link, &documents, &files) {
                add(*line, what);
            }
        }
        for (line, word) in &document.words {
            if let Some(what) = missing(sh, word, &files)? {
                add(*line, what);
            }
        }
        for (line, code) in &document.code {
            if let Some(what) = refused(code, xtask) {
                add(*line, what);
            }
        }
    }
    let sources = files.iter().filter(|path| path.extension().is_some_and(|extension| extension == "rs"));
    let sources: String = sources.map(|path| Ok(joined(&sh.read_file(path)?))).collect::<Result<_>>()?;
    let quoted = documents.get(Path::new(MESSAGES)).map(|document| &document.words[..]).unwrap_or_default();
    let unsaid = quoted.iter().filter(|(_, message)| !said(message, &sources));
    wrong.extend(unsaid.map(|(line, message)| format!("{MESSAGES}:{line}: nothing says `{message}`")));
    let lines = sh.read_file(FACE.0)?.lines().count();
    if lines > FACE.1 {
        wrong.push(format!("{} has {lines} lines, more than {}: the rest belongs in the book", FACE.0, FACE.1));
    }
    ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
    Ok(())
}

/// A source with its strings of several lines in one.
fn joined(source: &str) -> String {
    let mut parts = source.split("\\\n");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |joined, part| joined + part.trim_start())
}

/// Whether the sources have the parts of a message. Words of a command are none.
fn said(message: &str, sources: &str) -> bool {
    let command = ["piezo ", "--", "cargo "].iter().any(|start| message.starts_with(start));
    command || !message.contains(' ') || message.split(DIFFERS).all(|part| sources.contains(part.trim()))
}

impl Document {
    fn read(text: &str) -> Self {
        let mut document = Self::default();
        let (mut heading, mut in_code) = (None::<String>, false);
        for (event, place) in Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter() {
            let line = 1 + text[..place.start].matches('\n').count();
            match event {
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => document.anchors.extend(heading.take().map(|words| anchor(&words))),
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    document.links.push((line, dest_url.into_string()));
                }
                Event::Start(Tag::CodeBlock(_)) => in_code = true,
                Event::End(TagEnd::CodeBlock) => in_code = false,
                Event::Text(code) if in_code => {
                    document.code.extend((line..).zip(code.lines().map(str::to_owned)));
                }
                Event::Text(words) => heading.iter_mut().for_each(|heading| heading.push_str(&words)),
                Event::Code(word) => {
                    heading.iter_mut().for_each(|heading| heading.push_str(&word));
                    document.words.push((line, word.into_string()));
                }
                _ => {}
            }
        }
        document
    }
}

/// The anchor that mdBook and GitHub give a heading.
fn anchor(heading: &str) -> String {
    let letter = |c: char| match c {
        c if c.is_whitespace() => Some('-'),
        c if c.is_alphanumeric() || "-_".contains(c) => Some(c),
        _ => None,
    };
    heading.trim().chars().filter_map(letter).flat_map(char::to_lowercase).collect()
}

/// Chapters that the book's summary does not name.
fn missing_chapters(documents: &BTreeMap<PathBuf, Document>) -> Vec<String> {
    let named = documents.get(Path::new(SUMMARY)).map(|summary| &summary.links[..]).unwrap_or_default();
    let chapters = documents.keys().filter(|path| path.starts_with(CHAPTERS) && *path != Path::new(SUMMARY));
    let unnamed = chapters.filter(|path| !named.iter().any(|(_, link)| Path::new(CHAPTERS).join(link) == **path));
    unnamed.map(|path| format!("{}: is no chapter of {SUMMARY}", path.display())).collect()
}

/// What is wrong with a link of the document at `from`.
fn broken(
    from: &Path,
    link: &str,
    documents: &BTreeMap<PathBuf, Document>,
    files: &BTreeSet<PathBuf>,
) -> Option<String> {
    if link.contains("://") {
        return None;
    }
    let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
    let target = if path.is_empty() { from.to_owned() } else { plain(&from.with_file_name(path)) };
    if !files.contains(&target) {
        return Some(format!("`{link}` leads to {}, which is not in the repository", target.display()));
    }
    if from.starts_with(CHAPTERS) && !target.starts_with(CHAPTERS) {
        return Some(format!("`{link}` leads out of the book: name the path as code instead"));
    }
    let anchors = documents.get(&target).map(|document| &document.anchors);
    let lost = anchor.filter(|anchor| !anchors.is_some_and(|anchors| anchors.contains(*anchor)));
    lost.map(|anchor| format!("{} has no heading #{anchor}", target.display()))
}

/// A path without `..`.
fn plain(path: &Path) -> PathBuf {
    path.components().fold(PathBuf::new(), |mut plain, part| {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            part => plain.push(part),
        }
        plain
    })
}

/// What is missing of a path within the repository, `xtask/src/book.rs`, or a test in it, `xtask/src/book.rs::name`.
fn missing(sh: &Shell, word: &str, files: &BTreeSet<PathBuf>) -> Result<Option<String>> {
    let (path, test) = word.split_once("::").map_or((word, None), |(path, test)| (path, Some(test)));
    let Some((folder, _)) = path.split_once('/') else { return Ok(None) };
    let in_repository = files.iter().any(|file| file.components().count() > 1 && file.starts_with(folder));
    if folder.is_empty() || !in_repository || path.contains(['*', ' ', '<']) {
        return Ok(None);
    }
    if !files.iter().any(|file| file.starts_with(path.trim_end_matches('/'))) {
        return Ok(Some(format!("`{path}` is not in the repository")));
    }
    let lost = match test {
        Some(test) => {
            let keyword = if path.ends_with(".py") { "def" } else { "fn" };
            !sh.read_file(path)?.contains(&format!("{keyword} {test}("))
        }
        None => false,
    };
    Ok(lost.then(|| format!("`{word}`: {path} has no such function")))
}

/// Why `cargo xtask` does not take a line that calls it.
fn refused(code: &str, xtask: &Command) -> Option<String> {
    let arguments = code.trim().strip_prefix("cargo xtask")?;
    let words = shlex::split(arguments).unwrap_or_default();
    let words = [String::from("xtask")].into_iter().chain(words);
    let refused = xtask.clone().try_get_matches_from(words).err()?;
    // Asking for help is taken, too.
    refused.use_stderr().then(|| format!("`{}`: {}", code.trim(), refused.kind()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Arguments;
    use clap::CommandFactory as _;

    #[test]
    fn what_a_document_points_at_is_found_with_its_line() {
        let text = "# One, `two` — Three\n\nsee [a](b.md#c) and `x/y.rs`\n\n    cargo xtask figures\n    ls\n";
        let document = Document::read(text);
        assert!(document.anchors.contains("one-two--three"), "{:?}", document.anchors);
        assert_eq!(document.links, [(3, "b.md#c".to_owned())]);
        assert_eq!(document.words.last(), Some(&(3, "x/y.rs".to_owned())));
        assert_eq!(document.code, [(5, "cargo xtask figures".to_owned()), (6, "ls".to_owned())]);
    }

    #[test]
    fn a_link_that_leads_nowhere_or_out_of_the_book_is_found() {
        let chapter = PathBuf::from("book/src/a.md");
        let files = ["book/src/a.md", "README.md"].map(PathBuf::from).into();
        let documents = [(chapter.clone(), Document::read("# Here\n"))].into();
        let broken = |link: &str| broken(&chapter, link, &documents, &files);
        assert_eq!([broken("#here"), broken("a.md#here"), broken("https://a.b/c")], [None, None, None]);
        for (link, complaint) in [
            ("#there", "no heading #there"),
            ("b.md", "book/src/b.md, which is not in"),
            ("../../README.md", "out of the book"),
        ] {
            assert!(broken(link).is_some_and(|what| what.contains(complaint)), "{link}: {:?}", broken(link));
        }
        assert_eq!(missing_chapters(&documents), ["book/src/a.md: is no chapter of book/src/SUMMARY.md"]);
    }

    #[test]
    fn a_test_or_path_that_is_not_there_is_found() {
        let sh = Shell::new().unwrap();
        sh.change_dir(Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap());
        let files = ["xtask/src/book.rs"].map(PathBuf::from).into();
        let missing = |word: &str| missing(&sh, word, &files).unwrap().is_some();
        for there in ["xtask/src/book.rs::missing", "xtask/", "/figures", "tcp:HOST:PORT", "a/b", "xtask/*.rs"] {
            assert!(!missing(there), "{there}");
        }
        assert!(missing("xtask/src/book.rs::nothing_of_this_name") && missing("xtask/src/boot.rs"));
    }

    #[test]
    fn a_message_that_nobody_says_is_found() {
        let source = joined("\"the model has \\\n    learnt {x} of it\"");
        for there in ["the model has learnt", "model … of it", "piezo zero --at", "word"] {
            assert!(said(there, &source), "{there}");
        }
        assert!(!said("the model has forgotten", &source) && !said("the model … forgotten", &source));
    }

    #[test]
    fn a_chore_that_there_is_not_is_found() {
        let refused = |code| refused(code, &Arguments::command());
        for taken in ["cargo xtask figures models   # these", "cargo xtask test --list", "  cargo xtask --help", "ls"] {
            assert_eq!(refused(taken), None);
        }
        for wrong in ["cargo xtask paint", "cargo xtask test --frobnicate", "cargo xtask figures nothing"] {
            assert!(refused(wrong).is_some(), "{wrong}");
        }
    }
}
