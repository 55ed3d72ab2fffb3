//! No byte is lost on the line, however long the tick keeps the rest waiting: the full stream one way, references
//! without a pause the other, with every drive that a board takes, on a core that is slower than a Cortex-M4 is with
//! its wait states.

use crate::common::{Bench, PERIOD, frame, push, reseeded};
use crate::cycles::shapes::{SHAPES, TICKS, shape};
use crate::cycles::tables::tables;
use crate::cycles::way;
use anyhow::{Context, Result, ensure};
use board_emulator_test::{FlashKind, Record, exception};
use estimator_core::{Admitted, Model};
use protocol::{BAUD, Mode, Reply, Request};
use std::env;

/// Clocks of an instruction. What is expected of the core lies between 1.5 and 2.2.
const CLOCKS: f64 = 2.5;
/// A host keeps so many bytes on the way: the line never pauses.
const AHEAD: usize = 400;
/// How often the host looks, s: less than it keeps on the way lasts.
const LOOK: f64 = 0.002;
/// Clocks that the UART's own memory of eight bytes lasts.
const FIFO: u64 = 8 * 10 * 170_000_000 / BAUD as u64;

/// Seconds of all drives together, unless [`EACH`] says what each has.
const SECONDS: f64 = 24.0;
/// Seconds of a drive whose ticks take more than half of the time: what comes is then read hardly faster than it comes,
/// and where it is read more slowly, the receiver's memory is full after some ten seconds.
const LONG: f64 = 20.0;
/// The environment variable that says how many seconds each drive has: a minute of each takes longer than
/// everything else here.
const EACH: &str = "LINE_SECONDS";

/// What a session came to.
struct Session {
    requests: usize,
    replies: usize,
    next: u32,
    ticks: u32,
    /// Ticks that found no reference.
    starved: u32,
}

/// Follows the shapes for so long, with the line full both ways.
fn full_line(bench: &mut Bench, table: &Admitted, seconds: f64) -> Result<Session> {
    let (low, high) = way(table);
    let reference = |tick: u32| low + (high - low) * (1.2 * shape(tick % (SHAPES * TICKS)) - 0.1);
    // A sensor's codes make each sample longer by two bytes.
    bench.board.feed_sensor(|n| (n * 4_095 % 65_521) as u16);
    bench.does(Request::SetMode(Mode::Follow))?;
    bench.does(Request::Stream(true))?;
    bench.samples.clear();
    let before = bench.health()?.ticks;
    let (mut requests, mut replies, mut next, mut sequence, mut starved) = (0, 0, 0, 0u16, 0);
    let mut take = |bench: &mut Bench, next: &mut u32| -> Result<()> {
        for (_, reply) in bench.listen() {
            let Reply::Referred { next: wanted, starved: so_far } = reply else { anyhow::bail!("{reply:?}") };
            starved = so_far;
            ensure!(wanted >= *next, "reference {wanted} is wanted after {next}");
            (*next, replies) = (wanted, replies + 1);
        }
        Ok(())
    };
    for _ in 0..(seconds / LOOK) as usize {
        while bench.board.on_the_way() < AHEAD {
            let references = (next..next + 64).map(reference).collect();
            bench.board.send(&frame(sequence, Request::Refer { first: next, references, go: true, hold: true }));
            (sequence, requests) = (sequence.wrapping_add(1), requests + 1);
        }
        bench.board.run(LOOK)?;
        take(bench, &mut next)?;
    }
    // What is on the way.
    bench.board.run(0.05)?;
    take(bench, &mut next)?;
    Ok(Session { requests, replies, next, ticks: bench.health()?.ticks - before, starved })
}

/// The longest run of the tick's interrupt, clocks of a core that takes [`CLOCKS`].
fn longest(record: &Record, since: u64) -> u64 {
    let services = record.services[&exception::ADC1_2].iter().filter(|service| service.entry >= since);
    let most = services.filter_map(|service| service.instructions).max().unwrap_or(0);
    (most as f64 * CLOCKS) as u64
}

fn session(model: Model, name: &str, table: &Admitted, seconds: f64) -> Result<u64> {
    let mut bench = Bench::started()?;
    bench.connect(table, |volts| volts);
    bench.push(table)?;
    bench.board.slow(CLOCKS);
    bench.restart()?;
    ensure!(bench.table()? == *table, "the stored table is used");
    let since = bench.board.clock();
    let Session { requests, replies, next, ticks, starved } = full_line(&mut bench, table, seconds)?;
    let health = bench.health()?;
    let (record, most) = (bench.board.record(), longest(bench.board.record(), since));
    println!(
        "{}, {name}: {requests} requests, {next} references in {ticks} ticks of up to {most} clocks, {starved} starved",
        model.name()
    );
    assert_eq!(starved, 0, "of {ticks} ticks so many found no reference");
    assert_eq!((record.overruns, health.line_errors, health.frames_refused), (0, 0, 0), "lost on the line");
    assert_eq!(replies, requests, "each is answered");
    assert_eq!((health.missed, health.mode), (0, Mode::Follow), "{health:?}");
    assert_eq!(health.samples_dropped, 0);
    let samples = &bench.samples;
    assert!(samples.windows(2).all(|pair| pair[1].first == pair[0].first + pair[0].samples.len() as u32), "a gap");
    let streamed: usize = samples.iter().map(|batch| batch.samples.len()).sum();
    assert!(streamed as f64 > 1_990.0 * seconds && f64::from(next) > 1_950.0 * seconds, "{streamed}, {next}");
    Ok(most)
}

#[test]
fn full_both_ways_nothing_is_lost_with_any_drive() -> Result<()> {
    let mut drives = Vec::new();
    for model in Model::ALL.into_iter().filter(|&model| model != Model::Narx) {
        let tables = tables(model, true)?.into_iter().filter(|(_, table)| table.in_time().is_ok());
        drives.extend(tables.map(|(name, table)| (model, name, table)));
    }
    let seconds = match env::var(EACH) {
        Ok(each) => each.parse().with_context(|| format!("{EACH}={each} is no number of seconds"))?,
        Err(_) => SECONDS / drives.len() as f64,
    };
    ensure!(seconds > 0.0, "{seconds} s of each drive prove nothing");
    let mut longest = 0;
    for (model, name, table) in drives {
        let most = session(model, name, &table, seconds).with_context(|| format!("{}, {name}", model.name()))?;
        longest = longest.max(most);
        if most > PERIOD / 2 && seconds < LONG {
            session(model, name, &table, LONG).with_context(|| format!("{}, {name}, for long", model.name()))?;
        }
    }
    assert!(longest > FIFO, "ticks of {longest} clocks, of which the UART's own memory bears {FIFO}, prove nothing");
    Ok(())
}

#[test]
fn a_broken_byte_costs_its_frame_and_stops_nothing() -> Result<()> {
    let mut bench = Bench::started()?;
    for errors in 1..=3 {
        bench.board.send_broken(&frame(0, Request::Health)[..3]);
        bench.board.send(&[0]);
        bench.run(0.01)?;
        let health = bench.health()?;
        // Three bytes flag their errors before anybody looks, or one by one.
        assert!((errors..=3 * errors).contains(&health.line_errors), "{errors}: {health:?}");
        assert_eq!(health.frames_refused, errors);
    }
    assert_eq!(bench.board.record().overruns, 0);
    Ok(())
}

#[test]
fn what_comes_while_pages_are_erased_waits() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let erased = |bench: &Bench| bench.board.record().flash.iter().any(|done| done.kind == FlashKind::Erase);
    let mut seed = 0;
    while !erased(&bench) {
        seed += 1;
        bench.does(push(&reseeded(&table, seed)))?;
    }
    // As many as a page's erase lasts, and more than any buffer held before.
    let asked = 200;
    bench.does(Request::SetMode(Mode::Pause))?;
    let before = bench.operations();
    bench.board.send(&frame(0, Request::Erase { while_estimating: true, rewired: true }));
    for sequence in 1..=asked {
        bench.board.send(&frame(sequence, Request::Stream(false)));
    }
    bench.board.run(0.3)?;
    let replies = bench.listen();
    ensure!(bench.operations() > before, "nothing was erased");
    let answered: Vec<u16> = replies.iter().map(|(to, _)| *to).collect();
    assert_eq!(answered, (0..=asked).collect::<Vec<_>>());
    assert!(replies.iter().all(|(_, reply)| *reply == Reply::Done));
    Ok(())
}
