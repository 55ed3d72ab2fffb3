//! The lines of the documents that call the program.

use pulldown_cmark::{Event, Parser, Tag, TagEnd};
use std::fs;
use std::path::{Path, PathBuf};

/// How a document calls the program: installed, or by cargo.
const CALLS: [&str; 2] = ["piezo ", "cargo run --release -- "];

/// A text with what a backslash continues on one line.
pub fn continued(text: &str) -> String {
    text.replace("\\\n", "")
}

/// Lines of code blocks, and code within a line, of a text in Markdown.
pub fn code(text: &str) -> (Vec<String>, Vec<String>) {
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

/// The documents that call the program: those at the root, then every chapter in the order of the book.
pub fn documents() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let book = root.join("book/src");
    let summary = fs::read_to_string(book.join("SUMMARY.md")).unwrap();
    let chapters = summary
        .lines()
        .filter_map(|line| line.strip_suffix(".md)")?.split_once("]("))
        .map(|(_, name)| book.join(name).with_extension("md"));
    let named = ["README.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    let texts: Vec<_> =
        named.into_iter().chain(chapters).map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect();
    assert!(texts.len() > 5, "the book is somewhere else");
    texts
}

/// What follows a call.
pub fn called(line: &str) -> Option<&str> {
    CALLS.iter().find_map(|call| line.strip_prefix(call))
}

/// The words of a line, with a number for each `<placeholder>`.
pub fn words(line: &str) -> Vec<String> {
    let mut filled = String::new();
    let mut numbers = (0..).map(|n: u32| n.to_string());
    for (index, part) in line.split(['<', '>']).enumerate() {
        filled += &if index.is_multiple_of(2) { part.to_owned() } else { numbers.next().unwrap() };
    }
    shlex::split(&filled).unwrap_or_else(|| panic!("a shell does not take `{line}`"))
}
