//! Text tables: found by themselves behind a preamble of any length.

use std::collections::VecDeque;
use std::io::BufRead;

use crate::dialect::{Dialect, Kind};
use crate::fault::{Fault, Place, PlacedFault};
use crate::header::{self, Header};
use crate::layout::{self, Layout, is_comment};
use crate::lines::Lines;
use crate::preamble;
use crate::sample_time;
use crate::table::{Body, Column, Table};
use crate::text_rows::{Clock, TextRows};

/// How much text is looked at to find the table, bytes.
const HEAD: usize = 1 << 18;
/// How much is looked at where the table has not begun yet, bytes.
const LONGEST_PREAMBLE: usize = 1 << 22;
/// Rows that are a table without doubt.
const CERTAIN: usize = 16;

/// Opens the table in a text.
pub(crate) fn open<'a>(stream: Box<dyn BufRead + 'a>) -> Result<Table<'a>, PlacedFault> {
    let mut rest = Lines::new(stream)?;
    let (lines, layout) = head(&mut rest)?;
    let Some(layout) = layout else {
        let blank = |line: &String| line.trim().is_empty() || is_comment(line);
        return Err(if lines.iter().all(blank) { Fault::Empty.into() } else { Fault::NoRows.into() });
    };
    let entries = preamble::entries(&lines[..layout.start]);
    let header = header::find(&lines, &layout, &entries);
    if header.is_none() && decimal_commas(&lines, &layout) {
        return Err(Fault::DecimalCommas.at(Place::Line(layout.start + 1)));
    }
    let sample_time = sample_time::find(&entries);
    let (named, at) = match &header {
        Some(header) => (true, header.line),
        None => (false, layout.start),
    };
    let fields = widths(&layout, header.as_ref());
    let columns = columns(&lines, &layout, header);
    let first_row = Place::Line(layout.start + 1);
    let head: VecDeque<String> = lines.into_iter().skip(layout.start).collect();
    let line = layout.start;
    let body = Body::Text(Box::new(TextRows { layout, fields, head, rest, line }));
    Ok(Table { columns, named, header: Place::Line(at + 1), sample_time, first_row, body })
}

/// The first lines of a text, as many as it takes to be sure of the table, and the table.
fn head(rest: &mut Lines<'_>) -> Result<(Vec<String>, Option<Layout>), Fault> {
    let (mut lines, mut line) = (Vec::new(), String::new());
    let (mut read, mut enough) = (0, HEAD);
    loop {
        let more = rest.next_into(&mut line)?;
        if more {
            read += line.len() + 1;
            lines.push(std::mem::take(&mut line));
            if read < enough {
                continue;
            }
        }
        let layout = layout::find(&lines);
        let certain =
            layout.as_ref().is_some_and(|layout| layout.rows() >= CERTAIN && layout.end + CERTAIN > lines.len());
        if !more || certain || enough >= LONGEST_PREAMBLE {
            return Ok((lines, layout));
        }
        enough *= 4;
    }
}

/// Whether commas stand between the fields and in the numbers, too: the line before the rows has half as many fields as
/// they, units among them and no number, and no row has a decimal point.
fn decimal_commas(lines: &[String], layout: &Layout) -> bool {
    let comma = Dialect::ALL[0];
    let mut names = Vec::new();
    if let Some(before) = lines[..layout.start].iter().rev().find(|line| !line.trim().is_empty()) {
        comma.split(before, &mut names);
    }
    let fields = layout.kinds.len();
    let text = || names.iter().all(|name| comma.kind(name) == Kind::Text);
    let whole = || lines[layout.start..layout.end].iter().all(|row| !row.contains('.'));
    let ends = |name: &str| name.rsplit_once(['_', ' ']).is_some_and(|(_, end)| header::states_unit(end));
    let unit = || names.iter().any(|name| header::states_unit(name) || ends(name));
    layout.dialect == comma && names.len() > 1 && fields == 2 * names.len() && text() && unit() && whole()
}

/// Fewest and most fields of a row: what header and rows agree on, and what they may leave out at their ends.
fn widths(layout: &Layout, header: Option<&Header>) -> (usize, usize) {
    let least = layout.kinds.iter().rposition(|kind| kind.is_numeric()).map_or(0, |last| last + 1);
    (least, layout.kinds.len().max(header.map_or(0, |header| header.cells)))
}

fn columns(lines: &[String], layout: &Layout, header: Option<Header>) -> Vec<Column> {
    let names =
        header.map(|header| header.names).unwrap_or_default().into_iter().chain(std::iter::repeat(String::new()));
    let column = |(kind, name): (&Kind, String)| Column {
        name,
        numeric: kind.is_numeric(),
        stamps: *kind == Kind::Stamp,
        text: None,
        values: Vec::new(),
    };
    let mut columns: Vec<Column> = layout.kinds.iter().zip(names).map(column).collect();
    let mut clocks = vec![Clock::default(); columns.len()];
    let mut fields = Vec::new();
    for line in &lines[layout.start..layout.end] {
        fields.clear();
        layout.dialect.split(line, &mut fields);
        for ((column, clock), field) in columns.iter_mut().zip(&mut clocks).zip(&fields) {
            let value = if column.stamps { clock.seconds(field) } else { layout.dialect.number(field) };
            column.values.extend(value.filter(|_| column.numeric));
            if !column.numeric && column.text.is_none() && layout.dialect.kind(field) == Kind::Text {
                column.text = Some(field.to_string());
            }
        }
    }
    columns
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many rows a text has, or where and why it is refused.
    fn rows(text: &str) -> Result<usize, (Place, Fault)> {
        let mut rows = 0;
        let read = open(Box::new(text.as_bytes())).and_then(|table| table.rows(&[1, 2], false, &mut |_| rows += 1));
        read.map(|()| rows).map_err(|PlacedFault(place, fault)| (place, fault))
    }

    #[test]
    fn commas_between_fields_and_in_numbers_are_refused_by_name() {
        let row = "0,0010,0,0043,2,99890\n";
        let (place, fault) = rows(&("Zeit [s],Spannung [V],Weg [µm]\n".to_owned() + &row.repeat(50))).unwrap_err();
        assert!(matches!(fault, Fault::DecimalCommas) && place == Place::Line(2), "{fault:?}");
        let plain = rows(&("time_s,voltage_V,displacement_um\n".to_owned() + &row.repeat(50)));
        assert!(matches!(plain, Err((_, Fault::DecimalCommas))), "{plain:?}");
        let six = "t_s,u_V,y_um,a,b,c\n".to_owned() + &row.repeat(50);
        assert_eq!(rows(&six).unwrap(), 50);
        let four = "Recorded by J. Doe, lab 3\n".to_owned() + &"0.5,1.2,3.4,5.6\n".repeat(50);
        assert_eq!(rows(&four).unwrap(), 50, "a line of text above four columns");
        assert_eq!(rows(&four.replace('.', "")).unwrap(), 50, "the same of whole numbers");
        assert_eq!(rows(&row.repeat(50)).unwrap(), 50, "no header says how many columns there are");
    }

    #[test]
    fn a_table_that_turns_to_text_is_refused_and_a_footer_is_none_of_it() {
        let good = "t_s,u_V,y_um\n".to_owned() + &"0.5,1.5,2.5\n".repeat(700);
        for (bad, value) in [("OVERLOAD,OVERLOAD,OVERLOAD\n", "OVERLOAD"), ("--,--,--\n", "--"), (",,\n", "")] {
            for count in [1, 500] {
                let (place, fault) = rows(&(good.clone() + &bad.repeat(count))).unwrap_err();
                assert_eq!(place, Place::Line(702));
                match fault {
                    Fault::NotANumber { column: 0, value: found } => assert_eq!(found, value),
                    Fault::MissingField { column: 0 } => assert_eq!(value, ""),
                    fault => panic!("{fault:?}"),
                }
            }
        }
        let (place, _) = rows(&(good.clone() + &"disconnected\n".repeat(4))).unwrap_err();
        assert_eq!(place, Place::Line(702));
        let many = "\n".repeat(9) + &"# as commanded, by hand\n".repeat(9);
        for footer in ["", "\n\n\n\n\n\n", "stopped\n", "stopped\nby,hand\n\nof operator\n", &many] {
            assert_eq!(rows(&(good.clone() + footer)).unwrap(), 700, "{footer:?}");
        }
    }
}
