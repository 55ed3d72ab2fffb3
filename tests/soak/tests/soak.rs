//! A short soak; `cargo xtask soak` has the long one.

use emulator::faults::decode;
use emulator::{Direction, FaultyLine};
use protocol::ToHost;
use soak::signal::swings;
use soak::{Soak, SoakError, device};

#[test]
fn every_tick_of_the_stream_is_accounted_for_and_every_sample_is_the_host_s() {
    let soak = Soak::of(100_000).unwrap();
    println!("{soak}");
    assert!(soak.sound() && soak.ticks >= 100_000 && soak.flagged > 0, "{soak:?}");
}

#[test]
fn a_batch_that_comes_twice_ends_it() {
    let device = device().unwrap();
    let line = FaultyLine::to(device.address(), |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToHost && matches!(decode(frame), Some(ToHost::Samples(_))) {
            frame.extend(frame.clone());
        }
    });
    let soak = Soak::at(&line.unwrap().address().into(), swings, 10_000);
    assert!(matches!(soak, Err(SoakError::Reordered { first, next }) if first < next), "{soak:?}");
}
