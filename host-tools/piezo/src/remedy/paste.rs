//! The command that was typed, with other options: a line to be pasted.

use std::ffi::OsString;

/// The command on a line of its own, with these options in place of those of the same name.
pub fn with(options: &[(&str, &str)]) -> String {
    let typed: Vec<String> = std::env::args_os().skip(1).map(|argument| lossless(&argument)).collect();
    format!("\n    {}", command(&typed, options))
}

/// An argument as text; what is no text is shown as well as it can be.
fn lossless(argument: &OsString) -> String {
    argument.to_string_lossy().into_owned()
}

fn command(typed: &[String], options: &[(&str, &str)]) -> String {
    let mut words = vec!["piezo".to_owned()];
    let mut arguments = typed.iter().peekable();
    while let Some(argument) = arguments.next() {
        let replaced = options.iter().find_map(|(name, _)| argument.strip_prefix(name));
        match replaced {
            Some("") => drop(arguments.next()),
            Some(rest) if rest.starts_with('=') => {}
            _ => words.push(quoted(argument)),
        }
    }
    words.extend(options.iter().flat_map(|(name, value)| [(*name).to_owned(), quoted(value)]));
    words.join(" ")
}

/// An argument as a shell takes it.
fn quoted(argument: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=,+@%µ".contains(c);
    match argument.chars().all(plain) && !argument.is_empty() {
        true => argument.to_owned(),
        false => format!("'{}'", argument.replace('\'', r"'\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_are_added_or_replaced_and_quoted() {
        let typed = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let plain = typed(&["identify", "day 1/a.csv", "--out", "out/a"]);
        assert_eq!(command(&plain, &[("--fs", "<HZ>")]), "piezo identify 'day 1/a.csv' --out out/a --fs '<HZ>'");
        for stated in [&["validate", "--columns", "v=1", "t.toml"][..], &["validate", "--columns=v=1", "t.toml"]] {
            assert_eq!(
                command(&typed(stated), &[("--columns", "voltage=2:V")]),
                "piezo validate t.toml --columns voltage=2:V"
            );
        }
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
