//! What the ADC may bring: the DAC goes to its safe code when the codes cannot be believed, and follows them again when
//! they have been good for a second.

use crate::common::{Bench, PARTS, VALID, shown, triangle};
use anyhow::Result;
use board_emulator_test::{Conversion, Record};
use estimator_core::Table;
use protocol::Faults;

/// Feeds `codes` to a running device for `ticks` ticks. For each, whether the DAC stood at its safe code
/// a trigger later.
fn safe_after(bench: &mut Bench, ticks: usize, codes: impl FnMut(u64) -> u16 + 'static) -> Result<Vec<bool>> {
    let safe = bench.table()?.dac.code(0.0f32).0;
    let first = bench.board.record().conversions.len();
    bench.board.feed(codes);
    bench.board.run_until(20.0, |board| board.record().conversions.len() > first + ticks)?;
    let record = bench.board.record();
    assert_eq!(valid_dies_with_the_output(&record.conversions[first..first + ticks], record, safe), ticks - 1);
    // The conversion of `first` began before, but shows the first code fed.
    let latches = shown(record, 0);
    let is_safe = |trigger| {
        let latch = latches.partition_point(|latch| latch.clock < trigger);
        latches[latch].code == PARTS * safe
    };
    let triggers = record.conversions[first + 1..first + ticks].iter().map(|conversion| conversion.trigger);
    Ok(triggers.map(is_safe).collect())
}

/// Of these conversions, the ticks whose code goes out as the estimate have an edge of VALID, the others none; how many
/// there were, but for the last, whose code is not out.
fn valid_dies_with_the_output(conversions: &[Conversion], record: &Record, safe: u16) -> usize {
    let latches = shown(record, 0);
    let pairs = conversions.windows(2);
    let count = pairs.len();
    for pair in pairs {
        let edges = record.edges[&VALID].iter().filter(|edge| (pair[0].end..pair[1].end).contains(&edge.clock)).count();
        let latch = latches.partition_point(|latch| latch.clock < pair[1].trigger);
        assert_eq!(edges, usize::from(latches[latch].code != PARTS * safe), "{pair:?}");
    }
    count
}

/// From the first to the last, and their number.
fn span(safe: &[bool]) -> Option<(usize, usize, usize)> {
    let first = safe.iter().position(|&safe| safe)?;
    let last = safe.iter().rposition(|&safe| safe)?;
    Some((first, last, safe.iter().filter(|&&safe| safe).count()))
}

/// How long the output is safe after a fault's last cause: a second, and the tick at which the estimate starts anew.
const HOLD: usize = 2001;

#[test]
fn an_adc_at_an_end_of_its_range_for_ten_milliseconds_is_a_fault() -> Result<()> {
    for end in [0, 65_520] {
        let mut bench = Bench::started()?;
        let codes = move |n| if (300..350).contains(&n) || (3000..3019).contains(&n) { end } else { triangle(n) };
        let safe = safe_after(&mut bench, 3500, codes)?;
        // The twentieth tick is the first that is safe; 19 in a row are none.
        assert_eq!(span(&safe), Some((319, 349 + HOLD - 1, 30 + HOLD)), "{end}");
        let health = bench.health()?;
        assert_eq!((health.faults, health.adc_saturated), (Faults::empty(), 69), "{end}");
        assert_eq!(health.faults_seen, Faults::ADC_SATURATED);
    }
    Ok(())
}

#[test]
fn an_adc_that_gives_one_code_for_a_second_is_a_fault() -> Result<()> {
    let mut bench = Bench::started()?;
    let codes = |n| if (100..2_150).contains(&n) { 30_000 } else { triangle(n) };
    let safe = safe_after(&mut bench, 4_300, codes)?;
    assert_eq!(span(&safe), Some((2_100, 2_149 + HOLD - 1, 49 + HOLD)));
    let health = bench.health()?;
    assert_eq!((health.faults, health.faults_seen), (Faults::empty(), Faults::ADC_STUCK));
    Ok(())
}

#[test]
fn a_voltage_that_the_table_does_not_know_is_a_fault_after_a_second() -> Result<()> {
    let mut bench = Bench::started()?;
    let table = bench.table()?;
    let beyond = table.adc.code(table.voltage_range_v.max + 0.02).0;
    let codes = move |n: u64| if (100..2_200).contains(&n) { beyond + (n % 2) as u16 } else { triangle(n) };
    let safe = safe_after(&mut bench, 4_300, codes)?;
    assert_eq!(span(&safe), Some((2_099, 2_199 + HOLD - 1, 100 + HOLD)));
    let health = bench.health()?;
    assert_eq!((health.faults, health.voltage_out_of_range), (Faults::empty(), 2_100));
    assert_eq!(health.faults_seen, Faults::OUT_OF_CALIBRATION);
    Ok(())
}

#[test]
fn a_wire_that_comes_off_is_a_fault_after_ten_milliseconds_until_it_is_back_and_a_glitch_is_none() -> Result<()> {
    let mut bench = Bench::started()?;
    // 120 codes a tick; the triangle goes 40.
    let table = Table { amplifier_slew_v_per_s: Some(16.0), ..*bench.table()? }.admit()?;
    bench.push(&table)?;
    // From where the triangle sets out.
    bench.board.feed(|n| triangle(0) + (n % 2) as u16);
    bench.restart()?;
    let codes = |n: u64| match n {
        100..119 => 60_000,
        300..5_300 => 40_000 + (n % 2) as u16,
        _ => triangle(n),
    };
    let safe = safe_after(&mut bench, 7_500, codes)?;
    // It is back for 10 ms before that is believed.
    assert_eq!(span(&safe), Some((319, 5_319 + HOLD - 1, 5_000 + HOLD)));
    let health = bench.health()?;
    assert_eq!((health.faults, health.faults_seen), (Faults::empty(), Faults::SLEW_EXCEEDED));
    assert_eq!(health.bias_age_ticks, None, "it needs a zero");
    Ok(())
}
