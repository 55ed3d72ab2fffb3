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
