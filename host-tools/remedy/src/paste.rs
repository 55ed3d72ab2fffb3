//! The command that was typed, with other options: a line to be pasted.

use std::path::{Path, PathBuf};

/// Whether this verb was typed.
pub fn verb(name: &str) -> bool {
    std::env::args_os().nth(1).is_some_and(|verb| verb == name)
}

/// The command on a line of its own, with these options in place of those of the same name; one with an empty
/// value is left out. Of several logs that are looked at only `refused` is left: what is said of it need not hold
/// for the others.
pub fn with(refused: &Path, options: &[(&str, &str)]) -> String {
    // What is no text is shown as well as it can be.
    let typed = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect();
    format!("\n    {}", command(&alone(typed, refused), options))
}

/// The arguments of `look` without the logs other than `refused`; those of any other verb.
fn alone(typed: Vec<String>, refused: &Path) -> Vec<String> {
    if typed.first().is_none_or(|verb| verb != "look") {
        return typed;
    }
    let takes_value = |word: &String| word.starts_with("--") && !word.contains('=') && word != "--json" && word != "--";
    let is_other = |at: usize| {
        let path = Path::new(&typed[at]);
        at > 0 && !takes_value(&typed[at - 1]) && path != refused && path.is_file()
    };
    (0..typed.len()).filter(|&at| !is_other(at)).map(|at| typed[at].clone()).collect()
}

/// The command on a line of its own, with this flag besides; of `learn`, which hands on to `identify` what stands
/// behind `--`, there.
pub fn with_flag(flag: &str) -> String {
    let typed = std::env::args_os().skip(1).map(|argument| argument.to_string_lossy().into_owned()).collect();
    format!("\n    {}", command(&flagged(typed, flag), &[]))
}

fn flagged(mut typed: Vec<String>, flag: &str) -> Vec<String> {
    let behind = typed.iter().position(|argument| argument == "--");
    let learns = typed.first().is_some_and(|verb| verb == "learn");
    if typed.iter().any(|argument| argument == flag) {
        return typed;
    }
    match behind {
        Some(at) if !learns => typed.insert(at, flag.to_owned()),
        None if learns => typed.extend(["--".to_owned(), flag.to_owned()]),
        _ => typed.push(flag.to_owned()),
    }
    typed
}

fn command(typed: &[String], options: &[(&str, &str)]) -> String {
    let mut words = vec!["piezo".to_owned()];
    // What stands behind `--` is no option.
    let end = typed.iter().position(|argument| argument == "--").unwrap_or(typed.len());
    let (before, behind) = typed.split_at(end);
    let mut arguments = before.iter();
    while let Some(argument) = arguments.next() {
        let replaced = options.iter().find_map(|(name, _)| argument.strip_prefix(name));
        match replaced {
            Some("") => drop(arguments.next()),
            Some(rest) if rest.starts_with('=') => {}
            _ => words.push(quoted(argument)),
        }
    }
    let given = options.iter().filter(|(_, value)| !value.is_empty());
    words.extend(given.flat_map(|(name, value)| [(*name).to_owned(), quoted(value)]));
    words.extend(behind.iter().map(|argument| quoted(argument)));
    words.join(" ")
}

/// The command that identifies a table from logs, read as they were here; `flawed` where they hold what is no
/// measurement and can be left out.
pub fn learn_from(logs: &[PathBuf], flawed: bool) -> String {
    let options: String = ["--columns", "--sensor", "--fs"].into_iter().map(typed).collect();
    let stem = logs.first().and_then(|log| log.file_stem()).unwrap_or_default().to_string_lossy();
    let out = quoted(&format!("out/{stem}"));
    format!(
        "piezo identify {}{options} --out {out}{}",
        logs.iter().map(|path| log(&path.to_string_lossy())).collect::<Vec<_>>().join(" "),
        if flawed { " --repair" } else { "" }
    )
}

/// A log's name among the arguments, where one that begins with a hyphen is no option.
pub fn log(name: &str) -> String {
    if name.starts_with('-') { quoted(&format!("./{name}")) } else { quoted(name) }
}

/// An option that was typed, with its value, behind a blank; nothing where it was not.
pub fn typed(option: &str) -> String {
    value(option).map_or(String::new(), |value| format!(" {option} {}", quoted(&value)))
}

/// The value of an option that was typed.
pub fn value(option: &str) -> Option<String> {
    let words: Vec<String> = std::env::args_os().map(|argument| argument.to_string_lossy().into_owned()).collect();
    stated(&words, option).map(str::to_owned)
}

fn stated<'w>(words: &'w [String], option: &str) -> Option<&'w str> {
    words.iter().enumerate().find_map(|(at, word)| match word.strip_prefix(option)? {
        "" => words.get(at + 1).map(String::as_str),
        rest => rest.strip_prefix('='),
    })
}

/// An argument as a shell takes it.
pub fn quoted(argument: &str) -> String {
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
        assert_eq!(stated(&typed(&["train", "--board", "b.toml"]), "--board"), Some("b.toml"));
        assert_eq!(stated(&typed(&["train", "--boards=a", "--board=b.toml"]), "--board"), Some("b.toml"));
        assert_eq!(quoted("it's"), r"'it'\''s'");
        let behind = typed(&["look", "--fs", "9", "--", "-97.csv", "--fs"]);
        let columns = ("--columns", "voltage=2:V");
        assert_eq!(command(&behind, &[columns, ("--fs", "")]), "piezo look --columns voltage=2:V -- -97.csv --fs");
    }

    #[test]
    fn a_flag_stands_before_what_is_no_option_and_behind_it_where_identify_is_told_of_it() {
        let typed = |words: &str| words.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let with = |words: &str| flagged(typed(words), "--repair").join(" ");
        assert_eq!(with("identify a.csv --out o"), "identify a.csv --out o --repair");
        assert_eq!(with("identify --out o -- -9.csv"), "identify --out o --repair -- -9.csv");
        assert_eq!(with("identify --repair a.csv --out o"), "identify --repair a.csv --out o");
        assert_eq!(with("learn --out o"), "learn --out o -- --repair");
        assert_eq!(with("learn --out o -- --model voigt"), "learn --out o -- --model voigt --repair");
    }

    #[test]
    fn a_remedy_is_for_the_refused_log_alone() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second, out] = ["a.csv", "b.csv", "out.html"].map(|name| {
            let path = folder.path().join(name);
            std::fs::write(&path, "").unwrap();
            path.to_str().unwrap().to_owned()
        });
        let typed = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
        let look = typed(&["look", "--json", &first, &second, "--out", &out]);
        assert_eq!(alone(look, Path::new(&second)), ["look", "--json", &*second, "--out", &*out]);
        let identify = typed(&["identify", &first, &second]);
        assert_eq!(alone(identify.clone(), Path::new(&second)), identify, "fewer logs would be another identification");
    }
}
