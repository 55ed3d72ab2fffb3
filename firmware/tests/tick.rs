//! The tick's contract.

mod common;

use common::{FACTS, LinkEnd, PERIOD, SAFE, compiled, driving, started_on, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Estimator, Status};
use firmware::queues::Command;
use firmware::restarts::{Restarts, TOO_MANY};
use firmware::startup::Startup;
use firmware::supply::Measured;
use firmware::telemetry::STALLED;
use firmware::watch::{HOLD, OUT_OF_RANGE, SATURATED, STUCK};
use firmware::{Conversion, Facts};
use protocol::{Faults, Mode};

#[test]
fn it_is_the_core_s_estimator_and_its_samples_are_numbered() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    let mut reference = Estimator::<f32>::new(&compiled());
    link.telemetry.streaming.store(true, Relaxed);
    for k in 0..5_000 {
        let expected = reference.tick(triangle(k));
        assert_eq!(tick.sample(triangle(k).into(), k * PERIOD).0, expected.dac.0);
        let found = link.queues.samples.dequeue().expect("a sample a tick");
        assert_eq!((found.tick, found.sample.code), (k, triangle(k).0));
        assert_eq!(found.sample.displacement.to_bits(), expected.displacement.to_bits());
        assert_eq!((found.sample.status, found.sample.faults), (expected.status, Faults::empty()));
    }
    assert_eq!(link.telemetry.ticks.load(Relaxed), 5_000);
    assert_eq!((link.telemetry.missed.load(Relaxed), link.telemetry.faults_seen()), (0, Faults::empty()));
}

#[test]
fn nobody_reading_costs_samples_never_ticks() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    for k in 0..10 {
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    assert!(link.queues.samples.dequeue().is_none(), "nobody asked for samples");
    link.telemetry.streaming.store(true, Relaxed);
    for k in 10..1_010 {
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    let kept = std::iter::from_fn(|| link.queues.samples.dequeue()).count() as u32;
    assert_eq!(kept + link.telemetry.dropped.load(Relaxed), 1_000);
    tick.sample(triangle(0).into(), 1_010 * PERIOD);
    assert_eq!(link.queues.samples.dequeue().map(|next| next.tick), Some(1_010), "the gap shows in the numbers");
}

#[test]
fn missed_ticks_are_counted_and_said_and_skipped_in_the_numbers() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    link.telemetry.streaming.store(true, Relaxed);
    // On time, on time, an eighth late, two lost, on time; the counter wraps on the way.
    let mut now = u32::MAX - 2 * PERIOD;
    for (elapsed, missed, fault, number) in [
        (0, 0, false, 0),
        (PERIOD, 0, false, 1),
        (PERIOD + PERIOD / 8, 0, false, 2),
        (PERIOD + PERIOD / 8 + 1, 1, true, 3),
        (3 * PERIOD, 3, true, 6),
        (PERIOD, 3, false, 7),
    ] {
        now = now.wrapping_add(elapsed);
        tick.sample(moving(number).into(), now);
        assert_eq!(link.telemetry.missed.load(Relaxed), missed);
        let found = link.queues.samples.dequeue().unwrap();
        assert_eq!(found.sample.faults, if fault { Faults::MISSED_DEADLINE } else { Faults::empty() });
        assert_eq!(found.tick, number, "what was lost shows as a gap");
    }
    assert_eq!(link.telemetry.faults_seen(), Faults::MISSED_DEADLINE);
    link.telemetry.forget();
    assert_eq!((link.telemetry.missed.load(Relaxed), link.telemetry.faults_seen()), (0, Faults::empty()));
    link.telemetry.took(50, true);
    tick.sample(moving(1).into(), now.wrapping_add(PERIOD));
    assert_eq!(link.telemetry.missed.load(Relaxed), 0);
    link.telemetry.took(50, false);
    tick.sample(moving(2).into(), now.wrapping_add(2 * PERIOD));
    assert_eq!(link.telemetry.missed.load(Relaxed), 1, "a tick that was not done in time");
}

/// Its codes would be an amplifier's input.
#[test]
fn a_table_that_drives_shows_no_displacement_where_it_is_not_to_drive() {
    let facts = Facts { restarts: Restarts { count: TOO_MANY, ..Restarts::NONE }, ..FACTS };
    let startup = Startup::new(Some(&driving()), &facts, Faults::empty());
    assert!(startup.dac.drive().is_none());
    let (mut tick, link) = started_on(&facts, startup);
    let safe = link.telemetry.safe();
    for k in 0..3_000 {
        assert_eq!(tick.sample(triangle(k).into(), k * PERIOD).0, safe.0, "tick {k}");
    }
}

/// The estimate is stale by then, and the zero that was told is lost with it.
#[test]
fn a_gap_of_20_ms_is_a_fault_for_a_second_unless_the_board_is_emulated() {
    for emulated in [false, true] {
        let facts = Facts { emulated, ..FACTS };
        let (mut tick, mut link) = started_on(&facts, Startup::new(Some(&compiled()), &facts, Faults::empty()));
        let mut now = 0u32;
        let mut after = |periods: u32| {
            now = now.wrapping_add(periods * PERIOD);
            tick.sample(moving(now / PERIOD).into(), now);
            link.telemetry.faults()
        };
        assert_eq!(after(1), Faults::empty());
        link.queues.commands.enqueue(Command::SetZero { at_um: 1.0 }).unwrap();
        assert_eq!(after(1), Faults::empty());
        assert!(link.telemetry.bias.age_ticks().is_some(), "it is told");
        assert_eq!(after(40).contains(Faults::SAFE_OUTPUT), !emulated);
        let lasting = (0..3_000).take_while(|_| after(1).contains(Faults::SAFE_OUTPUT)).count();
        assert_eq!(lasting, if emulated { 0 } else { HOLD as usize });
        assert_eq!(link.telemetry.faults().contains(Faults::ZERO_LOST), !emulated);
    }
}

/// A code in the middle of the range that does not stand still.
fn moving(k: u32) -> AdcCode {
    AdcCode(30_000 + (k % 2) as u16)
}

#[test]
fn a_lasting_fault_sends_the_dac_to_its_safe_value_until_a_second_after_its_end() {
    let beyond = compiled().adc.code(compiled().voltage_range_v.max + 0.02);
    let jitter = |k: u32| AdcCode(beyond.0 + (k % 2) as u16);
    type Codes<'c> = &'c dyn Fn(u32) -> AdcCode;
    let cases: [(u32, Faults, Codes<'_>); 3] = [
        (SATURATED, Faults::ADC_SATURATED, &|k| AdcCode(65_520 - (k % 2) as u16 * 65_520)),
        (OUT_OF_RANGE, Faults::OUT_OF_CALIBRATION, &jitter),
        (STUCK, Faults::ADC_STUCK, &|_| AdcCode(30_000)),
    ];
    for (limit, fault, code) in cases {
        let (mut tick, link) = tick(Some(&compiled()), Faults::empty());
        let mut now = 0;
        let mut step = |code: AdcCode| {
            now += PERIOD;
            tick.sample(code.into(), now)
        };
        step(moving(1));
        for k in 0..limit - 1 {
            assert_ne!(step(code(k)), SAFE, "{fault:?} after {k} ticks");
        }
        let last = (limit..limit + 3).map(|k| step(code(k))).last();
        assert_eq!(last, Some(SAFE), "{fault:?}");
        assert!(link.telemetry.faults().contains(fault | Faults::SAFE_OUTPUT));
        let mut reference = Estimator::<f32>::new(&compiled());
        for k in 1..HOLD {
            assert_eq!(step(moving(k)), SAFE, "{fault:?} has ended {k} ticks ago");
        }
        assert_eq!(step(moving(HOLD)), SAFE, "{fault:?}: the last tick of what is forgotten");
        assert_eq!(step(moving(1)).0, reference.tick(moving(1)).dac.0, "the estimate has started anew");
        assert_eq!(link.telemetry.faults(), Faults::empty());
        assert!(link.telemetry.faults_seen().contains(fault), "and is remembered");
    }
}

#[test]
fn a_supply_out_of_tolerance_is_a_fault_until_a_second_after() {
    let (mut tick, link) = tick(Some(&compiled()), Faults::empty());
    let (mut k, mut measured) = (0, Measured::default());
    let mut safe_ticks = |mv, ticks| {
        measured.take(mv);
        link.telemetry.supply.publish(&measured);
        (0..ticks)
            .filter(|_| {
                k += 1;
                tick.sample(triangle(k).into(), k * PERIOD) == SAFE
            })
            .count()
    };
    assert_eq!(safe_ticks(Some(3300.0), 500), 0);
    assert_eq!(safe_ticks(Some(3100.0), 500), 0, "one alone may be a disturbance");
    assert_eq!(safe_ticks(Some(3300.0), 500), 0);
    assert_eq!(safe_ticks(Some(3100.0), 40), 0);
    assert_eq!(safe_ticks(Some(3100.0), 500), 500, "two in a row are none");
    assert_eq!(safe_ticks(Some(3300.0), 4_000), HOLD as usize);
    assert_eq!(safe_ticks(None, 500), 0, "what cannot be measured is not known to be wrong");
}

#[test]
fn a_supply_out_of_tolerance_at_the_start_is_believed_at_once() {
    let (mut tick, link) = tick(Some(&compiled()), Faults::empty());
    link.telemetry.supply.publish(&Measured::of(Some(3100.0)));
    assert!((0..100).all(|k| tick.sample(triangle(k).into(), k * PERIOD) == SAFE));
}

#[test]
fn without_a_table_or_with_another_than_the_stored_one_the_dac_is_safe_for_good() {
    for (table, standing, fault) in
        [(None, Faults::empty(), Faults::NO_TABLE), (Some(compiled()), Faults::TABLE_FALLBACK, Faults::TABLE_FALLBACK)]
    {
        let (mut tick, link) = tick(table.as_ref(), standing);
        for k in 0..100 {
            assert_eq!(tick.sample(triangle(k).into(), k * PERIOD), SAFE);
            assert_eq!(link.telemetry.faults(), fault | Faults::SAFE_OUTPUT);
        }
    }
}

#[test]
fn fed_codes_are_estimated_one_a_tick_and_leave_the_output_alone() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    for k in 0..100 {
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    link.queues.commands.enqueue(Command::SetMode(Mode::Pil)).unwrap();
    tick.sample(triangle(100).into(), 100 * PERIOD);
    assert_eq!((link.telemetry.mode(), link.telemetry.epoch.load(Relaxed)), (Mode::Pil, 1));
    link.telemetry.streaming.store(true, Relaxed);
    let mut reference = Estimator::<f32>::new(&compiled());
    for k in 0..300 {
        if k % 3 != 0 {
            link.queues.fed.enqueue(triangle(7 * k)).unwrap();
        }
        let unread = Conversion { monitor: triangle(k), sensor: Some(AdcCode(9)), setpoint: None };
        assert_eq!(tick.sample(unread, (101 + k) * PERIOD), SAFE);
        match link.queues.samples.dequeue() {
            None => assert_eq!(k % 3, 0),
            Some(found) => {
                let expected = reference.tick(triangle(7 * k));
                assert_eq!(found.sample.displacement.to_bits(), expected.displacement.to_bits());
                assert_eq!((found.sample.code, found.sample.sensor), (triangle(7 * k).0, None), "what was fed");
                assert_eq!(found.sample.status & Status::ADC_SATURATED, Status::empty());
                assert_eq!(found.tick, k - k / 3 - 1, "numbered from 0 since the mode was set");
            }
        }
    }
    for (mode, estimates) in [(Mode::Pause, false), (Mode::Estimate, true)] {
        link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
        let dac = tick.sample(triangle(500).into(), 401 * PERIOD);
        assert_eq!((dac != SAFE, link.queues.samples.dequeue().is_some()), (estimates, estimates), "{mode:?}");
    }
}

/// A log may rest for longer than an ADC can, and go where its table does not.
#[test]
fn fed_codes_are_no_sign_of_the_adc_s_health() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    link.queues.commands.enqueue(Command::SetMode(Mode::Pil)).unwrap();
    tick.sample(triangle(0).into(), 0);
    link.telemetry.streaming.store(true, Relaxed);
    let mut reference = Estimator::<f32>::new(&compiled());
    let lasts = |code: u16, ticks: u32| (0..ticks).map(move |_| AdcCode(code));
    let log = lasts(30_000, 2 * STUCK).chain(lasts(65_520, 2 * OUT_OF_RANGE)).chain((0..3 * HOLD).map(moving));
    for (code, k) in log.zip(1..) {
        link.queues.fed.enqueue(code).unwrap();
        assert_eq!(tick.sample(AdcCode(0).into(), PERIOD.wrapping_mul(k)), SAFE);
        let found = link.queues.samples.dequeue().expect("a sample a tick").sample;
        let expected = reference.tick(code);
        assert_eq!(
            (found.displacement.to_bits(), found.status),
            (expected.displacement.to_bits(), expected.status),
            "{k}"
        );
        assert_eq!(found.faults, Faults::SAFE_OUTPUT);
    }
}

/// A host that sets modes again and again would otherwise never hear of it.
#[test]
fn a_monitor_that_stands_still_is_found_across_modes() {
    let (mut tick, mut link) = tick(Some(&driving()), Faults::empty());
    let mut stands = |link: &mut LinkEnd, ticks: std::ops::Range<u32>| {
        ticks.for_each(|k| _ = tick.sample(triangle(7).into(), k * PERIOD));
        link.telemetry.faults().contains(Faults::ADC_STUCK)
    };
    assert!(!stands(&mut link, 0..STUCK - 10));
    link.queues.commands.enqueue(Command::SetMode(Mode::Estimate)).unwrap();
    assert!(stands(&mut link, STUCK - 10..STUCK + 10));
}

#[test]
fn no_mode_that_is_set_ends_a_fault_of_what_the_converter_reads() {
    let beyond = driving().adc.code(driving().voltage_range_v.max + 0.02);
    type Codes<'c> = &'c dyn Fn(u32) -> AdcCode;
    let cases: [(Faults, Codes<'_>); 3] = [
        (Faults::ADC_SATURATED, &|k| AdcCode(65_520 - (k % 2) as u16)),
        (Faults::OUT_OF_CALIBRATION, &|k| AdcCode(beyond.0 + (k % 2) as u16)),
        (Faults::ADC_STUCK, &|_| AdcCode(30_000)),
    ];
    for (fault, code) in cases {
        let (mut tick, mut link) = tick(Some(&driving()), Faults::empty());
        let mut k = 0;
        let mut run = |link: &mut LinkEnd, ticks: u32, code: Codes<'_>| {
            for _ in 0..ticks {
                k += 1;
                tick.sample(code(k).into(), k.wrapping_mul(PERIOD));
                assert!(!tick.valid(), "{fault:?}: tick {k} in {:?}", link.telemetry.mode());
            }
            link.telemetry.faults().contains(fault)
        };
        assert!(run(&mut link, STUCK + OUT_OF_RANGE, code));
        for mode in [Mode::Estimate, Mode::Follow, Mode::Pause, Mode::Estimate, Mode::Pil, Mode::Excite, Mode::Estimate]
        {
            link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
            assert!(run(&mut link, 1, code), "{fault:?} in {mode:?}, at once");
            assert!(run(&mut link, HOLD / 2, code), "{fault:?} in {mode:?}");
        }
        // Nor does it outlast its cause by more in one mode than in another.
        link.queues.commands.enqueue(Command::SetMode(Mode::Pause)).unwrap();
        assert!(run(&mut link, HOLD / 2, &moving));
        link.queues.commands.enqueue(Command::SetMode(Mode::Estimate)).unwrap();
        assert!(run(&mut link, HOLD / 2 - 1, &moving));
        assert!(!run(&mut link, SATURATED, &moving), "{fault:?}");
    }
}

#[test]
fn what_is_fed_counts_as_nothing_of_the_actuator() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    link.queues.commands.enqueue(Command::SetMode(Mode::Pil)).unwrap();
    for k in 0..10 {
        link.queues.fed.enqueue(AdcCode(0)).unwrap();
        tick.sample(triangle(k).into(), k * PERIOD);
    }
    let health = [&link.telemetry.voltage_out_of_range, &link.telemetry.adc_saturated];
    assert_eq!(health.map(|count| count.load(Relaxed)), [0, 0]);
}

#[test]
fn a_main_loop_that_goes_on_after_all_ends_the_fault_a_second_later_and_costs_no_zero() {
    let (mut tick, mut link) = tick(Some(&compiled()), Faults::empty());
    let mut k = 0;
    let mut next = |link: &LinkEnd, beats: bool| {
        if beats {
            link.telemetry.beat();
        }
        k += 1;
        let dac = tick.sample(triangle(k).into(), k * PERIOD);
        (dac, link.telemetry.faults(), tick.valid())
    };
    (0..500).for_each(|_| assert!(next(&link, true).2));
    link.queues.commands.enqueue(Command::SetZero { at_um: 3.0 }).unwrap();
    (1..STALLED).for_each(|_| assert!(next(&link, false).2));
    let safe = (SAFE, Faults::STALLED | Faults::SAFE_OUTPUT, false);
    // A little more than the limit, and not there and straight back.
    (0..10).for_each(|_| assert_eq!(next(&link, false), safe));
    (0..HOLD).for_each(|tick| assert_eq!(next(&link, true), safe, "tick {tick}"));
    for _ in 0..100 {
        let (_, faults, valid) = next(&link, true);
        assert!(faults.is_empty() && valid, "{faults:?}");
    }
    assert_eq!(link.telemetry.bias.age_ticks(), Some(STALLED + 10 + HOLD + 98), "the estimate went on meanwhile");
}
