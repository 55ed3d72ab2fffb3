//! The verbs that talk to a device, where there is none, or none that answers; and what they would do to a board.

use super::{MEASURED, data, json, number, piezo, refused, refused_json, text};
use emulator::faults::messages;
use emulator::{Emulator, FaultyLine};
use estimator_core::record::VERSION;
use protocol::{Identity, Reply, ToHost};
use std::fs;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The verbs and what each needs beside a port.
const VERBS: [&[&str]; 9] = [
    &["info"],
    &["pull", "--out", "-"],
    &["erase", "--pause"],
    &["monitor", "--seconds", "1"],
    &["zero"],
    &["zero", "--over-cycle", "--at", "-3.5"],
    &["reset"],
    &["push", "tests/data/table/table.bin"],
    &["pil", "tests/data/table/table.toml", MEASURED],
];

/// A table for the primary board, in a folder.
pub fn for_the_board(folder: &Path) -> String {
    let out = folder.join("board");
    let table = data("table/table.toml");
    piezo().args(["emit", text(&table), "--adc-full-scale", "65520", "--out", text(&out)]).assert().success();
    text(&out.join("table.toml")).to_owned()
}

#[test]
fn a_port_that_is_not_there_is_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let port = folder.path().join("ttyACM7");
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let socket = format!("tcp:{free}");
    for verb in VERBS {
        refused(&[verb, &["--port", text(&port)]].concat(), &["ttyACM7", "no such port", "port"]);
        let meant = ["127.0.0.1:4740: there is no such port", "--port tcp:127.0.0.1:4740", "port"];
        refused(&[verb, &["--port", "127.0.0.1:4740"]].concat(), &meant);
        refused(&[verb, &["--port", &socket]].concat(), &[&socket, "nothing listens", "cargo xtask emulate"]);
        refused(&[verb, &["--port", "tcp:nowhere"]].concat(), &["tcp:HOST:PORT"]);
        // Never without a port: a test finds no board that is plugged in.
        let by_environment = piezo().args(verb).env("PIEZO_PORT", &port).assert().code(2).get_output().clone();
        assert!(String::from_utf8_lossy(&by_environment.stderr).contains("ttyACM7: there is no such port"));
    }
    refused(&["info", "--port", text(&data("table/table.toml"))], &["table.toml", "serial port"]);
}

#[test]
fn a_port_at_which_nobody_answers_says_what_it_may_be() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = format!("tcp:{}", listener.local_addr().unwrap());
    refused(&["info", "--port", &port], &[&port, "no answer", "piezo flash", "protocol version"]);
}

#[test]
fn a_recording_that_cannot_be_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    refused(&["record", "--out", text(&log), "--port", "tcp:127.0.0.1:1"], &["tcp:127.0.0.1:1"]);
    refused(&["record", "--out", text(folder.path()), "--port", "tcp:127.0.0.1:1"], &["folder"]);
    let both = ["--seconds", "1", "--samples", "1"];
    refused(&[&["record", "--out", text(&log), "--port", "tcp:127.0.0.1:1"], &both[..]].concat(), &["--samples"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn a_table_that_cannot_be_is_refused_before_the_port_is_opened() {
    let folder = tempfile::tempdir().unwrap();
    let mut record = fs::read(data("table/table.bin")).unwrap();
    record[50] ^= 4;
    let corrupt = folder.path().join("corrupt.bin");
    fs::write(&corrupt, record).unwrap();
    let port = ["--port", "tcp:127.0.0.1:1"];
    refused(&[&["push", text(&corrupt)], &port[..]].concat(), &["corrupt.bin", "refused"]);
    refused(&[&["push", "nowhere.bin"], &port[..]].concat(), &["nowhere.bin"]);
    refused(&[&["push", MEASURED], &port[..]].concat(), &["picma", "no table.toml"]);
    refused(&[&["pil", "tests/data/table/table.toml"], &port[..]].concat(), &["log"]);
    refused(&[&["pil", MEASURED, MEASURED], &port[..]].concat(), &["same bytes"]);
    refused(&["flash", "--table", text(&corrupt), "--dry-run"], &["corrupt.bin", "refused"]);
}

#[test]
fn flash_shows_the_commands_it_would_run() {
    let folder = tempfile::tempdir().unwrap();
    let table = for_the_board(folder.path());
    let plan = refused_json(piezo().args(["flash", "--table", &table, "--probe", "0483:374e", "--dry-run", "--json"]));
    assert_eq!(
        plan["commands"],
        serde_json::json!([
            "probe-rs download --non-interactive --chip STM32G474RETx --probe 0483:374e --verify --binary-format bin \
             --base-address 0x0807f000 parameter-pages.bin",
            "probe-rs reset --non-interactive --chip STM32G474RETx --probe 0483:374e",
        ])
    );
    assert_eq!(plan["written"], false);
    let sentences = |list: &str| plan[list].to_string();
    assert!(sentences("doubts").contains("single amplitude") && sentences("refused").contains("--doubted"), "{plan}");
    let elsewhere = ["--parameters-at", "0x0803f000", "--chip", "STM32G431RBTx"];
    let plan = refused_json(piezo().args(["flash", "--table", &table, "--dry-run", "--json"]).args(elsewhere));
    assert_eq!(plan["refused"].as_array().unwrap().len(), 1);
    let may = json(piezo().args(["flash", "--table", &table, "--dry-run", "--json", "--doubted"]));
    assert!(may["doubts"] == plan["doubts"] && may["refused"].as_array().unwrap().is_empty(), "{may}");
    let command = plan["commands"][0].as_str().unwrap();
    assert!(command.contains("--base-address 0x0803f000") && command.contains("STM32G431RBTx"), "{command}");
}

#[test]
fn flash_refuses_what_does_not_fit_the_board() {
    refused(&["flash"], &["--image", "--table"]);
    let table = "tests/data/table/table.toml";
    refused(&["flash", "--table", table, "--dry-run"], &[table, "--adc-full-scale 65520"]);
    refused(&["flash", "--image", table, "--dry-run"], &[table, "ELF", "cargo fw"]);
    refused(&["flash", "--image", "nowhere.elf", "--dry-run"], &["nowhere.elf"]);
    let folder = tempfile::tempdir().unwrap();
    let table = for_the_board(folder.path());
    for at in ["0x0807f001", "soon", "0xfffff800"] {
        refused(&["flash", "--table", &table, "--parameters-at", at, "--dry-run"], &["--parameters-at"]);
    }
}

/// With a program of that name that writes down what it is told.
#[cfg(unix)]
#[test]
fn flash_hands_the_parameter_pages_to_probe_rs_and_says_when_that_fails() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let table = for_the_board(folder.path());
    let flash = |script: Option<&str>| {
        let programs = folder.path().join("bin");
        fs::create_dir_all(&programs).unwrap();
        if let Some(script) = script {
            let program = programs.join("probe-rs");
            fs::write(&program, format!("#!/bin/sh\nPATH=/bin:/usr/bin\ncd '{}'\n{script}\n", folder.path().display()))
                .unwrap();
            fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
        }
        let mut command = piezo();
        command.args(["flash", "--doubted", "--table", &table]).env("PATH", &programs);
        command.assert()
    };
    let complaint = |output: &std::process::Output| String::from_utf8_lossy(&output.stderr).into_owned();

    let missing = complaint(flash(None).code(2).get_output());
    assert!(missing.contains("cargo install probe-rs-tools"), "{missing}");
    let failed = complaint(flash(Some("echo No probe was found >&2; exit 1")).code(2).get_output());
    for part in ["No probe was found", "probe-rs list", "udev"] {
        assert!(failed.contains(part), "{part:?} is missing in {failed}");
    }
    // The last argument of the first command is the file.
    flash(Some("echo \"$@\" >> told; for last; do :; done; [ -f \"$last\" ] && cp \"$last\" pages; true")).success();
    let told = fs::read_to_string(folder.path().join("told")).unwrap();
    assert_eq!(told.lines().map(|line| line.split(' ').next().unwrap()).collect::<Vec<_>>(), ["download", "reset"]);
    let pages = fs::read(folder.path().join("pages")).unwrap();
    let record = fs::read(Path::new(&table).with_file_name("table.bin")).unwrap();
    assert_eq!(pages.len(), 4096);
    assert!(pages.windows(record.len()).any(|bytes| bytes == record), "the record is not in the pages");
}

#[test]
fn zero_calls_the_displacement_of_now_or_the_mean_over_a_cycle_what_is_known() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let port = format!("tcp:{}", device.address());
    let zero = |options: &[&str]| json(piezo().args(["zero", "--json", "--port", &port]).args(options));
    let said = |verb: &str| {
        let output = piezo().args([verb, "--port", &port]).assert().success().get_output().stdout.clone();
        String::from_utf8(output).unwrap()
    };
    assert!(said("info").contains("never zeroed since the estimate began"));

    let over = zero(&["--over-cycle", "--at", "-2.5", "--seconds", "20"]);
    // The triangle's period.
    assert_eq!(number(&over, "/cycle/seconds"), 1.0);
    assert!((number(&over, "/bias_um") - (-2.5 - number(&over, "/cycle/mean_um"))).abs() < 1e-4, "{over}");
    assert!(said("info").contains(&format!("ago, bias {:+.3} µm", number(&over, "/bias_um"))));
    let again = zero(&["--over-cycle", "--at", "-2.5"]);
    assert!((number(&again, "/cycle/mean_um") + 2.5).abs() < 0.5, "the mean is what it was called: {again}");

    let now = zero(&["--at", "7"]);
    assert!(now["cycle"].is_null() && number(&now, "/bias_um") != number(&again, "/bias_um"), "{now}");
    let text = said("zero");
    assert!(text.contains("called 0 µm") && text.contains("zeroed 0 s ago, bias"), "{text}");

    let zero = |options: &[&str], says: &[&str]| refused(&[&["zero", "--port", &port], options].concat(), says);
    zero(&["--at", "1e5"], &["the device refuses", "span of its table's limits", "give µm"]);
    zero(&["--at", "nan"], &["--at", "finite"]);
    zero(&["--seconds", "5"], &["--over-cycle"]);
    let short = ["--over-cycle", "--seconds", "0.2"];
    zero(&short, &["nothing was changed on the device", "no full cycle within 0.2 s", "--at"]);
}

/// What `push` says of a table where the device says to be another.
fn pushed(table: &str, other: impl Fn(Identity) -> Identity + Send + 'static) -> String {
    let device = Emulator::new().start().unwrap();
    let told = messages(move |message| match message {
        ToHost::Reply { to, reply: Reply::Identity(of) } => {
            Some(ToHost::Reply { to, reply: Reply::Identity(other(of)) })
        }
        message => Some(message),
    });
    let line = FaultyLine::to(device.address(), told).unwrap();
    refused(&["push", table, "--doubted", "--port", &format!("tcp:{}", line.address())], &[])
}

#[test]
fn what_does_not_fit_is_refused_with_the_command_that_makes_it_fit() {
    let folder = tempfile::tempdir().unwrap();
    let table = for_the_board(folder.path());
    let converters = pushed(&table, |of| Identity { adc_full_scale: 4095, dac_full_scale: 1023, ..of });
    let command = format!("piezo emit {table} --adc-full-scale 4095 --dac-full-scale 1023");
    assert!(converters.contains(&command), "{converters}");
    let alone = folder.path().join("alone.bin");
    fs::copy(Path::new(&table).with_extension("bin"), &alone).unwrap();
    let converters = pushed(alone.to_str().unwrap(), |of| Identity { adc_full_scale: 4095, ..of });
    assert!(
        converters.contains("piezo emit <TABLE>.toml --adc-full-scale 4095"),
        "no other face is there: {converters}"
    );
    let ticks = pushed(&table, |of| Identity { tick_us: 100, ..of });
    assert!(ticks.contains(&format!("piezo emit {table} --tick-us 100 --out FOLDER")), "{ticks}");
    let other = folder.path().join("other").display().to_string();
    piezo().args(["emit", &table, "--tick-us", "100", "--out", &other]).assert().success();
    let brought = fs::read_to_string(format!("{other}/table.toml")).unwrap();
    assert!(brought.contains("sample_period_us = 100\n") && brought.contains("tick_us = 100\n"), "{brought}");
    let bound = ["emit", "tests/data/table/models/duhem.toml", "--tick-us", "100", "--out", &other];
    assert!(refused(&bound, &[]).contains("identify with --tick-us 100"));
    let newer = pushed(&table, |of| Identity { record_version: of.record_version + 1, ..of });
    assert!(newer.contains(&format!("writes format {VERSION}")), "{newer}");
    let estimating = pushed(&table, |of| of);
    assert!(estimating.contains("--pause") && estimating.contains("--while-estimating"), "{estimating}");
}

/// As of `monitor | head -1`: nothing is left that holds the port.
#[test]
fn monitor_ends_when_nobody_reads_it_any_more() {
    let device = Emulator::new().start().unwrap();
    let mut monitor = Command::new(env!("CARGO_BIN_EXE_piezo"))
        .args(["monitor", "--port", &format!("tcp:{}", device.address())])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(monitor.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let start = Instant::now();
    let status = loop {
        if let Some(status) = monitor.try_wait().unwrap() {
            break status;
        }
        assert!(start.elapsed() < Duration::from_secs(30), "it goes on, unread");
        std::thread::sleep(Duration::from_millis(50));
    };
    assert!(status.success() && !line.is_empty(), "{status}: {line}");
}
