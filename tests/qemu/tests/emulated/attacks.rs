//! The image is attacked on its line with all that the firmware on the host is attacked
//! with (`tests/commands/severed.rs`, `order.rs`).

use link_attacks::steps::{VERBS, WRITING};
use link_attacks::{Attacked, Device};
use qemu_test::{Board, from_environment, repository};
use std::net::SocketAddr;

struct Emulated(Board);

impl Device for Emulated {
    fn address(&self) -> SocketAddr {
        self.0.line_address()
    }
}

/// Attacks boards with a table that they take.
fn attack(attack: impl Fn(&Attacked<'_>)) {
    let first = Board::power_on();
    let power_on = || Box::new(Emulated(Board::power_on())) as Box<dyn Device>;
    attack(&Attacked {
        power_on: &power_on,
        piezo: &from_environment("PIEZO"),
        folder: &repository("."),
        table: &first.table("another", &["--dac-span", "-10:60"]),
        measured: &repository("tests/data/picma-p885-1hz.csv"),
        // Each takes most of a core: asleep, its core asks for events all the time.
        at_a_time: 2,
    });
}

#[test]
fn a_host_that_is_killed_at_any_step_leaves_a_board_that_estimates() {
    attack(|attacked| attacked.hosts_are_killed(&VERBS[..WRITING]));
}

#[test]
fn a_line_that_dies_at_any_step_is_told_in_time_and_whether_the_table_is_stored() {
    attack(|attacked| attacked.lines_die(&VERBS[..WRITING]));
}

#[test]
fn a_second_host_waits_and_does_not_disturb_the_first() {
    attack(|attacked| attacked.a_second_host_comes());
}

#[test]
fn a_host_that_leaves_in_mid_frame_costs_that_frame_and_the_next_host_is_answered() {
    attack(|attacked| attacked.hosts_leave_in_mid_frame());
}

#[test]
fn what_comes_twice_is_done_and_answered_as_if_it_had_come_once() {
    attack(|attacked| attacked.frames_come_twice());
}

#[test]
fn samples_in_another_order_end_a_recording_where_they_begin_to() {
    attack(|attacked| attacked.samples_come_in_another_order());
}
