//! The changelog's entries, by the line that each ends with: whether what is stored or sent is another than before.

/// What the line says of, together or one after the other.
const TOGETHER: &str = "on-flash / on-wire format changed: ";
const ON_FLASH: &str = "on-flash format changed: ";
const ON_WIRE: &str = "; on-wire format changed: ";

/// Entries without a line that says yes or no of both formats, and those whose yes does not say what is new.
pub fn without_format(text: &str) -> Vec<String> {
    // What follows a line goes on with it.
    let silent = |(_, lines): &(usize, Vec<&str>)| !(1..lines.len()).any(|at| says_of_formats(&lines[at..].join(" ")));
    let words = |(number, lines): (usize, Vec<&str>)| {
        let beginning: String = lines[0].chars().take(60).collect();
        format!(
            "CHANGELOG.md:{number}: \"{beginning}…\" does not end with `{TOGETHER}no`, or `yes (…)` with what becomes of records and devices"
        )
    };
    entries(text).into_iter().filter(silent).map(words).collect()
}

/// The lines of each entry, without their indent, and the number of its first.
fn entries(text: &str) -> Vec<(usize, Vec<&str>)> {
    let mut entries: Vec<(usize, Vec<&str>)> = Vec::new();
    let mut within = false;
    for (number, line) in (1..).zip(text.lines()) {
        if line.starts_with("- ") {
            entries.push((number, vec![line]));
            within = true;
        } else if let (true, Some(line)) = (within, line.strip_prefix("  ")) {
            entries.last_mut().into_iter().for_each(|(_, lines)| lines.push(line));
        } else {
            within = false;
        }
    }
    entries
}

/// Whether an entry's end says of both formats whether they changed.
fn says_of_formats(end: &str) -> bool {
    if let Some(both) = end.strip_prefix(TOGETHER) {
        return says(both);
    }
    let one_by_one = end.strip_prefix(ON_FLASH).and_then(|said| said.split_once(ON_WIRE));
    one_by_one.is_some_and(|(flash, wire)| says(flash) && says(wire))
}

/// A no, with or without its reason, or a yes with what is new.
fn says(said: &str) -> bool {
    said == "no" || said.starts_with("no (") || said.starts_with("yes (")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_that_says_nothing_of_the_formats_is_named_by_its_line() {
        let text = "# Changelog\n\n- one\n  goes on\n  on-flash / on-wire format changed: no\n- two\n  goes on\n- three\n  \
                    on-flash format changed: no;\n  on-wire format changed: yes (version 2)\n\n### Removed\n  \
                    on-flash / on-wire format changed: no\n\n- four\n";
        let found = without_format(text);
        let places: Vec<_> = found.iter().filter_map(|said| said.split(' ').next()).collect();
        assert_eq!(places, ["CHANGELOG.md:6:", "CHANGELOG.md:15:"]);
    }

    #[test]
    fn a_yes_says_what_is_new_and_a_format_that_is_left_out_is_missed() {
        for said in ["- a\n  on-flash / on-wire format changed: yes", "- a\n  on-flash format changed: no"] {
            assert_eq!(without_format(said).len(), 1, "{said}");
        }
    }
}
