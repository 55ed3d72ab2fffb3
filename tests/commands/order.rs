//! A line on which frames end in their middle, come twice, or in another order, with the firmware on the host.

use super::severed::attack;

#[test]
fn a_host_that_leaves_in_mid_frame_costs_that_frame_and_the_next_host_is_answered() {
    attack(16.0, |attacked| attacked.hosts_leave_in_mid_frame());
}

#[test]
fn what_comes_twice_is_done_and_answered_as_if_it_had_come_once() {
    attack(8.0, |attacked| attacked.frames_come_twice());
}

#[test]
fn samples_in_another_order_end_a_recording_where_they_begin_to() {
    attack(8.0, |attacked| attacked.samples_come_in_another_order());
}
