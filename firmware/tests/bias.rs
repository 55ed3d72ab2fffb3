//! A displacement that is told: when the tick takes it, how long it holds, and how its loss is said.

mod common;

use common::{LinkEnd, PERIOD, compiled, driving, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Estimator};
use firmware::Tick;
use firmware::queues::Command;
use firmware::watch::{HOLD, SATURATED, STUCK};
use protocol::{Faults, Mode};

#[test]
fn the_bias_is_told_at_the_next_tick_and_ages_until_the_estimate_begins_anew() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    for k in 0..500 {
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    assert_eq!((link.telemetry.bias.um(), link.telemetry.bias.age_ticks()), (0.0, None));
    link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).unwrap();
    link.telemetry.streaming.store(true, Relaxed);
    tick.sample(triangle(500).into(), 500 * PERIOD);
    assert!((link.queues.samples.dequeue().unwrap().sample.displacement - 3.0).abs() < 0.1);
    assert_eq!(link.telemetry.bias.age_ticks(), Some(0));
    let zeroed = link.telemetry.bias.um();
    for k in 501..511 {
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    assert_eq!(link.telemetry.bias.age_ticks(), Some(10));
    link.telemetry.forget();
    assert_eq!(link.telemetry.bias.um(), zeroed, "the bias is no count");
    link.queues.commands.enqueue(Command::ShiftBias { by_um: -0.5 }).unwrap();
    tick.sample(triangle(511).into(), 511 * PERIOD);
    assert!((link.telemetry.bias.um() - (zeroed - 0.5)).abs() < 1e-5);
    assert_eq!(link.telemetry.bias.age_ticks(), Some(0));
    link.queues.commands.enqueue(Command::SetMode(Mode::Pause)).unwrap();
    tick.sample(triangle(512).into(), 512 * PERIOD);
    assert_eq!((link.telemetry.bias.um(), link.telemetry.bias.age_ticks()), (0.0, None));
}

/// Whoever has zeroed at rest wants to know where the actuator is while it is driven, not only before.
#[test]
fn the_estimate_and_its_zero_go_on_from_mode_to_mode_unless_something_is_wrong() {
    let table = driving();
    let (mut tick, mut link) = tick(Some(&table), Faults::empty());
    let mut reference = Estimator::<f32>::new(&table);
    link.telemetry.streaming.store(true, Relaxed);
    let mut k = 0;
    let mut next = |link: &mut LinkEnd, command: Option<Command>, code: AdcCode| {
        command.into_iter().for_each(|command| link.queues.commands.enqueue(command).unwrap());
        tick.sample(code.into(), k * PERIOD);
        k += 1;
        link.queues.samples.dequeue().map(|found| found.sample)
    };
    let told = |link: &LinkEnd| link.telemetry.bias.age_ticks().is_some();
    for code in 0..3_000 {
        reference.tick(triangle(code));
        next(&mut link, None, triangle(code));
    }
    reference.set_zero(2.0);
    next(&mut link, Some(Command::SetZero { at_um: 2.0 }), triangle(3_000));
    reference.tick(triangle(3_000));
    for (index, mode) in [Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Estimate].into_iter().enumerate() {
        // All three that drive no longer than an amplifier may be elsewhere than it is commanded to.
        for code in 0..50 {
            let code = 3_001 + 50 * index as u32 + code;
            let command = (code % 50 == 1).then_some(Command::SetMode(mode));
            let sample = next(&mut link, command, triangle(code)).expect("a sample a tick");
            assert_eq!(
                sample.displacement.to_bits(),
                reference.tick(triangle(code)).displacement.to_bits(),
                "{mode:?}"
            );
        }
        assert!(told(&link), "{mode:?}");
    }
    // A code that stands still is a fault, after which nothing of before is known.
    (0..STUCK + 10).for_each(|_| _ = next(&mut link, None, triangle(7)));
    assert!(link.telemetry.faults().contains(Faults::ADC_STUCK) && told(&link));
    // The mode is no cause of it: it passes with the code that stood still.
    next(&mut link, Some(Command::SetMode(Mode::Estimate)), triangle(7));
    assert!(link.telemetry.faults().contains(Faults::ADC_STUCK) && told(&link));
    (0..HOLD + 1).for_each(|k| _ = next(&mut link, None, triangle(8 + k)));
    assert!(!told(&link));
    // What is fed is no actuator's.
    for mode in [Mode::Pil, Mode::Pause] {
        next(&mut link, Some(Command::SetZero { at_um: 1.0 }), triangle(9));
        assert!(told(&link));
        next(&mut link, Some(Command::SetMode(mode)), triangle(10));
        assert!(!told(&link), "{mode:?}");
        next(&mut link, Some(Command::SetMode(Mode::Estimate)), triangle(11));
    }
}

#[test]
fn a_zero_that_comes_with_a_code_not_to_be_believed_is_not_taken() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    let table = compiled();
    let zeroed = |tick: &mut Tick<'_>, link: &mut LinkEnd, k: u32, before: AdcCode| {
        tick.sample(before.into(), k * PERIOD);
        link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).unwrap();
        tick.sample(triangle(900).into(), (k + 1) * PERIOD);
        link.telemetry.bias.age_ticks().is_some()
    };
    for (k, odd) in
        [AdcCode(0), AdcCode(65_520), table.adc.code(table.voltage_range_v.max + 0.02)].into_iter().enumerate()
    {
        assert!(!zeroed(&mut tick, &mut link, 2 * k as u32, odd), "{odd:?}");
    }
    assert!(zeroed(&mut tick, &mut link, 6, triangle(900)));
}

#[test]
fn a_zero_that_is_lost_is_said_without_valid_until_it_is_told_anew() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    let mut k = 0;
    let mut run = |tick: &mut Tick<'_>, link: &mut LinkEnd, ticks: u32, code: &dyn Fn(u32) -> AdcCode| {
        for _ in 0..ticks {
            k += 1;
            tick.sample(code(k).into(), k.wrapping_mul(PERIOD));
        }
        (link.telemetry.faults(), tick.valid())
    };
    let saturated = |_| AdcCode(65_520);
    let good = (Faults::empty(), true);
    let zero = |link: &mut LinkEnd| link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).unwrap();
    let set = |link: &mut LinkEnd, mode| link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
    // None was told: a fault that has passed leaves nothing.
    run(&mut tick, &mut link, 2 * SATURATED, &saturated);
    assert_eq!(run(&mut tick, &mut link, 2 * HOLD, &triangle), good);
    zero(&mut link);
    assert_eq!(run(&mut tick, &mut link, 10, &triangle), good);
    run(&mut tick, &mut link, 2 * SATURATED, &saturated);
    for ticks in [2 * HOLD, 100 * HOLD] {
        assert_eq!(run(&mut tick, &mut link, ticks, &triangle), (Faults::ZERO_LOST, false));
    }
    zero(&mut link);
    assert_eq!(run(&mut tick, &mut link, 1, &triangle), good);
    // A pause loses it as well; fed codes have a zero of their own, which is over with them.
    set(&mut link, Mode::Pause);
    run(&mut tick, &mut link, 1, &triangle);
    set(&mut link, Mode::Pil);
    zero(&mut link);
    link.queues.fed.enqueue(triangle(900)).unwrap();
    run(&mut tick, &mut link, 10, &triangle);
    set(&mut link, Mode::Estimate);
    assert_eq!(run(&mut tick, &mut link, 10, &triangle), (Faults::ZERO_LOST, false));
    zero(&mut link);
    assert_eq!(run(&mut tick, &mut link, 1, &triangle), good);
}
