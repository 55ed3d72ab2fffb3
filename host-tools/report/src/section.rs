//! What an item comes to: tables, figures and the numbers behind them, for the terminal, the page and machines.

use serde_json::{Value, json};
use std::fmt::Write;

/// A reproduced part of the thesis.
#[derive(Clone, Debug)]
pub struct Section {
    /// What it is and which tables and figures of the thesis it stands beside.
    pub title: &'static str,
    /// Tables of the section, before its figures.
    pub tables: Vec<Grid>,
    /// How to read them.
    pub notes: Vec<String>,
    /// Figures of the section.
    pub figures: Vec<Picture>,
    /// Its numbers, as JSON.
    pub json: String,
}

/// A table of text cells.
#[derive(Clone, Debug, Default)]
pub struct Grid {
    /// What it shows, and whose figures they are.
    pub caption: String,
    columns: Vec<Column>,
    rows: Vec<Vec<String>>,
}

#[derive(Clone, Debug)]
struct Column {
    heading: String,
    /// Least width in a terminal, characters.
    width: usize,
    left: bool,
}

/// A figure with its caption.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The picture as inline SVG.
    pub svg: String,
    /// What the picture shows, for its caption.
    pub name: String,
    /// "held out", "training" or nothing.
    pub role: &'static str,
    /// The rest of the caption.
    pub caption: String,
}

impl Section {
    /// One that has nothing to show but why.
    pub fn failed(why: &str) -> Self {
        Self {
            title: "Not reproduced",
            tables: Vec::new(),
            notes: vec![why.to_owned()],
            figures: Vec::new(),
            json: json!({ "failed": why }).to_string(),
        }
    }

    /// Its numbers.
    ///
    /// # Errors
    /// [`json`](Self::json) is none.
    pub fn data(&self) -> serde_json::Result<Value> {
        serde_json::from_str(&self.json)
    }

    /// As text, without the title.
    pub fn text(&self) -> String {
        let mut paragraphs: Vec<String> = self.tables.iter().map(Grid::text).collect();
        if !self.notes.is_empty() {
            paragraphs.push(self.notes.join("\n"));
        }
        paragraphs.join("\n\n")
    }
}

impl Grid {
    /// An empty table.
    pub fn new(caption: String) -> Self {
        Self { caption, ..Self::default() }
    }

    /// With a column of words after those that it has.
    #[must_use]
    pub fn words(mut self, heading: &str, width: usize) -> Self {
        self.columns.push(Column { heading: heading.to_owned(), width, left: true });
        self
    }

    /// With a column of numbers after those that it has.
    #[must_use]
    pub fn numbers(mut self, heading: &str, width: usize) -> Self {
        self.columns.push(Column { heading: heading.to_owned(), width, left: false });
        self
    }

    /// Adds a row, a cell a column.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        self.rows.push(cells.into_iter().collect());
    }

    /// Adds a row of a name and of these cells, each with its column counted from 0; the others have nothing to say.
    pub fn sparse_row(&mut self, name: &str, cells: impl IntoIterator<Item = (usize, String)>) {
        let mut row = vec!["–".to_owned(); self.columns.len()];
        for (column, cell) in [(0, name.to_owned())].into_iter().chain(cells) {
            if let Some(place) = row.get_mut(column) {
                *place = cell;
            }
        }
        self.rows.push(row);
    }

    /// Headings, the first of which is the rows'.
    pub fn headings(&self) -> impl Iterator<Item = &str> {
        self.columns.iter().map(|column| column.heading.as_str())
    }

    /// Rows: the first cell, which names them, and the others.
    pub fn named(&self) -> impl Iterator<Item = (&String, &[String])> {
        self.rows.iter().filter_map(|row| row.split_first())
    }

    /// As text: caption, headings, rows, each column as wide as its widest cell.
    pub fn text(&self) -> String {
        let length = |text: &str| text.chars().count();
        let widths: Vec<usize> = (self.columns.iter().enumerate())
            .map(|(index, column)| {
                let cells = self.rows.iter().filter_map(|row| row.get(index));
                let widest = cells.map(|cell| length(cell)).max().unwrap_or(0);
                column.width.max(length(&column.heading)).max(widest)
            })
            .collect();
        let line = |cells: &mut dyn Iterator<Item = &str>| {
            let padded = cells.zip(&self.columns).zip(&widths).map(|((cell, column), &width)| {
                if column.left { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
            });
            padded.collect::<Vec<_>>().join(" ").trim_end().to_owned()
        };
        let mut text = format!("{}\n{}", self.caption, line(&mut self.headings()));
        for row in &self.rows {
            // A String takes all that is written to it.
            let _ = write!(text, "\n{}", line(&mut row.iter().map(String::as_str)));
        }
        text
    }
}

/// A number with so many decimals; a dash where there is none.
pub fn shown(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Yes or no.
pub fn yes(is: bool) -> String {
    if is { "yes" } else { "no" }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell_and_numbers_stand_right() {
        let mut grid = Grid::new("Caption.".to_owned()).words("name", 6).numbers("µm", 4);
        grid.row(["a".to_owned(), shown(Some(0.12345), 3)]);
        grid.row(["a longer".to_owned(), shown(None, 3)]);
        assert_eq!(grid.text(), "Caption.\nname        µm\na        0.123\na longer     –");
        let rows: Vec<_> = grid.named().collect();
        assert_eq!(rows[0], (&"a".to_owned(), &["0.123".to_owned()][..]));
    }
}
