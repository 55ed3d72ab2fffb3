//! A hundred thousand bad frames at the line's full rate: noise, and requests cut short or with a byte changed.

use crate::common::Bench;
use crate::common::noise::Noise;
use anyhow::{Result, ensure};
use protocol::{BAUD, Uid};

const ROUNDS: u32 = 100;
const FRAMES_A_ROUND: u32 = 1000;
/// What the emulated chip's factory has written.
const UID: Uid = Uid(*b"board-tests\0");

#[test]
fn a_hundred_thousand_bad_frames_do_no_harm() -> Result<()> {
    let mut bench = Bench::started()?;
    let identity = bench.identity()?;
    assert_eq!(identity.uid, Some(UID), "the chip's own number");
    let mut noise = Noise::new(1);
    let (mut ticks, mut sent) = (0, 0);
    for _ in 0..ROUNDS {
        let garbage: Vec<u8> = (0..FRAMES_A_ROUND).flat_map(|_| noise.bad_frame()).collect();
        sent += garbage.len();
        bench.board.send(&garbage);
        bench.run(10.0 * garbage.len() as f64 / f64::from(BAUD) + 0.001)?;
        let health = bench.health()?;
        ensure!(health.ticks > ticks && health.missed == 0 && health.last_words.is_none(), "{health:?}");
        ticks = health.ticks;
    }
    let health = bench.health()?;
    println!("{sent} bytes, {} frames refused, {} errors of the line", health.frames_refused, health.line_errors);
    assert!(health.frames_refused > ROUNDS * FRAMES_A_ROUND / 2, "{health:?}");
    assert_eq!(bench.identity()?, identity);
    assert!(bench.board.record().flash.is_empty(), "a damaged request has reached the flash");
    Ok(())
}
