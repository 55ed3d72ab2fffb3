//! A host that is killed, or whose line dies, or that is not alone, with the firmware on the host: the attacks are in
//! `link-attacks`, and the firmware in QEMU is attacked with the same.

use super::{MEASURED, root};
use device_link::table::to_record;
use emulator::{EmulatedDevice, Emulator};
use link_attacks::steps::{CHANGING, VERBS};
use link_attacks::{Attacked, Device};
use protocol::Record;
use std::path::Path;
use table_files::TableFile;

pub const TABLE: &str = "tests/data/table/models/duhem.toml";

/// Attacks devices that run so many times as fast as a board.
pub fn attack(speed: f64, attack: impl Fn(&Attacked<'_>)) {
    let power_on = move || Box::new(Emulator::new().speed(speed).start().unwrap()) as Box<dyn Device>;
    attack(&Attacked {
        power_on: &power_on,
        piezo: Path::new(env!("CARGO_BIN_EXE_piezo")),
        folder: &root(),
        table: &root().join(TABLE),
        measured: &root().join(MEASURED),
        // Most of them wait.
        at_a_time: 80,
    });
}

pub fn pushed() -> Record {
    to_record(&TableFile::load(&root().join(TABLE)).unwrap().1)
}

/// As [`link_attacks::goes_on`], where the old table is the image's.
pub fn goes_on(what: &str, device: &EmulatedDevice, new: &Record) -> bool {
    let old = to_record(&emulator::TABLE.admit().unwrap());
    link_attacks::goes_on(what, device.address(), &old, new)
}

#[test]
fn a_host_that_is_killed_at_any_step_leaves_a_device_that_estimates() {
    attack(1.0, |attacked| attacked.hosts_are_killed(&VERBS));
}

#[test]
fn a_line_that_dies_at_any_step_is_told_in_time_and_whether_the_table_is_stored() {
    attack(1.0, |attacked| attacked.lines_die(&VERBS[..CHANGING]));
}

#[test]
fn a_second_host_waits_and_does_not_disturb_the_first() {
    attack(1.0, |attacked| attacked.a_second_host_comes());
}
