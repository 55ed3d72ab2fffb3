//! The three faces of one table: TOML, a Rust `const` that compiles, and the binary record.

use super::{data, piezo, refused, root, text};
use estimator_core::Table;
use std::fs;
use table_files::TableFile;

/// `piezo emit --face rust` of `tests/data/table/table.toml`, compiled here.
#[path = "../data/table/table.rs"]
#[rustfmt::skip]
#[allow(clippy::excessive_precision, clippy::unreadable_literal, reason = "as the tool prints it")]
mod committed;

/// The same of the generalised Prandtl–Ishlinskii model, with a drive.
#[path = "../data/table/generalised-prandtl-ishlinskii/table.rs"]
#[rustfmt::skip]
#[allow(clippy::excessive_precision, clippy::unreadable_literal, reason = "as the tool prints it")]
mod driving;

const TABLE: &str = "tests/data/table/table.toml";

#[test]
fn the_rust_const_compiles_and_equals_the_toml() {
    let (_, admitted) = TableFile::load(&data("table/table.toml")).unwrap();
    assert_eq!(committed::TABLE, *admitted);
}

#[test]
fn a_driving_table_s_const_compiles_and_equals_the_toml() {
    let (_, admitted) = TableFile::load(&data("table/generalised-prandtl-ishlinskii/table.toml")).unwrap();
    assert!(admitted.drive.is_some());
    assert_eq!(driving::TABLE, *admitted);
    let table = "tests/data/table/generalised-prandtl-ishlinskii/table.toml";
    let printed = piezo().args(["emit", table, "--face", "rust"]).assert().success();
    let committed = fs::read(data("table/generalised-prandtl-ishlinskii/table.rs")).unwrap();
    assert_eq!(printed.get_output().stdout.trim_ascii_end(), committed.trim_ascii_end());
}

#[test]
fn what_is_compiled_here_is_what_the_tool_writes() {
    let printed = piezo().args(["emit", TABLE, "--face", "rust"]).assert().success().get_output().stdout.clone();
    let committed = fs::read(data("table/table.rs")).unwrap();
    assert!(
        printed.trim_ascii_end() == committed.trim_ascii_end(),
        "make it again: piezo emit {TABLE} --out tests/data/table"
    );
}

#[test]
fn the_firmware_s_table_is_what_the_tool_writes() {
    let options = ["--adc-full-scale", "65520", "--dac-span", "-8:52"];
    let emit = piezo().args(["emit", TABLE, "--face", "rust"]).args(options).assert().success();
    let committed = fs::read(data("../../firmware/src/table.rs")).unwrap();
    assert!(
        emit.get_output().stdout.trim_ascii_end() == committed.trim_ascii_end(),
        "make it again: piezo emit {TABLE} {} --face rust > firmware/src/table.rs",
        options.join(" ")
    );
}

#[test]
fn the_record_equals_the_toml_and_toml_is_a_fixed_point() {
    let (file, admitted) = TableFile::load(&data("table/table.toml")).unwrap();
    let record = piezo().args(["emit", TABLE, "--face", "binary"]).assert().success().get_output().stdout.clone();
    assert_eq!(Table::parse(&record).unwrap(), admitted);
    assert_eq!(record, fs::read(data("table/table.bin")).unwrap());
    assert_eq!(file.to_toml().unwrap(), fs::read_to_string(data("table/table.toml")).unwrap());
}

#[test]
fn another_calibration() {
    let out = tempfile::tempdir().unwrap();
    let changes = ["--adc-span", "150:-10", "--adc-full-scale", "65535", "--dac-span", "-10:40"];
    piezo().args(["emit", TABLE]).args(changes).arg("--out").arg(out.path()).assert().success();
    let (file, changed) = TableFile::load(&out.path().join("table.toml")).unwrap();
    assert!(changed.adc.invert && changed.adc.full_scale == 65535 && changed.adc.offset_v == 150.0);
    assert_eq!(changed.dac.code(40.0f32).0, changed.dac.full_scale);
    assert_eq!(file.table.parameters, TableFile::load(&data("table/table.toml")).unwrap().1.parameters);
}

#[test]
fn a_drive_that_takes_too_long_is_not_emitted_and_every_table_says_what_its_tick_takes() {
    let out = tempfile::tempdir().unwrap();
    // Exponents that no search gives are integrated in steps.
    let of_1 = fs::read_to_string(root().join("tests/data/table/models/bouc-wen.toml")).unwrap();
    let of_2 = of_1
        .replace("\nn = 1.0\n", "\nn = 2.0\n")
        .replace("min = -11.634653", "min = -15.0")
        .replace("max = 55.54301", "max = 60.0");
    let slow = out.path().join("slow.toml");
    fs::write(&slow, of_2).unwrap();
    let folder = out.path().join("none");
    let drive = ["--drive-span", "0:4", "--drive-slew", "400", "--out", text(&folder)];
    refused(
        &[&["emit", text(&slow)], &drive[..]].concat(),
        &[
            "slow.toml: driving takes up to 68700 cycles a tick, 81 % of its time, not 60 % at most",
            "identify with --model generalised-prandtl-ishlinskii",
            "piezo feedforward",
        ],
    );
    assert!(!folder.exists(), "nothing was written");
    let done = piezo().args(["emit", text(&slow)]).args(&drive[4..]).assert().success();
    let printed = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    let cycles = TableFile::load(&slow).unwrap().1.cycles();
    let (most, percent) = (cycles.most, cycles.percent());
    let says = format!(
        "a tick takes at most {most} cycles, {percent:.0} % of the board's 85000; observed in an emulator, not"
    );
    assert!(printed.contains(&says), "{says}: {printed}");
    for drives in ["generalised-prandtl-ishlinskii", "preisach"] {
        let table = format!("tests/data/table/models/{drives}.toml");
        piezo().args(["emit", &table, "--force"]).args(drive).assert().success();
    }
}
