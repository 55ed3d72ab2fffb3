//! Sessions that are whole, and those of which something is missing.

use super::*;
use result_files::Held;

#[test]
fn what_is_missing_of_a_session_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    let of = |planned: &str, logs: &[(&str, bool)]| {
        let log = |(name, complete): &(&str, bool)| {
            let held_out = *name == "held-out";
            format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {held_out}\ncomplete = {complete}\n")
        };
        let logs: String = logs.iter().map(log).collect();
        std::fs::write(folder.path().join(SESSION), format!("complete = false\nseed = 1\n{planned}{logs}")).unwrap();
        session(folder.path()).unwrap().unfinished.map(|unfinished| unfinished.to_string())
    };
    let all = [("01-rest", true), ("held-out", true)];
    assert_eq!(of("planned = 2\n", &all), None, "it did not come home, and all of it is there");
    assert_eq!(of("", &all), None, "one of before");
    let said = of("planned = 8\n", &[("01-rest", true), ("02-loops", false)]).unwrap();
    assert!(said.contains("2 of 8 logs are there, 02-loops.csv cut short, none to prove with among them"), "{said}");
    let said = of("planned = 2\n", &[("01-rest", true), ("held-out", false)]).unwrap();
    let whole = "2 of 2 logs are there, held-out.csv cut short; what is missing is not learnt";
    assert!(said.ends_with(whole), "{said}");
    let said = of("", &[("01-rest", true), ("held-out", false)]).unwrap();
    assert!(said.contains("2 logs are there, held-out.csv cut short;"), "{said}");
}

#[test]
fn what_a_killed_session_left_is_counted_in_its_logs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let names = ["01-rest", "02-loops", "03-stairs", "held-out"];
    let log = |name: &&str| {
        format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {}\ncomplete = false\nrows = 500\n", *name == "held-out")
    };
    let logs: String = names.iter().map(log).collect();
    std::fs::write(folder.join(SESSION), format!("complete = false\nseed = 1\nplanned = 4\nunder_way = true\n{logs}"))
        .unwrap();
    let left = |rows: &[usize]| {
        for (name, rows) in names.iter().zip(rows) {
            std::fs::write(folder.join(name).with_extension("csv"), "0,0,0\n".repeat(rows + 1)).unwrap();
        }
        let Session { complete, logs, held_out, unfinished, .. } = session(folder).unwrap();
        assert!(!complete);
        (logs.len(), held_out.len(), unfinished.map(|of| of.to_string()).unwrap_or_default())
    };
    let (logs, held_out, said) = left(&[502, 400]);
    assert!(
        (logs, held_out) == (2, 0) && said.contains("2 of 4 logs are there, 02-loops.csv cut short, none to"),
        "{said}"
    );
    // While a program holds the folder, it is under way.
    let held = Held::of(folder).unwrap();
    let (logs, _, said) = left(&[502, 400]);
    let begun = "the session is still being recorded: 2 of 4 logs are there so far, 02-loops.csv cut short, none to";
    assert!(logs == 2 && said.starts_with(begun), "{said}");
    let mut logs = vec![folder.to_owned()];
    left(&[3, 3]);
    let none = open_session(&mut logs, &mut Vec::new(), false, &mut None, None).unwrap_err();
    assert!(std::error::Error::source(&none).unwrap().to_string().contains("no log to learn from yet: wait"));
    drop(held);
    // One that had hardly begun is none.
    let (logs, _, said) = left(&[502, 500, 99]);
    assert!(logs == 2 && said.contains("2 of 4 logs are there, none to"), "{said}");
    assert_eq!(left(&[502, 500, 500, 501]), (3, 1, String::new()), "killed once all of it was there");
}

#[test]
fn rows_that_a_whole_session_has_lost_are_missed() {
    let folder = tempfile::tempdir().unwrap();
    let log = "[[logs]]\nlog = \"01-rest.csv\"\nheld_out = true\ncomplete = true\nrows = 300\n";
    std::fs::write(folder.path().join(SESSION), format!("complete = true\nseed = 1\nplanned = 1\n{log}")).unwrap();
    let with = |rows: usize| {
        std::fs::write(folder.path().join("01-rest.csv"), "0,0,0\n".repeat(rows + 1)).unwrap();
        session(folder.path()).unwrap().unfinished.map(|of| of.to_string())
    };
    assert_eq!(with(300), None);
    std::fs::write(folder.path().join("01-rest.csv"), "0,0,0\n".repeat(301).trim_end()).unwrap();
    assert!(session(folder.path()).unwrap().unfinished.is_none(), "the last line has no end");
    assert!(with(2).unwrap().contains("01-rest.csv cut short"), "hardly anything is left");
    let said = with(299).unwrap();
    assert!(said.contains("has lost rows since it was recorded: 1 of 1 logs are there, 01-rest.csv cut"), "{said}");
}

#[test]
fn a_session_s_folder_stands_for_its_logs() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let opened = |held_out: &[PathBuf], else_held_out: bool, tick_us: Option<u32>| {
        let (mut logs, mut held_out, mut tick_us) = (vec![folder.to_owned()], held_out.to_vec(), tick_us);
        open_session(&mut logs, &mut held_out, else_held_out, &mut tick_us, None).map(|_| (logs, held_out, tick_us))
    };
    let as_it_is = (vec![folder.to_owned()], Vec::new(), None);
    assert_eq!(opened(&[], false, None).unwrap(), as_it_is, "no session's");
    let logs =
        "[[logs]]\nlog = \"a/01-rest.csv\"\nheld_out = false\n[[logs]]\nlog = \"a/held-out.csv\"\nheld_out = true\n";
    std::fs::write(folder.join(SESSION), format!("complete = true\nseed = 1\ntick_us = 250\n{logs}")).unwrap();
    let learnt = vec![folder.join("01-rest.csv")];
    let proves = vec![folder.join("held-out.csv")];
    let other = vec![PathBuf::from("other.csv")];
    assert_eq!(opened(&[], false, None).unwrap(), (learnt.clone(), proves, Some(250)));
    // What is stated counts, the usual tick, too.
    assert_eq!(opened(&[], true, Some(500)).unwrap(), (learnt.clone(), Vec::new(), Some(500)));
    assert_eq!(opened(&other, false, None).unwrap(), (learnt, other, Some(250)));
    let by = |adc: &str, sensor: &str| format!("[board]\nadc_span = {adc}\nsensor_span = {sensor}\n{logs}");
    let recorded = format!("complete = true\nseed = 1\n{}", by("[-35.0, 135.0]", "[-5.0, 25.0]"));
    std::fs::write(folder.join(SESSION), recorded).unwrap();
    let board = folder.join("board.toml");
    let by_board = |text: &str| {
        std::fs::write(&board, text).unwrap();
        open_session(&mut vec![folder.to_owned()], &mut Vec::new(), false, &mut None, Some(&board)).map(|_| ())
    };
    by_board("adc_span = [-35.0, 135.0]").unwrap();
    let calibrated = by_board("adc_span = [-35.0, 135.0]\nsensor_span = [-5.1, 25.0]").unwrap_err().to_string();
    assert!(calibrated.contains("recorded with sensor_span = [-5, 25], and "), "{calibrated}");
    assert!(matches!(by_board("adc_span = [-36.0, 135.0]"), Err(BenchError::Recalibrated { what: "adc_span", .. })));
    std::fs::write(folder.join(SESSION), "nothing").unwrap();
    assert!(matches!(opened(&[], false, None), Err(BenchError::Log { .. })));
}
