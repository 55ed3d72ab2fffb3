//! What a log is refused with ends in options that read it.

use super::{piezo, text};
use std::fs;

/// What `look` says about a log of this text, read as stated.
fn refused(contents: &str, columns: &str, sample_rate: Option<f64>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, contents).unwrap();
    let mut command = piezo();
    command.args(["look", text(&path)]);
    command.args((!columns.is_empty()).then_some(["--columns", columns]).into_iter().flatten());
    command.args(sample_rate.into_iter().flat_map(|rate| ["--fs".to_owned(), rate.to_string()]));
    said(command)
}

/// What a command that is refused says.
fn said(mut command: assert_cmd::Command) -> String {
    let output = command.assert().code(2).get_output().clone();
    String::from_utf8(output.stderr).unwrap().trim_end().to_owned()
}

fn table(columns: usize) -> String {
    let row = |k: i32| (0..columns).map(|c| format!("{}", k * (c as i32 + 1))).collect::<Vec<_>>().join(" ");
    (0..20).map(|k| row(k) + "\n").collect()
}

#[test]
fn a_log_without_a_header_is_told_the_options_that_read_it() {
    let three = refused(&table(3), "", None);
    assert!(three.ends_with(" --columns time=1:s,voltage=2:V,displacement=3:um"), "{three}");
    let two = refused("5 1\n3 2\n".repeat(10).as_str(), "", None);
    assert!(two.ends_with(" --columns voltage=1:V,displacement=2:um --fs '<HZ>'"), "{two}");
    let mut look = piezo();
    look.args(["look", "tests/data/picma-p885-1hz/measured.dat"]);
    let text = said(look);
    assert!(text.contains("names the 7 columns"), "{text}");
    // The columns between stand still.
    assert!(text.ends_with(" --columns voltage=1:V,displacement=5:um --fs '<HZ>'"), "{text}");
    let no_time = refused(&table(3), "voltage=1,displacement=2", None);
    assert!(no_time.ends_with(" --fs '<HZ>'"), "{no_time}");
}

#[test]
fn a_unit_that_is_not_stated_is_asked_for() {
    let rows: String = (0..20).map(|k| format!("{},{k},{k}\n", f64::from(k) * 1e-3)).collect();
    let text = refused(&("# log\ntime,u_V,y_um\n".to_owned() + &rows), "", None);
    assert!(text.contains(":2: column \"time\" states no unit: state it"), "{text}");
    assert!(text.ends_with(" --columns time=1:s,voltage=2:V,displacement=3:um"), "{text}");
}

/// As a data acquisition names its channels, whatever of the others states a unit.
#[test]
fn a_channel_that_says_nothing_of_itself_may_be_a_sensor_in_volts_first() {
    let rows: String = (0..20).map(|k| format!("{},{k},{k}\n", f64::from(k) * 1e-3)).collect();
    for header in ["Time,Dev1/ai0,Dev1/ai1", "Time (s),Voltage,Dev1/ai1", "Time,Voltage (V),Dev1/ai1"] {
        let said = refused(&format!("{header}\n{rows}"), "", None);
        let options = ["'time=1:s,voltage=2:V,displacement=3:<N>um/V'", "time=1:s,voltage=2:V,displacement=3:um"];
        let [volts, length] = options.map(|columns| said.find(&format!(" --columns {columns}")));
        assert!(said.contains("with its scale for <N>") && volts.is_some() && volts < length, "{header}: {said}");
    }
}

#[test]
fn no_remedy_names_a_number_that_it_was_not_given() {
    let gcs = "# SAMPLE_TIME = 5e-3\n# NAME0 = Voltage\n# NAME1 = Position\n";
    let two = "5.5 1.25\n3.5 2.25\n".repeat(10);
    let volts = "t_s,CH1_V,CH2_V\n".to_owned() + &table(3).replace(' ', ",");
    let sensor = "t_s,u_V,sensor_V\n".to_owned() + &table(3).replace(' ', ",");
    for (text, columns, rate) in [
        (&*two, "", None),
        (&(gcs.to_owned() + &two), "", None),
        (&volts, "", None),
        (&sensor, "", None),
        (&sensor, "displacement=3", None),
    ] {
        let told = refused(text, columns, rate);
        let remedy = told.rsplit_once(": ").map_or(&*told, |(_, remedy)| remedy);
        for option in ["--fs ", "--sensor "] {
            let given = remedy.split(option).skip(1).all(|after| after.starts_with(['<', '\'', 'o']));
            assert!(given, "{told}");
        }
        assert!(!told.contains("2000"), "{told}");
    }
    let contradicted = refused(&(gcs.to_owned() + &two), "voltage=1:V,displacement=2:um", Some(750.0));
    assert!(contradicted.contains(":1: a rate of 750 Hz disagrees with the file's \"SAMPLE_TIME\""), "{contradicted}");
}
