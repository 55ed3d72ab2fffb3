//! Documentation that satisfies the lint and no reader: a line of one or two words, by itself.

use std::path::Path;

use anyhow::Result;
use xshell::{Shell, cmd};

/// Words that say too little of an item.
const TOO_FEW: usize = 2;

/// The brief ones of the repository's sources, each with its place.
pub fn of_repository(sh: &Shell) -> Result<Vec<String>> {
    let mut broken = Vec::new();
    for path in cmd!(sh, "git ls-files -- *.rs").read()?.lines().filter(|path| sh.path_exists(Path::new(path))) {
        let brief = |(line, words)| {
            format!(
                "{path}:{line}: \"{words}\" says no more than the item's name: say what it is of, in which unit, or why it is there"
            )
        };
        broken.extend(brief_docs(&sh.read_file(path)?).into_iter().map(brief));
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_words_by_themselves_are_brief_and_a_line_of_several_is_not() {
        let text = "/// The table.\na: A,\n/// The table of it.\nb: B,\n    /// Says\n    /// more.\nc: C,\n// No doc.\n///\nd: D,";
        assert_eq!(brief_docs(text), [(1, "The table."), (9, "")]);
    }
}
