//! Comments that satisfy the lints and no reader: a documentation of one or two words by itself, and lines that the
//! formatter, which leaves comments as they are, does not wrap.

use std::path::Path;

use anyhow::Result;
use xshell::{Shell, cmd};

/// Words that say too little of an item.
const TOO_FEW: usize = 2;
/// Most columns of a line, as `rustfmt.toml` has it for code.
const COLUMNS: usize = 120;

/// Those of the repository's sources, each with its place.
pub fn of_repository(sh: &Shell) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for path in cmd!(sh, "git ls-files -- *.rs").read()?.lines().filter(|path| sh.path_exists(Path::new(path))) {
        let brief = |(line, words)| {
            format!(
                "{path}:{line}: \"{words}\" says no more than the item's name: say what it is of, in which unit, or why it is there"
            )
        };
        let text = sh.read_file(path)?;
        broken.extend(brief_docs(&text).into_iter().map(brief));
        let wide = |line| format!("{path}:{line}: a comment of more than {COLUMNS} columns: wrap it");
        broken.extend(wide_lines(&text).into_iter().map(wide));
    }
    Ok(broken)
}

/// Lines of documentation of too few words that stand by themselves, and their numbers.
fn brief_docs(text: &str) -> Vec<(usize, &str)> {
    let docs: Vec<Option<&str>> = text.lines().map(|line| line.trim().strip_prefix("///")).collect();
    let doc = |at: Option<usize>| at.and_then(|at| docs.get(at).copied().flatten());
    let alone = |at: usize| doc(at.checked_sub(1)).is_none() && doc(Some(at + 1)).is_none();
    let brief = |words: &str| words.split_whitespace().count() <= TOO_FEW;
    (0..docs.len())
        .filter_map(|at| doc(Some(at)).filter(|words| alone(at) && brief(words)).map(|words| (at + 1, words.trim())))
        .collect()
}

/// The numbers of lines with a comment of too many columns and nothing else. A table's row has no other line to go on
/// in, and what is fenced stands as it is.
fn wide_lines(text: &str) -> Vec<usize> {
    let mut fenced = false;
    let mut is_wide = |line: &str| {
        let comment = line.trim_start().strip_prefix("//")?.trim_start_matches(['/', '!']).trim_start();
        fenced ^= comment.starts_with("```");
        Some(!fenced && !comment.starts_with('|') && line.chars().count() > COLUMNS)
    };
    (1..).zip(text.lines()).filter_map(|(number, line)| (is_wide(line) == Some(true)).then_some(number)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_words_by_themselves_are_brief_and_a_line_of_several_is_not() {
        let text = "/// The table.\na: A,\n/// The table of it.\nb: B,\n    /// Says\n    /// more.\nc: C,\n// No doc.\n///\nd: D,";
        assert_eq!(brief_docs(text), [(1, "The table."), (9, "")]);
    }

    #[test]
    fn a_wide_comment_is_found_but_in_a_table_and_what_is_fenced() {
        let (wide, narrow) = ("x".repeat(COLUMNS - 2), "µ".repeat(COLUMNS - 3));
        let text = format!(
            "// {wide}\n//{narrow}\n//! | {wide} |\n/// ```text\n/// {wide}\n/// ```\n    /// {wide}\n{wide}xxx"
        );
        assert_eq!(wide_lines(&text), [1, 7]);
    }
}
