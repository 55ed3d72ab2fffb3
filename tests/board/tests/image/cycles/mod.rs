//! What the tick's interrupt costs in cycles, of every model, by the emulator's model of the core and the flash: with
//! the inputs of [`shapes`], which are to be the worst, and the tables of [`tables`], the largest among them; once with
//! voltages that are all the amplifier's, and once with some that leap farther, of a drive also by references from its
//! memory. It is the most that was observed, and no proof that there is no more.
//!
//! Every line that begins with `cycles: ` is JSON; `cargo xtask cycles` prints them.

mod largest;
pub mod shapes;
pub mod tables;

use crate::common::{Bench, push};
use anyhow::{Context, Result, bail, ensure};
use board_emulator_test::{Level, Measured, exception};
use estimator_core::table::MARGIN_PERCENT;
use estimator_core::{Admitted, Model, Pace, Range, Status};
use protocol::waveform::checksum;
use protocol::{Faults, MOST_VALUES, Mode, Playback, Refusal, Reply, Request, Samples};
use serde_json::{Value, json};
use shapes::{LEAPS, SHAPES, TICKS, leaping, shape};
use std::cell::Cell;
use std::num::NonZeroU16;

/// How much of that margin one build of one source may take, %: rustc and the linker do not lay functions out the same
/// way each time, and a tick runs cold.
const LAYOUT_PERCENT: u32 = 3;
/// How far what is stated may lie above what must be, %. Which references make a search long is a matter of chance, and
/// what is stated is the most of several runs with others.
const LOOSE_PERCENT: u32 = 20;

/// A device that runs this table from its store, streaming.
fn running(table: &Admitted) -> Result<Bench> {
    let mut bench = Bench::started()?;
    bench.push(table)?;
    bench.restart()?;
    ensure!(bench.table()? == *table, "the stored table is used");
    Ok(bench)
}

/// What was measured, as JSON; cycles by level, the optimistic first.
fn to_json(measured: &Measured) -> Value {
    json!({
        "ticks": measured.runs,
        "most_instructions": measured.most_instructions,
        "mean_instructions": measured.instructions as f64 / measured.runs as f64,
        "most_cycles": measured.most_clocks,
        "mean_cycles": measured.mean_clocks(),
    })
}

/// The ADC's codes of a shape.
fn code(table: &Admitted, part: f32) -> u16 {
    let volts = table.voltage_range_v;
    table.adc.code::<f32>(table.voltage_zero_v + volts.min + part * volts.span()).0
}

/// Whether the monitor's voltage leaps as the amplifier cannot, every few ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Monitor {
    Sound,
    Leaps,
}

/// Estimates: every shape, and where the monitor is sound starts all over the range.
fn estimate(table: &Admitted, monitor: Monitor) -> Result<Measured> {
    let mut bench = running(table)?;
    let part = if monitor == Monitor::Leaps { leaping } else { shape };
    let codes: Vec<u16> = (0..SHAPES * TICKS).map(|tick| code(table, part(tick))).collect();
    // It starts where the shapes begin, since the way there would be a leap; the first interrupt only takes what
    // it will own.
    let begins = codes[0];
    bench.board.feed(move |_| begins);
    bench.restart()?;
    bench.run(0.005)?;
    bench.board.measure(exception::ADC1_2)?;
    // First ticks, at voltages all over the range, after pauses, since an estimate that is begun again goes on; the
    // last where the shapes begin. Each is a leap away from the one before.
    for start in (0..12).rev().filter(|_| monitor == Monitor::Sound) {
        let at = code(table, start as f32 / 11.0);
        bench.does(Request::SetMode(Mode::Pause))?;
        bench.board.feed(move |_| at);
        bench.does(Request::SetMode(Mode::Estimate))?;
        bench.run(0.005)?;
    }
    bench.does(Request::Stream(true))?;
    bench.board.feed(move |n| codes[n as usize % codes.len()]);
    bench.run(0.35)?;
    told(&mut bench, monitor)?;
    bench.run(f64::from(SHAPES * TICKS) / 2_000.0)?;
    let measured = bench.board.measured();
    leapt(&bench, monitor)?;
    Ok(measured)
}

/// Tells the estimate its displacement, so that it has an interval. It takes none while a voltage that has
/// leapt is held.
fn told(bench: &mut Bench, monitor: Monitor) -> Result<()> {
    for _ in 0..20 {
        match bench.ask(Request::SetZero { at_um: 0.0 })? {
            Reply::Done | Reply::Refused(Refusal::TooSoon | Refusal::BeyondSpan { .. }) => return Ok(()),
            Reply::Refused(Refusal::NotBelieved) if monitor == Monitor::Leaps => bench.run(0.003)?,
            other => bail!("{other:?}"),
        }
    }
    bail!("no zero is taken between the leaps")
}

/// What was streamed has ticks that were held where the monitor leaps, and no others; and they were no fault, with
/// which a tick does less.
fn leapt(bench: &Bench, monitor: Monitor) -> Result<()> {
    let samples = || bench.samples.iter().flat_map(Samples::numbered).map(|(_, sample)| sample);
    let held = samples().filter(|sample| sample.status.contains(Status::SLEW_EXCEEDED)).count();
    ensure!((held > 0) == (monitor == Monitor::Leaps), "{held} samples were held, {monitor:?}");
    ensure!(samples().all(|sample| !sample.faults.contains(Faults::SLEW_EXCEEDED)), "{monitor:?} is a fault");
    Ok(())
}

/// Where a drive's references come from.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Source {
    Host,
    Memory,
}

/// Follows every shape between the displacements at rest at the ends of the drive's voltages.
fn follow(table: &Admitted, monitor: Monitor, source: Source) -> Result<Measured> {
    let mut bench = running(table)?;
    let (ticks, Range { min, max }) = (Cell::new(0), table.drive.expect("it drives").limits.range_v);
    bench.connect(table, move |volts| {
        ticks.set((ticks.get() + 1) % LEAPS);
        match monitor {
            Monitor::Leaps if ticks.get() == 0 => {
                if volts < 0.5 * (min + max) {
                    max
                } else {
                    min
                }
            }
            _ => volts,
        }
    });
    let (low, high) = way(table);
    let references: Vec<f32> = (0..SHAPES * TICKS).map(|tick| low + (high - low) * (1.2 * shape(tick) - 0.1)).collect();
    match source {
        Source::Host => refer(&mut bench, &references)?,
        Source::Memory => play(&mut bench, table, &references)?,
    }
    let measured = bench.board.measured();
    bench.does(Request::Stream(true))?;
    bench.run(0.02)?;
    leapt(&bench, monitor)?;
    ensure!(!bench.health()?.faults_seen.contains(Faults::SLEW_EXCEEDED), "{monitor:?} was a fault");
    Ok(measured)
}

/// Measures while the references are followed that the host sends.
fn refer(bench: &mut Bench, references: &[f32]) -> Result<()> {
    bench.does(Request::SetMode(Mode::Follow))?;
    bench.board.measure(exception::ADC1_2)?;
    let mut sent = 0;
    while sent < references.len() {
        let chunk = references[sent..].iter().copied().take(MOST_VALUES).collect();
        match bench.ask(Request::Refer { first: sent as u32, references: chunk, go: true, hold: true })? {
            Reply::Referred { next, .. } => sent = next as usize,
            other => bail!("{other:?}"),
        }
        bench.run(0.035)?;
    }
    Ok(())
}

/// Measures while they are played from the device's memory, a whole line and the ways there and back.
fn play(bench: &mut Bench, table: &Admitted, points: &[f32]) -> Result<()> {
    let mut first = 0;
    for chunk in points.chunks(MOST_VALUES) {
        match bench.ask(Request::Load { first, points: chunk.iter().copied().collect() })? {
            Reply::Loaded(count) => first = count,
            other => bail!("{other:?}"),
        }
    }
    let (crc, one) = (checksum(points.iter().copied()), NonZeroU16::MIN);
    let count = NonZeroU16::new(first).context("no points")?;
    bench.board.measure(exception::ADC1_2)?;
    bench.does(Request::Play(Playback { points: count, crc, every: one, lines: 0, on_trigger: false }))?;
    let pace = Pace::of(table).context("it drives")?;
    let (lowest, highest) = points.iter().fold((0.0f32, 0.0f32), |(low, high), &um| (low.min(um), high.max(um)));
    bench.run(f64::from(2 * pace.ticks(lowest, highest) + SHAPES * TICKS) / 2_000.0)?;
    ensure!(bench.health()?.lines > 0, "no line has begun");
    Ok(())
}

/// The displacements (µm) long after the drive has come to the ends of its voltages.
pub fn way(table: &Admitted) -> (f32, f32) {
    let limits = table.drive.expect("it drives").limits;
    let inverse = || table.inverse::<f32>(&limits).expect("it drives");
    let (mut low, mut high) = (inverse(), inverse());
    let ticks = 2_000;
    let (mut lowest, mut highest) = (0.0, 0.0);
    for _ in 0..ticks {
        lowest = low.steer(limits.range_v.min).displacement;
        highest = high.steer(limits.range_v.max).displacement;
    }
    (lowest, highest)
}

/// Whether the device takes a table, which must not if its tick takes too long.
fn refused(table: &Admitted) -> Result<bool> {
    let Err(misfit) = table.in_time() else { return Ok(false) };
    let mut bench = Bench::started()?;
    let reply = bench.ask(push(table))?;
    ensure!(reply == Reply::Refused(Refusal::Table(protocol::text(misfit))), "{reply:?}");
    Ok(true)
}

/// Measures a model, and says where the core states too few cycles or far too many.
fn measure(model: Model, drives: bool) -> Result<Vec<String>> {
    // By what the core states, the most that was observed.
    let mut observed: Vec<(u32, u32)> = Vec::new();
    for (name, table) in tables::tables(model, drives)? {
        let stated = table.cycles().most;
        let line = |name: &str, more: Value| {
            let mut line = json!({ "model": model.name(), "table": name, "drives": drives, "stated": stated });
            let Value::Object(more) = more else { unreachable!("it is written as an object") };
            line.as_object_mut().expect("an object").extend(more);
            println!("cycles: {line}");
        };
        if refused(&table)? {
            line(name, json!({ "refused": true }));
            continue;
        }
        let slower = tables::slower(&table)?;
        let runs = [
            (name.to_owned(), table, Monitor::Sound, Source::Host),
            (format!("{name}, leaps"), slower, Monitor::Leaps, Source::Host),
        ];
        let memory = drives.then(|| (format!("{name}, leaps, from memory"), slower, Monitor::Leaps, Source::Memory));
        for (name, table, monitor, source) in runs.into_iter().chain(memory) {
            let measured = if drives { follow(&table, monitor, source) } else { estimate(&table, monitor) };
            let measured = measured.with_context(|| format!("{}, {name}, drives: {drives}", model.name()))?;
            line(&name, to_json(&measured));
            let most = u32::try_from(measured.most_clocks[Level::Pessimistic as usize])?;
            match observed.iter_mut().find(|(other, _)| *other == stated) {
                Some((_, before)) => *before = most.max(*before),
                None => observed.push((stated, most)),
            }
        }
    }
    let what = if drives { "drive" } else { "estimate" };
    let wrong = observed.into_iter().filter_map(|(stated, most)| {
        let least = (most * (100 + MARGIN_PERCENT - LAYOUT_PERCENT)).div_ceil(100);
        let right = least <= stated && 100 * stated <= (100 + LOOSE_PERCENT) * least;
        (!right).then(|| format!("{}, {what}: {most} cycles are observed, and {stated} stated", model.name()))
    });
    Ok(wrong.collect())
}

fn measure_all(drives: bool) -> Result<()> {
    let models = Model::ALL.into_iter().filter(|&model| !(drives && model == Model::Narx));
    let wrong = models.map(|model| measure(model, drives)).collect::<Result<Vec<_>>>()?.concat();
    ensure!(
        wrong.is_empty(),
        "{}\nstate {MARGIN_PERCENT} % more than was observed, in the model's line of estimator-core/src/model/catalogue.rs",
        wrong.join("\n")
    );
    Ok(())
}

#[test]
fn no_estimate_takes_more_cycles_than_the_core_states() -> Result<()> {
    measure_all(false)
}

#[test]
fn no_drive_takes_more_cycles_than_the_core_states() -> Result<()> {
    measure_all(true)
}
