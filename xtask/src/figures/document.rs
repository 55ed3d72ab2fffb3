//! Where figures stand in a document: between `<!-- figures: NAME -->` and `<!-- /figures -->`, a value within a line
//! or a table of several lines.

use std::{ops::Range, path::PathBuf};

use anyhow::{Context, Result, bail, ensure};

const OPEN: &str = "<!-- figures: ";
const OPEN_END: &str = " -->";
const CLOSE: &str = "<!-- /figures -->";

/// A text with figures in it.
pub struct Document {
    /// The document's file.
    pub path: PathBuf,
    /// The document's whole text.
    pub text: String,
}

/// A figure's place in a document.
pub struct Place {
    /// The figure's name.
    pub name: String,
    /// Number of the line in which it begins, from 1.
    pub line: usize,
    /// The bytes between the markers.
    pub body: Range<usize>,
}

impl Document {
    /// The places of all figures, in the order of the text.
    ///
    /// # Errors
    /// A marker is not closed, or closes nothing.
    pub fn places(&self) -> Result<Vec<Place>> {
        let mut places = Vec::new();
        let mut at = 0;
        while let Some(open) = self.text[at..].find(OPEN).map(|open| at + open) {
            let line = self.line(open);
            let place = || format!("{}:{line}", self.path.display());
            let name = open + OPEN.len();
            let body = self.text[name..].find(OPEN_END).map(|end| name + end);
            let body = body.with_context(|| format!("{}: `{OPEN}` without `{OPEN_END}`", place()))?;
            let start = body + OPEN_END.len();
            let close = self.text[start..].find(CLOSE).map(|close| start + close);
            let close = close.with_context(|| format!("{}: `{OPEN}` without `{CLOSE}`", place()))?;
            ensure!(
                !self.text[start..close].contains(OPEN),
                "{}: `{CLOSE}` is missing before the next figure",
                place()
            );
            ensure!(
                self.text[start..close].contains('\n')
                    || self.text[..open].chars().next_back().is_some_and(|c| c != '\n'),
                "{}: a value at the start of a line makes Markdown show the line as HTML: put a word before it",
                place()
            );
            places.push(Place { name: self.text[name..body].to_owned(), line, body: start..close });
            at = close + CLOSE.len();
        }
        let closed = self.text.matches(CLOSE).count();
        ensure!(closed == places.len(), "{}: a `{CLOSE}` closes nothing", self.path.display());
        Ok(places)
    }

    fn line(&self, at: usize) -> usize {
        1 + self.text[..at].matches('\n').count()
    }
}

/// What stands between the markers.
pub enum Content {
    /// A value, within a line.
    Value(String),
    /// A table of Markdown.
    Table(Table),
    /// A file of its own.
    File(Vec<u8>),
}

/// The figures of a table. The document may have columns beside them, of words: they stay as they are.
pub struct Table {
    /// How many columns at the left name a row; their headings are the document's own.
    pub keys: usize,
    /// The headings of the columns that are figures.
    pub columns: Vec<String>,
    /// For each row its names and then its figures.
    pub rows: Vec<Vec<String>>,
}

/// Whether two texts are the same but for numbers that differ by no more than this part of the larger one.
pub fn alike(stated: &str, printed: &str, slack: f64) -> bool {
    let number = |word: &str| word.replace(',', "").parse::<f64>().ok();
    let same = |(a, b): (&str, &str)| {
        let near = |(a, b): (f64, f64)| (a - b).abs() <= slack * a.abs().max(b.abs());
        a == b || number(a).zip(number(b)).is_some_and(near)
    };
    let (stated, printed) = (stated.split_whitespace(), printed.split_whitespace());
    stated.clone().count() == printed.clone().count() && stated.zip(printed).all(same)
}

impl Content {
    /// What should stand in the place of `body`.
    ///
    /// # Errors
    /// `body` is a table where a value should be or the reverse, or a table without one of the columns.
    pub fn written(&self, body: &str) -> Result<String> {
        match self {
            Self::Value(value) => {
                ensure!(!body.contains('\n'), "the figure is a value: its markers belong in one line");
                Ok(value.clone())
            }
            Self::Table(table) => table.written(body),
            Self::File(_) => bail!("the figure is a file, which has no place in a document"),
        }
    }
}

impl Table {
    fn written(&self, body: &str) -> Result<String> {
        let mut lines = body.trim().lines();
        let heading = lines.next().filter(|line| line.starts_with('|'));
        let heading = heading.context("the figure is a table: its heading is missing between the markers")?;
        let rule = lines.next().context("the table has no line `|---|` under its heading")?;
        let old: Vec<Vec<&str>> = lines.map(cells).collect();
        let headings = cells(heading);
        for column in &self.columns {
            ensure!(
                headings[self.keys.min(headings.len())..].contains(&column.as_str()),
                "the table has no column `{column}`"
            );
        }
        let mut written = format!("\n{heading}\n{rule}\n");
        for row in &self.rows {
            let (names, figures) = row.split_at(self.keys);
            let before = old.iter().find(|cells| cells.iter().zip(names).all(|(cell, name)| cell == name));
            let cell = |(index, heading): (usize, &&str)| {
                let figure = || self.columns.iter().zip(figures).find(|(column, _)| column == heading);
                let words = || before.and_then(|cells| cells.get(index)).copied();
                names.get(index).or_else(|| Some(figure()?.1)).map_or_else(|| words().unwrap_or(""), String::as_str)
            };
            written += &format!("| {} |\n", headings.iter().enumerate().map(cell).collect::<Vec<_>>().join(" | "));
        }
        Ok(written)
    }
}

fn cells(line: &str) -> Vec<&str> {
    let line = line.trim();
    line.strip_prefix('|').unwrap_or(line).trim_end_matches('|').split('|').map(str::trim).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(text: &str) -> Document {
        Document { path: "README.md".into(), text: text.to_owned() }
    }

    #[test]
    fn numbers_may_differ_by_the_slack_and_words_not_at_all() {
        let stated = "| `voigt` | 5,334 | 22 |";
        assert!(alike(stated, "| `voigt` | 5,320 | 22 |", 0.03) && alike(stated, stated, 0.0));
        for other in
            ["| `voigt` | 5,520 | 22 |", "| `duhem` | 5,334 | 22 |", "| `voigt` | 5,334 |", "| `voigt` | – | 22 |"]
        {
            assert!(!alike(stated, other, 0.03), "{other}");
        }
        assert!(!alike(stated, "| `voigt` | 5,320 | 22 |", 0.0));
    }

    #[test]
    fn places_are_found_with_their_lines() {
        let document =
            document("one\nis <!-- figures: a -->1<!-- /figures --> two\n<!-- figures: b -->\n2\n<!-- /figures -->\n");
        let places = document.places().expect("sound");
        let found: Vec<(&str, usize, &str)> =
            places.iter().map(|place| (place.name.as_str(), place.line, &document.text[place.body.clone()])).collect();
        assert_eq!(found, [("a", 2, "1"), ("b", 3, "\n2\n")]);
    }

    #[test]
    fn markers_that_do_not_match_are_refused() {
        for (text, complaint) in [
            ("\n<!-- figures: a -->1", "README.md:2"),
            ("<!-- figures: a -->1 <!-- figures: b -->2<!-- /figures -->", "before the next"),
            ("<!-- /figures -->", "closes nothing"),
            ("one\n<!-- figures: a -->1<!-- /figures -->", "start of a line"),
        ] {
            let error = document(text).places().err().expect(text).to_string();
            assert!(error.contains(complaint), "{text}: {error}");
        }
    }

    #[test]
    fn a_table_keeps_its_words_and_gets_its_figures() {
        let table = Table {
            keys: 1,
            columns: vec!["µm".to_owned()],
            rows: vec![vec!["`b`".to_owned(), "0.2".to_owned()], vec!["`c`".to_owned(), "0.3".to_owned()]],
        };
        let body = "\n| model | what | µm |\n|---|---|---:|\n| `a` | gone | 1 |\n| `b` | stays | 1 |\n";
        let written = table.written(body).expect("sound");
        assert_eq!(written, "\n| model | what | µm |\n|---|---|---:|\n| `b` | stays | 0.2 |\n| `c` |  | 0.3 |\n");
        assert_eq!(table.written(&written).expect("sound"), written);
        let error = table.written("\n| model | nm |\n|---|---|\n").expect_err("no such column").to_string();
        assert!(error.contains("µm"), "{error}");
        assert!(Content::Table(table).written("0.2").is_err());
        assert!(Content::Value("1".to_owned()).written("\n| a |\n").is_err());
    }
}
