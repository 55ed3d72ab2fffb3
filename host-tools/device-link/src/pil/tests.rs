//! Codes through the native device, over lines that lose and damage.

use super::*;
use emulator::faults::{lose_samples_at, messages, replies, wrong_bit_at};
use emulator::{Emulator, Fault, FaultyLine, TABLE};
use protocol::sample::MAX_BATCH;
use protocol::{Reply, ToHost};

fn codes(table: &Admitted) -> Vec<AdcCode> {
    let wave = |k: u32| 1.8 + 1.7 * (f64::from(k) * 0.01).sin();
    (0..3000).map(|k| table.adc.code(wave(k))).collect()
}

fn run(fault: impl Fault) -> Result<Comparison, FeedError> {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let line = FaultyLine::to(device.address(), fault).unwrap();
    let (mut client, _) = Client::connect(&line.address().into()).unwrap();
    let table = TABLE.admit().unwrap();
    let codes = codes(&table);
    let samples = feed(&mut client, &table, &codes, &Interrupt::default(), &mut |_| {})?;
    Ok(compare(&table, &codes, &samples))
}

#[test]
fn the_same_core_gives_the_same_bits() {
    let comparison = run(|_, _: &mut Vec<u8>| {}).unwrap();
    assert_eq!((comparison.ticks, comparison.identical, comparison.first_difference), (3000, 3000, None));
}

#[test]
fn a_lost_reply_to_a_feed_costs_nothing() {
    let mut feeds = 0;
    let lost = replies(move |_, reply, frame| {
        if matches!(reply, Reply::Fed(_)) {
            if [2, 11].contains(&feeds) {
                frame.clear();
            }
            feeds += 1;
        }
    });
    let comparison = run(lost).unwrap();
    assert_eq!((comparison.ticks, comparison.identical), (3000, 3000));
}

#[test]
fn one_bit_of_one_tick_is_found() {
    let comparison = run(wrong_bit_at(1234)).unwrap();
    let difference = comparison.first_difference.unwrap();
    assert_eq!((comparison.identical, difference.tick), (2999, 1234));
    assert_eq!(difference.host.bits ^ difference.device.bits, 1);
    assert!(comparison.max_difference_um > 0.0);
}

#[test]
fn samples_that_nobody_asked_for_are_refused() {
    // After the first batch come eight full ones of codes that were not fed: more than may be under way.
    let mut before = true;
    let unasked = messages(move |message| {
        let mut arrives = vec![message.clone()];
        if let (ToHost::Samples(batch), true) = (&message, before) {
            before = false;
            let mut next = batch.first + batch.samples.len() as u32;
            for _ in 0..8 {
                let mut more = batch.clone();
                more.first = next;
                while more.samples.len() < MAX_BATCH {
                    more.samples.push(batch.samples[0]).unwrap();
                }
                next += MAX_BATCH as u32;
                arrives.push(ToHost::Samples(more));
            }
        }
        arrives
    });
    let error = run(unasked).unwrap_err().to_string();
    assert!(error.contains("more samples than"), "{error}");
}

#[test]
fn lost_samples_are_not_papered_over() {
    let error = run(lose_samples_at(500)).unwrap_err().to_string();
    assert!(error.contains("lost samples"), "{error}");
}
