//! What a text table's columns are called: the line before the table, and the units beside or below the names.

use crate::dialect::{Delimiter, Dialect, Kind};
use crate::layout::{Layout, is_comment};
use crate::preamble::{Entry, cells, without_comment, words};
use crate::unit::{Unit, without_brackets};

/// Most lines between the names and the table: units, a type, an empty line.
const NEAREST: usize = 6;

/// The names of a table's columns.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// A name for every column, possibly empty; with the unit in parentheses if it stands apart.
    pub names: Vec<String>,
    /// Index of the line.
    pub line: usize,
    /// How many cells the line has that are not empty at its end.
    pub cells: usize,
}

/// A line of the preamble that has a cell for every column.
struct Aligned {
    line: usize,
    cells: Vec<String>,
}

/// The header of `layout` among the lines before it.
pub(crate) fn find(lines: &[String], layout: &Layout, entries: &[Entry]) -> Option<Header> {
    if layout.kinds.first() == Some(&Kind::Empty)
        && let Some(header) = keyed(entries, layout.kinds.len())
    {
        return Some(header);
    }
    if let Some(header) = numbered(entries, layout.kinds.len()) {
        return Some(header);
    }
    let near = aligned(&lines[..layout.start], layout);
    let units_at = near.iter().position(|line| is_units(&line.cells));
    let names_at = match units_at {
        // Names stand above their units, or below them.
        Some(at) => (at + 1 < near.len()).then_some(at + 1).or_else(|| at.checked_sub(1)),
        None => near.iter().position(|line| is_names(&line.cells)),
    };
    let beside = units_beside(entries, layout.kinds.len());
    let units = units_at.map(|at| near[at].cells.clone()).or(beside);
    let names = near.get(names_at.or(units_at)?)?;
    let units = if names_at.is_some() { units.unwrap_or_default() } else { Vec::new() };
    let with_unit = |(index, name): (usize, &String)| match units.get(index).map(|unit| without_brackets(unit)) {
        Some(unit) if !unit.is_empty() && unit.parse::<f64>().is_err() && !states_unit(name) => {
            format!("{name} ({unit})")
        }
        _ => name.clone(),
    };
    let filled = names.cells.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1);
    Some(Header { names: names.cells.iter().enumerate().map(with_unit).collect(), line: names.line, cells: filled })
}

/// Whether a name is a unit, or has one in brackets behind it.
pub(crate) fn states_unit(name: &str) -> bool {
    name.parse::<Unit>().is_ok() || name.ends_with([')', ']', '}'])
}

/// The lines before the table that have a cell for each of its columns, the nearest first.
fn aligned(before: &[String], layout: &Layout) -> Vec<Aligned> {
    let mut found = Vec::new();
    for (line, text) in before.iter().enumerate().rev().take(NEAREST) {
        if text.trim().is_empty() {
            // One empty line may stand below the names, none within them.
            if found.is_empty() { continue } else { break }
        }
        match split_as(text, layout) {
            Some(cells) => found.push(Aligned { line, cells }),
            None if found.is_empty() => {}
            None => break,
        }
    }
    found
}

/// The cells of a line if there is one for every column.
fn split_as(text: &str, layout: &Layout) -> Option<Vec<String>> {
    let columns = layout.kinds.len();
    let marked = is_comment(text);
    let text = if marked { without_comment(text) } else { text };
    let cells = cells(layout.dialect, text);
    let filled = cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    // A column more may be a comment's, or hold what only the header says.
    if cells.len() >= columns && filled >= 1 && (filled <= columns || extra_is_none(&cells[columns..])) {
        return Some(cells);
    }
    if cells.len() < columns && layout.kinds[cells.len()..].iter().all(|kind| !kind.is_numeric()) && cells.len() > 1 {
        return Some(cells);
    }
    let fits = |cells: Vec<String>| (cells.len() == columns).then_some(cells);
    let other = |delimiter| fits(crate::preamble::cells(Dialect { delimiter, decimal: '.' }, text));
    let in_words = || (layout.dialect.delimiter == Delimiter::WhiteSpace).then(|| fits(spaced(text))).flatten();
    let bracketed =
        || (layout.dialect.delimiter == Delimiter::WhiteSpace).then(|| fits(after_brackets(text))).flatten();
    // Programs comment a header out and separate it in their own way.
    let separated = || [b'\t', b',', b';'].into_iter().find_map(|c| other(Delimiter::Character(c)));
    in_words().or_else(bracketed).or_else(separated).or_else(|| marked.then(|| other(Delimiter::WhiteSpace)).flatten())
}

/// Whether the names beyond the last column name nothing that a row has.
fn extra_is_none(names: &[String]) -> bool {
    const NONE: [&str; 8] = ["", "comment", "comments", "kommentar", "start", "increment", "t0", "tinc"];
    names.iter().all(|name| NONE.contains(&words(name.split('=').next().unwrap_or("")).as_str()))
}

/// Names with single spaces in them, separated by more.
fn spaced(text: &str) -> Vec<String> {
    let tabs = text.replace('\t', "  ");
    tabs.split("  ").map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// Names that end with their units in brackets.
fn after_brackets(text: &str) -> Vec<String> {
    let parts = text.split_inclusive([')', ']']);
    parts.map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// Whether a line names a unit in every cell that is not empty, or a count of samples, or numbers behind them.
fn is_units(cells: &[String]) -> bool {
    const COUNTS: [&str; 6] = ["sequence", "samples", "sample", "pts", "points", "n"];
    let is_unit = |cell: &str| without_brackets(cell).parse::<Unit>().is_ok();
    let fits = |cell: &String| {
        is_unit(cell) || COUNTS.contains(&words(cell).as_str()) || cell.parse::<f64>().is_ok() || is_no_unit(cell)
    };
    let mut filled = cells.iter().filter(|cell| !cell.is_empty()).peekable();
    filled.peek().is_some() && cells.iter().any(|cell| is_unit(cell)) && filled.all(fits)
}

/// Whether a cell of a row of units says that there is none.
fn is_no_unit(cell: &str) -> bool {
    matches!(
        cell.trim(),
        "-" | "–" | "()" | "[]" | "(-)" | "[-]" | "1" | "°C" | "[°C]" | "(°C)" | "A" | "mA" | "N" | "Hz" | "%"
    )
}

/// Whether most cells of a line are words.
fn is_names(cells: &[String]) -> bool {
    let filled = cells.iter().filter(|cell| !cell.is_empty()).count();
    let named =
        cells.iter().filter(|cell| cell.parse::<f64>().is_err() && cell.chars().any(char::is_alphabetic)).count();
    named > 0 && 2 * named >= filled
}

/// Names that a preamble states behind a key, in a table whose first column is left for the keys, as Yokogawa's is.
fn keyed(entries: &[Entry], columns: usize) -> Option<Header> {
    const NAMES: [&str; 8] = ["tracename", "trace name", "label", "labels", "name", "names", "signal", "source"];
    let fits = |entry: &&Entry| NAMES.contains(&entry.key.as_str()) && entry.values.len() + 1 >= columns.min(3);
    let entry = entries.iter().find(fits)?;
    let units = units_beside(entries, columns).unwrap_or_default();
    let with_unit = |(index, name): (usize, &String)| match units.get(index + 1).filter(|unit| !unit.is_empty()) {
        Some(unit) if !name.is_empty() => format!("{name} ({unit})"),
        _ => name.clone(),
    };
    let mut names = vec![String::new()];
    names.extend(entry.values.iter().enumerate().map(with_unit));
    Some(Header { line: entry.line, cells: names.len(), names })
}

/// The units that a preamble states under a key of their own, a cell a column: Tektronix' `Vertical Units`, LabVIEW's
/// `Y_Unit_Label`.
fn units_beside(entries: &[Entry], columns: usize) -> Option<Vec<String>> {
    const OTHERS: [&str; 8] =
        ["vunit", "vertical units", "vertical unit", "y unit label", "units", "unit", "einheit", "einheiten"];
    const FIRST: [&str; 3] = ["horizontal units", "horizontal unit", "x unit label"];
    let of = |keys: &[&str]| entries.iter().find(|entry| keys.contains(&entry.key.as_str()));
    let time_is_x =
        || entries.iter().any(|entry| entry.key == "x dimension" && entry.values.iter().any(|v| v == "Time"));
    let first = match of(&FIRST).and_then(|entry| entry.values.first()) {
        Some(unit) => unit.clone(),
        None if time_is_x() => "s".to_owned(),
        None => String::new(),
    };
    let others = of(&OTHERS).map(|entry| entry.values.clone()).unwrap_or_default();
    if first.is_empty() && others.is_empty() {
        return None;
    }
    let mut units = vec![first];
    units.extend(others);
    units.truncate(columns);
    Some(units.into_iter().map(|unit| if unit.parse::<Unit>().is_ok() { unit } else { String::new() }).collect())
}

/// Names that a preamble states one a line: `NAME0 = …`, as PI's controllers do.
fn numbered(entries: &[Entry], columns: usize) -> Option<Header> {
    let name = |index: usize| {
        let key = format!("name{index}");
        let entry = entries.iter().find(|entry| entry.key == key)?;
        Some((entry.values.first()?.clone(), entry.line))
    };
    let from = usize::from(name(0).is_none());
    let names: Vec<(String, usize)> = (from..from + columns).map(name).collect::<Option<_>>()?;
    let line = names.first()?.1;
    Some(Header { cells: names.len(), names: names.into_iter().map(|(name, _)| name).collect(), line })
}
