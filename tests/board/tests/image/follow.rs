//! The DAC drives the amplifier: references over the serial line in, and every DAC code is the one that the host's f32
//! inverse gives, in time for its tick, whichever the model.

use crate::common::{Bench, FULL, PARTS, shown};
use anyhow::{Result, bail, ensure};
use board_emulator_test::exception;
use estimator_core::*;
use protocol::{Mode, Reply, Request};

const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 400.0 };
/// Clocks of a tick, and so more instructions than one may take.
const TICK: u64 = 85_000;

fn list<const N: usize>(numbers: impl IntoIterator<Item = f32>) -> List<N> {
    List::collect(numbers).expect("no more than fit")
}

/// The device's table with another model, driving an amplifier of 0 … 4 V.
fn driving(table: &Admitted, parameters: Parameters) -> Result<Admitted> {
    let drive = DriveCalibration { gain_codes_per_v: 1024.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
    let limits = Range { min: -50.0, max: 100.0 };
    let table = Table { parameters, displacement_limits_um: limits, drive: Some(drive), ..**table };
    Ok(table.admit()?)
}

fn generalised_prandtl_ishlinskii() -> Parameters {
    Parameters::GeneralisedPrandtlIshlinskii(GeneralisedPrandtlIshlinskiiParameters {
        span_v: Range { min: -0.18, max: 3.78 },
        delay_ticks: 0.6,
        slew_v_per_s: 300.0,
        lag_s: 1e-3,
        resonance_hz: 300.0,
        damping: 0.3,
        reversible_um_per_v: list([5.0; 9]),
        envelope_um_per_v: list((0..135).map(|i| 16.0 + (i % 9) as f32)),
        half_widths_v: list((1..16).map(|i| 0.12 * i as f32)),
        weights: list([0.03; 15]),
        creep_times_s: list([0.01, 0.1, 1.0, 10.0, 100.0]),
        creep_gains: list([0.02; 5]),
        rest_memory: 0.0,
        offset_um: 0.0,
    })
}

fn bouc_wen() -> Parameters {
    Parameters::BoucWen(BoucWenParameters {
        lag_s: 1e-3,
        a: 1.0,
        beta: 0.8,
        gamma: 0.3,
        delta: 0.2,
        n: 1.0,
        offset_um: 0.0,
        d1_um_per_v: 10.0,
        d2_um_per_v2: 0.1,
        c_um_per_v: -3.0,
    })
}

/// Swings that shrink, so that a memory of reversals fills.
fn wanted(tick: usize) -> f32 {
    let t = tick as f32 * 5e-4;
    14.0 + (9.0 - 4.0 * t) * (t * 60.0).sin()
}

fn follows(name: &str, bench: &mut Bench, table: &Admitted) -> Result<()> {
    bench.connect(table, |volts| volts);
    bench.push(table)?;
    bench.restart()?;
    ensure!(bench.table()? == *table, "{name}: the stored table is used");
    let mut references: Vec<f32> = (0..3_000).map(wanted).collect();
    // From end to end, which no voltage reaches in a tick.
    references.extend([24.0; 300]);
    references.extend([4.0; 300]);
    let drive = table.drive.expect("it drives").finer(PARTS);
    let rest = drive.code(LIMITS.rest_v, FULL).0;
    bench.does(Request::SetMode(Mode::Follow))?;
    let served = bench.board.instructions(exception::ADC1_2).count();
    let first = bench.board.record().outputs.len();
    let mut sent = 0;
    while sent < references.len() {
        let references = references[sent..].iter().take(64).copied().collect();
        match bench.ask(Request::Refer { first: sent as u32, references, go: true, hold: true })? {
            Reply::Referred { next, starved: 0 } => sent = next as usize,
            other => bail!("{name}: {other:?}"),
        }
        bench.run(0.01)?;
    }
    bench.run(0.2)?;

    let mut inverse = table.inverse::<f32>(&LIMITS)?;
    let expected: Vec<u16> =
        references.iter().map(|&reference| drive.code(inverse.tick(reference).voltage, FULL).0).collect();
    let codes: Vec<u16> = shown(bench.board.record(), first).iter().map(|latch| latch.code).collect();
    let start = codes.iter().position(|&code| code != rest).expect("it moves");
    let begins = expected.iter().position(|&code| code != rest).expect("it is to move");
    let found = &codes[start..][..expected.len() - begins];
    let wrong = found.iter().zip(&expected[begins..]).position(|(a, b)| a != b);
    assert_eq!(wrong, None, "{name}: reference of {}", expected.len());
    let distinct = expected.iter().collect::<std::collections::BTreeSet<_>>().len();
    assert!(distinct > 500, "{name}: {distinct} codes");
    let own: Vec<u64> = bench.board.instructions(exception::ADC1_2).skip(served + 1).collect();
    let (mean, most) = (own.iter().sum::<u64>() / own.len() as u64, own.iter().copied().max().unwrap_or(0));
    println!(
        "{name}: {distinct} DAC codes as predicted; {mean} instructions in the tick's interrupt on average, {most} at most"
    );
    assert!(most < TICK, "{name}: {most} instructions");
    let health = bench.health()?;
    assert_eq!((health.missed, health.mode), (0, Mode::Follow), "{name}");
    Ok(())
}

#[test]
fn the_drive_gives_the_codes_of_the_host_s_inverse_in_time() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let voigt = table.parameters;
    for (name, parameters) in [
        ("Voigt", voigt),
        ("generalised-prandtl-ishlinskii", generalised_prandtl_ishlinskii()),
        ("Bouc-Wen", bouc_wen()),
    ] {
        follows(name, &mut bench, &driving(&table, parameters)?)?;
    }
    Ok(())
}

/// What the board has of its stack when the longest of tables is pushed over a drive, checked, started and followed.
#[test]
fn the_longest_table_leaves_a_part_of_the_stack() -> Result<()> {
    // Of memory.x's stack the lower 48 kB, of which a device that waits for the line uses none.
    const UNUSED: std::ops::Range<u32> = 0x2000_0000..0x2000_C000;
    const LEAST: usize = 4 << 10;
    const PAINT: u32 = 0xC0DE_57AC;
    let mut bench = Bench::started()?;
    UNUSED.step_by(4).try_for_each(|at| bench.board.poke(at, PAINT))?;
    let table = driving(&bench.table()?, generalised_prandtl_ishlinskii())?;
    for _ in 0..2 {
        follows("generalised-prandtl-ishlinskii", &mut bench, &table)?;
    }
    let painted = UNUSED.step_by(4).take_while(|&at| bench.board.peek(at).is_ok_and(|word| word == PAINT));
    let unused = 4 * painted.count();
    println!("{unused} bytes of the stack were never used");
    assert!(unused >= LEAST, "{unused} bytes of the stack are left, not {LEAST}");
    Ok(())
}
