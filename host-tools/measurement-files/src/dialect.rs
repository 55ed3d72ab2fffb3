//! How a text table separates its fields and writes its numbers.

use std::borrow::Cow;

use crate::stamp::Stamp;

/// What stands between two fields.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delimiter {
    Character(u8),
    WhiteSpace,
}

/// Delimiter and decimal separator of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Dialect {
    pub delimiter: Delimiter,
    /// `.` or `,`.
    pub decimal: char,
}

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Empty,
    Number,
    Stamp,
    Text,
}

impl Kind {
    /// Whether the field can be read as a number.
    pub fn is_numeric(self) -> bool {
        matches!(self, Self::Number | Self::Stamp)
    }
}

impl Dialect {
    /// Every dialect, the one to prefer first where several read the same.
    pub const ALL: [Self; 10] = [
        Self::new(Delimiter::Character(b','), '.'),
        Self::new(Delimiter::Character(b';'), '.'),
        Self::new(Delimiter::Character(b'\t'), '.'),
        Self::new(Delimiter::WhiteSpace, '.'),
        Self::new(Delimiter::Character(b'|'), '.'),
        Self::new(Delimiter::Character(b';'), ','),
        Self::new(Delimiter::Character(b'\t'), ','),
        Self::new(Delimiter::WhiteSpace, ','),
        Self::new(Delimiter::Character(b','), ','),
        Self::new(Delimiter::Character(b'|'), ','),
    ];

    const fn new(delimiter: Delimiter, decimal: char) -> Self {
        Self { delimiter, decimal }
    }

    /// Whether the delimiter occurs in a line at all.
    pub fn occurs(self, line: &str) -> bool {
        match self.delimiter {
            Delimiter::Character(c) => line.as_bytes().contains(&c),
            Delimiter::WhiteSpace => true,
        }
    }

    /// Appends the fields of a line, without the space around them. A quoted field may contain the delimiter.
    pub fn split<'a>(self, line: &'a str, fields: &mut Vec<Cow<'a, str>>) {
        match (self.delimiter, line.contains('"')) {
            (Delimiter::Character(c), false) => {
                fields.extend(line.split(char::from(c)).map(|field| Cow::Borrowed(field.trim())));
            }
            (Delimiter::WhiteSpace, false) => fields.extend(line.split_whitespace().map(Cow::Borrowed)),
            (Delimiter::Character(c), true) => fields.extend(quoted(line, c)),
            (Delimiter::WhiteSpace, true) => {
                let spaced = line.replace('\t', " ");
                fields.extend(quoted(&spaced, b' ').into_iter().filter(|field| !field.is_empty()));
            }
        }
    }

    /// What a field holds.
    pub fn kind(self, field: &str) -> Kind {
        match field {
            "" => Kind::Empty,
            _ if self.number(field).is_some() => Kind::Number,
            _ if Stamp::parse(field).is_some() => Kind::Stamp,
            _ => Kind::Text,
        }
    }

    /// The number in a field, NaN and infinity included.
    pub fn number(self, field: &str) -> Option<f64> {
        match (self.decimal, field.contains(',')) {
            (_, false) if self.decimal == ',' && field.contains('.') => None,
            (_, false) => field.parse().ok(),
            (',', true) if !field.contains('.') => field.replacen(',', ".", 1).parse().ok(),
            _ => None,
        }
    }
}

/// The fields of a line with quotation marks in it, as RFC 4180 has them; spaces before a quotation mark are no
/// part of it.
fn quoted<'a>(line: &str, delimiter: u8) -> Vec<Cow<'a, str>> {
    let tight = tightened(line, char::from(delimiter));
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .delimiter(delimiter)
        .buffer_capacity(tight.len().max(16))
        .from_reader(tight.as_bytes());
    let mut record = csv::StringRecord::new();
    match reader.read_record(&mut record) {
        Ok(true) => record.iter().map(|field| Cow::Owned(field.trim().to_owned())).collect(),
        _ => Vec::new(),
    }
}

/// The line without the spaces between a delimiter and a quotation mark.
fn tightened(line: &str, delimiter: char) -> String {
    let mut tight = String::with_capacity(line.len());
    let mut inside = false;
    let mut spaces = 0;
    for c in line.trim().chars() {
        match c {
            '"' => {
                if !inside && (tight.is_empty() || tight.ends_with(delimiter)) {
                    spaces = 0;
                }
                inside = !inside;
            }
            ' ' if !inside && delimiter != ' ' => {
                spaces += 1;
                continue;
            }
            _ => {}
        }
        if c != delimiter || inside {
            tight.extend(std::iter::repeat_n(' ', spaces));
        }
        spaces = 0;
        tight.push(c);
    }
    tight
}

#[cfg(test)]
mod tests {
    use super::*;

    fn split(dialect: Dialect, line: &str) -> Vec<String> {
        let mut fields = Vec::new();
        dialect.split(line, &mut fields);
        fields.into_iter().map(Cow::into_owned).collect()
    }

    #[test]
    fn quoted_fields_may_hold_the_delimiter() {
        let comma = Dialect::ALL[0];
        assert_eq!(split(comma, "\"time, s\", u_V"), ["time, s", "u_V"]);
        assert_eq!(split(comma, "0.5, \"run 1, \"\"warm\"\"\" ,1"), ["0.5", "run 1, \"warm\"", "1"]);
        assert_eq!(split(comma, "1, ,3,"), ["1", "", "3", ""]);
        assert_eq!(split(Dialect::ALL[3], "\"time (s)\"  \"u (V)\""), ["time (s)", "u (V)"]);
        assert_eq!(split(comma, "\"never closed, 1"), ["never closed, 1"]);
    }

    #[test]
    fn numbers_in_both_notations() {
        let (point, comma) = (Dialect::ALL[0], Dialect::ALL[5]);
        for (dialect, text, number) in [
            (point, "1.5", Some(1.5)),
            (point, "+1.5E-3", Some(1.5e-3)),
            (point, "1,5", None),
            (comma, "1,5", Some(1.5)),
            (comma, "-1,5e3", Some(-1.5e3)),
            (comma, "7", Some(7.0)),
            (comma, "1.5", None),
            (comma, "1.234,5", None),
            (comma, "1,2,3", None),
        ] {
            assert_eq!(dialect.number(text), number, "{text}");
        }
        assert_eq!(comma.kind("10:00:00,005"), Kind::Stamp);
        assert_eq!(point.kind("12V"), Kind::Text);
        assert_eq!(point.kind("nan"), Kind::Number);
    }
}
