//! What separates the fields of a text table, found from its first line.

use super::units::Unit;

/// What stands between two fields.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Delimiter {
    Character(char),
    WhiteSpace,
}

impl Delimiter {
    const CHARACTERS: [char; 3] = ['\t', ';', ','];

    /// The delimiter that makes every field of `line` a number, else the first one that occurs in it.
    pub fn of(line: &str) -> Self {
        let present = || {
            let occurs = |c: &char| line.contains(*c);
            let characters = Self::CHARACTERS.into_iter().filter(occurs);
            characters.map(Self::Character)
        };
        let numeric = |d: &Self| d.split(line).all(|f| f.is_empty() || is_number(f));
        present().chain([Self::WhiteSpace]).find(numeric).or_else(|| present().next()).unwrap_or(Self::WhiteSpace)
    }

    /// The fields of a row, without the space and the quotation marks around them.
    pub fn split<'a>(self, line: &'a str) -> Box<dyn Iterator<Item = &'a str> + 'a> {
        match self {
            Self::Character(c) => Box::new(line.split(c).map(|field| field.trim().trim_matches('"'))),
            Self::WhiteSpace => Box::new(line.split_whitespace()),
        }
    }

    /// The names of a header, in which a quoted name may contain the delimiter.
    pub fn header(self, line: &str) -> Vec<String> {
        let Self::Character(delimiter) = self else {
            return self.split(line).map(str::to_owned).collect();
        };
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .trim(csv::Trim::All)
            .delimiter(delimiter as u8)
            .from_reader(line.as_bytes());
        match reader.records().next() {
            Some(Ok(names)) => names.iter().map(str::to_owned).collect(),
            _ => self.split(line).map(str::to_owned).collect(),
        }
    }

    /// Whether the line names a unit in every field that is not empty.
    pub fn all_units(self, line: &str) -> bool {
        let mut units = self.split(line).filter(|f| !f.is_empty()).peekable();
        units.peek().is_some() && units.all(|f| without_brackets(f).parse::<Unit>().is_ok())
    }
}

/// A unit without the brackets around it.
pub(super) fn without_brackets(unit: &str) -> &str {
    unit.trim_matches(['(', ')', '[', ']', '{', '}'])
}

/// Whether a field reads as a number, NaN and infinity included.
pub(super) fn is_number(field: &str) -> bool {
    field.parse::<f64>().is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn found_from_header_or_row() {
        for (line, found) in [
            ("t_s,u_V", Delimiter::Character(',')),
            ("t_s;y, smooth;u_V", Delimiter::Character(';')),
            ("time (s)\tu (V)", Delimiter::Character('\t')),
            ("t_s u_V", Delimiter::WhiteSpace),
            ("1.0 2.0\t3.0", Delimiter::WhiteSpace),
            ("1.0\t\t3.0", Delimiter::Character('\t')),
            ("1,2", Delimiter::Character(',')),
            ("0,5;1,5", Delimiter::Character(';')),
            ("", Delimiter::WhiteSpace),
        ] {
            assert_eq!(Delimiter::of(line), found, "{line:?}");
        }
    }

    #[test]
    fn quoted_names_may_hold_the_delimiter() {
        let names = Delimiter::Character(',').header("\"time, s\", u_V");
        assert_eq!(names, ["time, s", "u_V"]);
    }
}
