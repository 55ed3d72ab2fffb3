//! A short soak; `cargo xtask soak` has the long one.

use soak::Soak;

#[test]
fn every_tick_of_the_stream_is_accounted_for_and_every_sample_is_the_host_s() {
    let soak = Soak::of(100_000).unwrap();
    println!("{soak}");
    assert!(soak.sound() && soak.ticks >= 100_000 && soak.flagged > 0, "{soak:?}");
}
