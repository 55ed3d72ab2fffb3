//! The line of a table.toml that sets a field.

use std::fmt;

/// A line of a file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Line {
    /// Its number, from 1.
    pub number: usize,
    /// What stands there.
    pub text: String,
}

impl Line {
    /// The one line of a file's text that sets a field, which may have its table before a point; `None` where no line
    /// does, or several set one of its name.
    pub(crate) fn that_sets(field: &str, text: &str) -> Option<Self> {
        let field = field.rsplit('.').next()?;
        let key = |line: &str| line.split('=').next().is_some_and(|key| key.trim() == field) && line.contains('=');
        let heading = |line: &str| line.strip_suffix(']').is_some_and(|path| path.ends_with(&format!(".{field}")));
        let mut lines = text.lines().map(str::trim).zip(1..).filter(|(line, _)| key(line) || heading(line));
        let (line, number) = lines.next()?;
        lines.next().is_none().then(|| Self { number, text: line.to_owned() })
    }
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // A list goes on in the lines behind it.
        let rest = if self.text.ends_with('[') { "…]" } else { "" };
        write!(f, "line {}, `{}{rest}`", self.number, self.text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_one_line_that_sets_a_field_is_found() {
        let text = "a = 1\n[table]\ndeadband_v = 1e3\n[table.voltage_range_v]\nmin = 3.0\nlag_s = 1\n[b]\nlag_s = 2\nslopes = [\n1,\n]\n";
        let of = |field| Line::that_sets(field, text).map(|line| line.to_string());
        assert_eq!(of("deadband_v").as_deref(), Some("line 3, `deadband_v = 1e3`"));
        assert_eq!(of("voltage_range_v").as_deref(), Some("line 4, `[table.voltage_range_v]`"));
        assert_eq!(of("table.slopes").as_deref(), Some("line 9, `slopes = […]`"));
        assert_eq!((of("lag_s"), of("range_v"), of("band_v")), (None, None, None));
    }
}
