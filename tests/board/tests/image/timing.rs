//! Nothing keeps the tick waiting: when its interrupt comes after the trigger, at rest and while the link, the flash or
//! a noisy line keep the rest of the firmware busy.

use crate::common::noise::Noise;
use crate::common::{Bench, CONVERSION, PERIOD, push, reseeded};
use anyhow::Result;
use board_emulator_test::{Conversion, FlashKind, exception};
use protocol::{BAUD, Request};

/// What delays the interrupt at most beyond the conversion, clocks: the longest critical section. Some 3 µs.
const BOUND: u64 = 500;

/// Does `work` on a running board. From the end of every conversion meanwhile to its interrupt, clocks.
fn delays(name: &str, bench: &mut Bench, work: impl FnOnce(&mut Bench) -> Result<()>) -> Result<Vec<u64>> {
    let first = bench.board.record().conversions.len();
    work(bench)?;
    let last = bench.board.record().conversions.len();
    let health = bench.health()?;
    let record = bench.board.record();
    let conversions = &record.conversions[first..last];
    assert!(conversions.windows(2).all(|pair| pair[1].trigger - pair[0].trigger == PERIOD), "{name}: a trigger is off");
    assert!(
        conversions.iter().all(|Conversion { trigger, end, late, .. }| end - trigger == CONVERSION && !late),
        "{name}"
    );
    assert_eq!((record.lost_triggers, record.overruns, health.missed, health.line_errors), (0, 0, 0, 0), "{name}");
    let services = &record.services[&exception::ADC1_2];
    let delay = |conversion: &Conversion| {
        let next = services.partition_point(|service| service.entry < conversion.end);
        services[next].entry - conversion.end
    };
    let delays: Vec<u64> = conversions.iter().map(delay).collect();
    let most = delays.iter().max().expect("a conversion at least");
    println!(
        "{name}: the interrupt comes {CONVERSION} clocks after the trigger in {} of {} ticks, up to {most} later in the others",
        punctual(&delays),
        delays.len()
    );
    assert!(*most <= BOUND, "{name}: {most}");
    Ok(delays)
}

fn punctual(delays: &[u64]) -> usize {
    delays.iter().filter(|&&delay| delay == 0).count()
}

#[test]
fn idle_the_interrupt_comes_with_the_conversions_end() -> Result<()> {
    let mut bench = Bench::started()?;
    let delays = delays("idle", &mut bench, |bench| bench.run(1.0))?;
    // The rest meet the time driver's critical section.
    assert!(punctual(&delays) * 100 >= delays.len() * 99);
    Ok(())
}

#[test]
fn streaming_at_the_full_rate() -> Result<()> {
    let mut bench = Bench::started()?;
    delays("streaming", &mut bench, |bench| {
        bench.does(Request::Stream(true))?;
        bench.run(2.0)
    })?;
    let samples = &bench.samples;
    assert!(samples.windows(2).all(|pair| pair[1].first == pair[0].first + pair[0].samples.len() as u32), "a gap");
    let count: usize = samples.iter().map(|batch| batch.samples.len()).sum();
    assert!(count > 3950, "{count} samples in 2 s");
    assert_eq!(bench.health()?.samples_dropped, 0);
    Ok(())
}

#[test]
fn writing_the_flash_while_estimating() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    delays("pushing tables", &mut bench, |bench| {
        (2..40).try_for_each(|seed| bench.does(push(&reseeded(&table, seed))))
    })?;
    let count = |kind| bench.board.record().flash.iter().filter(|operation| operation.kind == kind).count();
    let (erases, programs) = (count(FlashKind::Erase), count(FlashKind::Program));
    println!("pushing tables: {erases} erases, {programs} programs");
    assert!(erases >= 2 && programs > 500, "{erases} erases, {programs} programs");
    Ok(())
}

#[test]
fn a_flood_of_garbage() -> Result<()> {
    let mut bench = Bench::started()?;
    let mut noise = Noise::new(1);
    let garbage: Vec<u8> = (0..4000).flat_map(|_| noise.bad_frame()).collect();
    let seconds = 10.0 * garbage.len() as f64 / f64::from(BAUD);
    delays("garbage", &mut bench, |bench| {
        bench.board.send(&garbage);
        bench.run(seconds + 0.001)
    })?;
    let health = bench.health()?;
    println!("garbage: {seconds:.1} s of the line's full rate, {} frames refused", health.frames_refused);
    assert!(health.frames_refused > 2000, "{health:?}");
    Ok(())
}
