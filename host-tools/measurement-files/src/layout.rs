//! Where the table of a text begins, and in which dialect it is written.
//!
//! A row has numbers or time stamps; a run is a stretch of rows whose fields are of the same kinds. The table is the
//! run with the most numbers, in the dialect that finds most of them; one of several columns comes before a list of
//! settings, however long. What stands before it is the preamble.

use std::borrow::Cow;

use crate::dialect::{Dialect, Kind};

/// Rows that make a stretch a table of its own, whatever stands between it and the next.
const TABLE: usize = 16;
/// Lines between two stretches of rows that may be damage within one table.
const DAMAGE: usize = 3;

/// A table found in the first lines of a text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Layout {
    pub dialect: Dialect,
    /// Index of the first row among the lines.
    pub start: usize,
    /// Index after the last row of the longest run.
    pub end: usize,
    /// What each column holds; of empty fields and others, the others.
    pub kinds: Vec<Kind>,
}

impl Layout {
    fn numeric(&self) -> usize {
        self.kinds.iter().filter(|kind| kind.is_numeric()).count()
    }

    /// How likely this is the table: one of several columns and enough rows before all others, then the one
    /// with most numbers.
    fn weight(&self) -> (bool, usize) {
        (self.numeric() >= 2 && self.rows() >= TABLE, self.rows() * self.numeric())
    }

    fn text(&self) -> usize {
        self.kinds.iter().filter(|kind| **kind == Kind::Text).count()
    }

    /// How many rows the longest run has.
    pub fn rows(&self) -> usize {
        self.end - self.start
    }
}

/// The table in `lines`, if there is a row in them.
pub(crate) fn find(lines: &[String]) -> Option<Layout> {
    let mut best: Option<Layout> = None;
    for dialect in Dialect::ALL {
        let Some(found) = find_in(lines, dialect) else { continue };
        let score = |layout: &Layout| (layout.weight(), usize::MAX - layout.text());
        if best.as_ref().is_none_or(|best| score(&found) > score(best)) {
            best = Some(found);
        }
    }
    best
}

fn find_in(lines: &[String], dialect: Dialect) -> Option<Layout> {
    let runs = runs(lines, dialect);
    // Of equals the first: `max_by_key` would take the last.
    let (longest, _) = runs.iter().enumerate().rev().max_by_key(|(_, run)| run.weight())?;
    let mut table = runs[longest].clone();
    for earlier in runs[..longest].iter().rev() {
        if continues(earlier, &table, lines) {
            table.start = earlier.start;
        }
    }
    // A damaged first row is a row, to be refused with its place, and no header.
    while table.start > 0 && is_damaged_row(&lines[table.start - 1], &table) {
        table.start -= 1;
    }
    Some(table)
}

/// The stretches of rows of one kind each.
fn runs(lines: &[String], dialect: Dialect) -> Vec<Layout> {
    let mut runs: Vec<Layout> = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let Some(kinds) = row(line, dialect) else { continue };
        if let Some(run) = runs.last_mut()
            && run.end == index
            && let Some(both) = merged(&run.kinds, &kinds)
        {
            run.kinds = both;
            run.end = index + 1;
            continue;
        }
        runs.push(Layout { dialect, start: index, end: index + 1, kinds });
    }
    runs
}

/// What the fields of a row hold; nothing for a line without a number.
fn row(line: &str, dialect: Dialect) -> Option<Vec<Kind>> {
    if is_comment(line) || !dialect.occurs(line) {
        return None;
    }
    let mut fields = Vec::new();
    dialect.split(line, &mut fields);
    let kinds: Vec<Kind> = fields.iter().map(|field| dialect.kind(field)).collect();
    kinds.iter().any(|kind| kind.is_numeric()).then_some(kinds)
}

/// Whether a line is marked as a comment.
pub(crate) fn is_comment(line: &str) -> bool {
    line.trim_start().starts_with(['#', '%', '!', '*']) || line.trim_start().starts_with("//")
}

/// The kinds of two rows that can stand in one table: the same but for empty fields, and for text or nothing behind the
/// shorter one.
fn merged(first: &[Kind], second: &[Kind]) -> Option<Vec<Kind>> {
    let (short, long) = if first.len() <= second.len() { (first, second) } else { (second, first) };
    if long[short.len()..].iter().any(|kind| kind.is_numeric()) {
        return None;
    }
    let one = |(a, b): (&Kind, &Kind)| match (a, b) {
        (Kind::Empty, kind) | (kind, Kind::Empty) => Some(*kind),
        (a, b) if a == b => Some(*a),
        _ => None,
    };
    let mut kinds: Vec<Kind> = short.iter().zip(long).map(one).collect::<Option<_>>()?;
    kinds.extend(&long[short.len()..]);
    Some(kinds)
}

/// Whether the earlier rows belong to the table, which something interrupts. A line without any number, such as a
/// header, begins a new table, unless the earlier rows are many.
fn continues(earlier: &Layout, table: &Layout, lines: &[String]) -> bool {
    let same = merged(&earlier.kinds, &table.kinds).is_some_and(|kinds| {
        let numeric = kinds.iter().filter(|kind| kind.is_numeric()).count();
        numeric == table.numeric() && numeric == earlier.numeric()
    });
    // Words where the table has nothing are the keys of settings.
    let has_keys = earlier.kinds.iter().zip(&table.kinds).any(|kinds| kinds == (&Kind::Text, &Kind::Empty));
    let between = &lines[earlier.end..table.start];
    let heading = |line: &String| {
        !line.trim().is_empty() && !is_comment(line) && row(line, table.dialect).is_none() && !has_digit_first(line)
    };
    same && !has_keys && (earlier.rows() >= TABLE || (between.len() <= DAMAGE && !between.iter().any(heading)))
}

fn has_digit_first(line: &str) -> bool {
    line.trim_start().starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c))
}

/// Whether a line has a number where the table has its first, and as many fields.
fn is_damaged_row(line: &str, table: &Layout) -> bool {
    let mut fields: Vec<Cow<'_, str>> = Vec::new();
    table.dialect.split(line, &mut fields);
    let first = table.kinds.iter().position(|kind| kind.is_numeric());
    !is_comment(line)
        && fields.len() == table.kinds.len()
        && first.is_some_and(|first| table.dialect.kind(&fields[first]) == table.kinds[first])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialect::Delimiter;

    fn found(text: &str) -> (char, char, usize, usize) {
        let lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let layout = find(&lines).unwrap_or_else(|| panic!("no table in {text}"));
        let delimiter = match layout.dialect.delimiter {
            Delimiter::Character(c) => char::from(c),
            Delimiter::WhiteSpace => ' ',
        };
        (delimiter, layout.dialect.decimal, layout.start, layout.numeric())
    }

    /// A table of 20 rows whose fields are joined by `separator`.
    fn table(separator: &str, decimal: &str) -> String {
        let row = |k: i32| [format!("{}", f64::from(k) + 0.5), format!("{}.25", -k), format!("{k}.125")];
        (0..20).map(|k| row(k).map(|field| field.replace('.', decimal)).join(separator) + "\n").collect()
    }

    #[test]
    fn the_dialect_is_the_one_that_finds_most_numbers() {
        for (separator, decimal, expected) in [
            (",", ".", (',', '.')),
            (", ", ".", (',', '.')),
            (";", ".", (';', '.')),
            (" ; ", ",", (';', ',')),
            ("\t", ".", ('\t', '.')),
            ("\t", ",", ('\t', ',')),
            ("  ", ".", (' ', '.')),
            (" ", ",", (' ', ',')),
            ("|", ",", ('|', ',')),
        ] {
            let (delimiter, point, start, numbers) = found(&table(separator, decimal));
            assert_eq!((delimiter, point, start, numbers), (expected.0, expected.1, 0, 3), "{separator:?} {decimal}");
        }
        let quoted: String = table("\",\"", ",").lines().map(|line| format!("\"{line}\"\n")).collect();
        assert_eq!(found(&quoted), (',', ',', 0, 3));
        assert_eq!(found("1,2\n3,4\n"), (',', '.', 0, 2));
    }

    #[test]
    fn the_table_begins_after_any_preamble() {
        let preamble: String = (0..300).map(|k| format!("Setting {k},{k},{k}\n")).collect();
        for (preamble, start) in [
            ("x-axis,1,2\nsecond,Volt,Volt\n", 2),
            ("Model,MSO44\n\nTIME,CH1,CH2\n", 3),
            ("2000,2,3\nTIME,CH1,CH2\n", 2),
            ("# 1,2,3\n", 1),
            ("1,2\n3,4\n5,6\n\nt,u,y\n", 5),
            (&*preamble, 300),
        ] {
            let text = preamble.to_owned() + &"0.5,1.5,2.5\n".repeat(301);
            assert_eq!(found(&text).2, start, "{preamble}");
        }
    }

    #[test]
    fn settings_above_a_table_whose_first_column_is_theirs_are_no_rows() {
        let text = "Trace,CH1,CH2\nSize,400,400\nResolution,1,1\n\n".to_owned() + &",1.5,2.5,\n".repeat(40);
        assert_eq!(found(&text).2, 4);
    }

    #[test]
    fn damaged_rows_are_rows() {
        for damaged in ["0.5,12V,1", "", "# pause", "0.5,1", "0.5,,1", "0.5,1,2,3", "0.5,-,-"] {
            for before in [1, 5, 12] {
                let rows = |count| "0.5,1.5,2.5\n".repeat(count);
                let text = format!("t,u,y\n{}{damaged}\n{}", rows(before), rows(15));
                assert_eq!(found(&text).2, 1, "{damaged:?} after {before} rows");
            }
        }
        assert_eq!(found(&format!("t,u,y\n0.5,12V,1\n{}", "0.5,1,2\n".repeat(9))).2, 1);
        let two = format!("t,u,y\n{}t,u,y\n{}", "0.5,1,2\n".repeat(20), "0.5,1,2\n".repeat(30));
        assert_eq!(found(&two).2, 1, "two recordings are not one");
    }
}
