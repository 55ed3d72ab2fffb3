//! What stands before a table, as pairs of a key and a value.

use std::borrow::Cow;

use crate::dialect::{Delimiter, Dialect};

/// A key of a preamble, in small letters, with what follows it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Entry {
    /// Words of the key, separated by single spaces.
    pub key: String,
    /// The key as written.
    pub written: String,
    /// What stands in brackets behind the key, if anything.
    pub unit: Option<String>,
    /// The cells after the key.
    pub values: Vec<String>,
    /// Index of the line.
    pub line: usize,
}

/// The entries of the preamble's lines: `key = value`, `key: value`, cells after a first, and a number below its name.
pub(crate) fn entries(lines: &[String]) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (line, text) in lines.iter().enumerate() {
        let text = without_comment(text);
        for delimiter in [b'\t', b',', b';'] {
            let dialect = Dialect { delimiter: Delimiter::Character(delimiter), decimal: '.' };
            if !dialect.occurs(text) {
                continue;
            }
            let cells = cells(dialect, text);
            if let [key, values @ ..] = cells.as_slice() {
                entries.push(Entry::new(key, values.to_vec(), line));
            }
            entries.extend(cells.iter().filter_map(|cell| assignment(cell, line)));
            let below = lines.get(line + 1).map(|below| self::cells(dialect, without_comment(below)));
            let pairs = cells.iter().zip(below.into_iter().flatten());
            entries.extend(pairs.map(|(name, value)| Entry::new(name, vec![value], line)));
        }
        entries.extend(assignment(text, line));
    }
    entries
}

/// `key = value` or `key: value`.
fn assignment(text: &str, line: usize) -> Option<Entry> {
    let (key, value) = text.split_once(['=', ':'])?;
    Some(Entry::new(key, vec![value.trim().to_owned()], line))
}

impl Entry {
    fn new(key: &str, values: Vec<String>, line: usize) -> Self {
        let written = key.trim().trim_matches('"').to_owned();
        let opens = written.find(['(', '[', '{']);
        let (name, unit) = match opens {
            Some(at) => (&written[..at], Some(crate::unit::without_brackets(&written[at..]).trim().to_owned())),
            None => (&*written, None),
        };
        Self { key: words(name), unit, values, line, written }
    }
}

/// A name in small letters, with single spaces between its words.
pub(crate) fn words(name: &str) -> String {
    let lower = name.to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    words.join(" ")
}

/// A line without the mark that makes it a comment.
pub(crate) fn without_comment(line: &str) -> &str {
    let text = line.trim_start();
    text.strip_prefix("//").unwrap_or(text).trim_start_matches(['#', '%', '!', '*', ';']).trim()
}

/// The cells of a line.
pub(crate) fn cells(dialect: Dialect, line: &str) -> Vec<String> {
    let mut fields = Vec::new();
    dialect.split(line, &mut fields);
    fields.into_iter().map(Cow::into_owned).collect()
}
