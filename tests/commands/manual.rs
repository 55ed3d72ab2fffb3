//! What a package installs beside the program: completions and the manual's pages.

use super::{piezo, refused, text};
use std::fs;

/// The verbs, as `--help` lists them.
fn verbs() -> Vec<String> {
    let help = piezo().arg("--help").assert().success().get_output().stdout.clone();
    let help = String::from_utf8(help).unwrap();
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let first = |line: &str| line.strip_prefix("  ").and_then(|line| line.split(' ').next()).unwrap_or("").to_owned();
    listed.map(first).filter(|verb| !verb.is_empty() && verb != "help").collect()
}

#[test]
fn every_verb_is_completed() {
    let verbs = verbs();
    assert!(verbs.len() > 20 && verbs.contains(&"identify".to_owned()), "{verbs:?}");
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = piezo().args(["completions", shell]).assert().success().get_output().stdout.clone();
        let script = String::from_utf8(script).unwrap();
        for word in verbs.iter().map(String::as_str).chain(["validate-on"]) {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    refused(&["completions", "sh"], &["invalid value 'sh'", "bash"]);
}

#[test]
fn every_verb_has_a_page_that_is_renewed_and_writes_over_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let write = || piezo().args(["man", "--out", text(folder.path())]).assert().success();
    write();
    for verb in verbs() {
        let page = fs::read_to_string(folder.path().join(format!("piezo-{verb}.1"))).unwrap();
        assert!(page.contains("SYNOPSIS") && page.contains(&verb), "{page}");
    }
    write();
    let strangers = folder.path().join("piezo-identify.1");
    fs::write(&strangers, "a page of somebody else's").unwrap();
    refused(&["man", "--out", text(folder.path())], &["piezo-identify.1: is there already", "--force"]);
    assert_eq!(fs::read_to_string(&strangers).unwrap(), "a page of somebody else's");
}

/// Under which headings the long help of a verb has its options.
fn headings(verb: &str) -> Vec<(String, Vec<String>)> {
    let help = piezo().args([verb, "--help"]).assert().success().get_output().stdout.clone();
    let help = String::from_utf8(help).unwrap();
    let mut headings: Vec<(String, Vec<String>)> = Vec::new();
    for line in help.lines().take_while(|line| *line != "Examples:") {
        let option = line.trim_start().trim_start_matches("-h, ").strip_prefix("--");
        if let Some(heading) = line.strip_suffix(':').filter(|_| !line.starts_with(' ')) {
            headings.push((heading.to_owned(), Vec::new()));
        } else if let (Some(option), Some((_, options))) = (option, headings.last_mut())
            && line.len() - line.trim_start().len() <= 6
        {
            options.extend(option.split([' ', '=']).next().map(str::to_owned));
        }
    }
    headings
}

#[test]
fn every_option_stands_under_a_heading_that_is_its_own() {
    let own = [
        ("What is minimised, and", "cost norm feedback-weight scheme deadband limit lag"),
        ("Log files", "columns sensor fs"),
        (
            "Preparation of the logs",
            "tick-us displacement-scale voltage-zero displacement-zero delay max-delay skip-start skip-end decimate",
        ),
        ("Calibration of the target", "board adc-span adc-full-scale amplifier-slew dac-span dac-full-scale"),
        ("Where the DAC drives the amplifier", "drive-span drive-slew drive-range drive-rest setpoint-span linearise"),
        ("The interval beside", "devices"),
        ("A fleet of units", "unit if-changed"),
        ("What is scored", "from to zero-at"),
        ("The voltages", "range up-to seed"),
        (
            "Genetic algorithm",
            "ranges bits population generations rounds shrink patience mutation selection elitism start",
        ),
        ("Search of the other models", "optimiser evaluations"),
        ("Any search", "seed"),
    ];
    let mut seen = 0;
    for verb in verbs() {
        for (heading, options) in headings(&verb) {
            let Some((_, known)) = own.iter().find(|(own, _)| heading.starts_with(own)) else {
                assert!(["Options", "Arguments", "Commands"].contains(&&*heading), "{verb}: {heading}");
                continue;
            };
            seen += 1;
            for option in options {
                assert!(known.split(' ').any(|known| known == option), "{verb}: --{option} stands under {heading:?}");
            }
        }
    }
    assert!(seen > 20, "{seen} headings");
}
