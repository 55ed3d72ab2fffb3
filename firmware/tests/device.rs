//! What the device answers, and which table it starts with.

mod common;

use common::{
    FACTS, LinkEnd, PERIOD, SAFE, compiled, driving, linearising, other, record, started, tick, too_long, triangle,
};
use core::sync::atomic::Ordering::Relaxed;
use embassy_futures::block_on;
use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Timer};
use estimator_core::interval::{PLAYS, PROTOTYPES, SPANS, TRIANGLE};
use estimator_core::{AdcCode, Admitted, DacCode, IntervalParameters, Table};
use firmware::boot::{self, Chosen};
use firmware::drive::Drive;
use firmware::link::{Device, Taken};
use firmware::queues::Command;
use firmware::restarts::{Restarts, TOO_MANY};
use firmware::startup::Startup;
use firmware::table::TABLE;
use firmware::{Conversion, Facts, Tick};
use parameter_store::{ParameterStore, RamFlash};
use protocol::{Faults, Mode, Refusal, Reply, Request, ResetCause, TableSource, text};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU16};

type Flash = RamFlash<&'static mut [u8]>;

fn flash(memory: Vec<u8>) -> ParameterStore<Flash> {
    let pages = 0..memory.len() as u32;
    ParameterStore::new(RamFlash::new(memory.leak()), pages).unwrap()
}

/// A device whose ticks run in a thread, ten times as fast as they should, until it is dropped.
struct Bench {
    device: Device<'static, Flash>,
    stop: Arc<AtomicBool>,
}

impl Drop for Bench {
    fn drop(&mut self) {
        self.stop.store(true, Relaxed);
    }
}

impl Bench {
    fn new(table: Option<Admitted>) -> Self {
        Self::of(table, tick(table.as_ref(), Faults::empty()))
    }

    /// A device that has this tick.
    fn of(table: Option<Admitted>, tick: (Tick<'static>, LinkEnd)) -> Self {
        Self::with(table, tick, |k, _| triangle(k).into())
    }

    /// A device that follows a set-point from its start on, whose controller gives this code, but for noise, and whose amplifier
    /// does what it is told.
    fn controlled(code: Arc<AtomicU16>) -> Self {
        let table = linearising(true);
        let tick = started(Startup::new(Some(&table), &FACTS, false));
        Self::with(Some(table), tick, move |k, dac| {
            let noise = (k % 2) as u16;
            let AdcCode(monitor) = table.adc.code(table.drive.unwrap().voltage::<f32>(dac));
            let setpoint = Some(AdcCode(code.load(Relaxed) + noise));
            Conversion { monitor: AdcCode(monitor + noise), sensor: None, setpoint }
        })
    }

    /// A device whose converter gives this, by the tick's number and what the DAC puts out.
    fn with(
        table: Option<Admitted>,
        (mut tick, rest): (Tick<'static>, LinkEnd),
        conversion: impl Fn(u32, DacCode) -> Conversion + Send + 'static,
    ) -> Self {
        rest.telemetry.set_supply(FACTS.supply_mv, FACTS.supply_good);
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let mut dac = rest.telemetry.safe();
        std::thread::spawn(move || {
            for k in 0.. {
                if stopped.load(Relaxed) {
                    return;
                }
                dac = tick.sample(conversion(k, dac), k.wrapping_mul(PERIOD));
                std::thread::sleep(std::time::Duration::from_micros(50));
            }
        });
        Self { device: Self::device(table, rest), stop }
    }

    /// A device whose ticks the test runs.
    fn still(table: Option<Admitted>, rest: LinkEnd) -> Self {
        Self { device: Self::device(table, rest), stop: Arc::default() }
    }

    fn device(table: Option<Admitted>, rest: LinkEnd) -> Device<'static, Flash> {
        Device {
            facts: FACTS,
            table,
            source: TableSource::Compiled { reason: text("no table is stored") },
            last_words: Some(text("panicked")),
            store: flash(vec![0xFF; 4096]),
            telemetry: rest.telemetry,
            queues: rest.queues,
            frames_refused: 4,
            read_errors: 5,
            referred: Taken::default(),
        }
    }

    /// Until these faults are there, or these alone where there are none.
    fn until(&self, faults: Faults) {
        let started = std::time::Instant::now();
        let now = || self.device.telemetry.faults();
        // Before the first tick nothing is known to be wrong.
        std::thread::sleep(TICKS);
        while if faults.is_empty() { !now().is_empty() } else { !now().contains(faults) } {
            assert!(started.elapsed().as_secs() < 20, "{faults:?} do not come, there are {:?}", now());
            std::thread::sleep(TICKS);
        }
    }

    fn ask(&mut self, request: Request) -> Reply {
        block_on(self.device.answer(request))
    }

    fn stored(&mut self) -> Option<Vec<u8>> {
        block_on(self.device.store.load()).unwrap().map(<[u8]>::to_vec)
    }
}

fn push(table: &Admitted, while_estimating: bool) -> Request {
    Request::Push { record: record(table), while_estimating, rewired: false }
}

#[test]
fn a_table_is_written_when_nothing_is_estimated_or_when_told_to() {
    let mut bench = Bench::new(Some(compiled()));
    assert_eq!(bench.ask(push(&other(), false)), Reply::Refused(Refusal::Estimating));
    assert_eq!(
        bench.ask(Request::Erase { while_estimating: false, rewired: false }),
        Reply::Refused(Refusal::Estimating)
    );
    assert_eq!(bench.stored(), None);
    assert_eq!(bench.ask(push(&other(), true)), Reply::Done);
    assert_eq!(bench.stored(), Some(record(&other()).to_vec()));
    assert_eq!(bench.ask(Request::Pull), Reply::Table(record(&compiled())), "it is used from the next reset on");
    for mode in [Mode::Pause, Mode::Pil] {
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Done);
        assert_eq!(bench.ask(push(&compiled(), false)), Reply::Done);
        assert_eq!(bench.stored(), Some(record(&compiled()).to_vec()));
        assert_eq!(bench.ask(Request::Erase { while_estimating: false, rewired: false }), Reply::Done);
        assert_eq!(bench.stored(), None);
    }
}

#[test]
fn what_it_cannot_run_is_refused_and_the_old_table_stays() {
    let mut bench = Bench::new(Some(compiled()));
    assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
    assert_eq!(bench.ask(push(&other(), false)), Reply::Done);
    let change = |edit: fn(&mut Table)| {
        let mut table = *compiled();
        edit(&mut table);
        record(&table.admit().expect("still admissible"))
    };
    let mut corrupt = record(&compiled());
    corrupt[40] ^= 1;
    let refused = [
        (corrupt, "corrupt"),
        (record(&compiled())[..60].iter().copied().collect(), "truncated"),
        (Default::default(), "truncated"),
        (change(|table| table.adc.full_scale = 4095), "an ADC up to 4095, not 65520"),
        (change(|table| table.dac.full_scale = 65_535), "a DAC up to 65535, not 4095"),
        (change(|table| table.sample_period_us = 400), "a tick of 400 µs, not 500 µs"),
        (record(&too_long()), "driving takes up to 106500 cycles a tick, 125 % of its time, not 60 % at most"),
    ];
    for (bad, why) in refused {
        match bench.ask(Request::Push { record: bad, while_estimating: false, rewired: false }) {
            Reply::Refused(Refusal::Table(reason)) => assert!(reason.contains(why), "{reason} / {why}"),
            reply => panic!("{why}: {reply:?}"),
        }
        assert_eq!(bench.stored(), Some(record(&other()).to_vec()));
    }
}

#[test]
fn it_says_who_and_how_it_is() {
    let mut bench = Bench::new(Some(compiled()));
    let Reply::Identity(identity) = bench.ask(Request::Identify) else { panic!() };
    assert_eq!((&*identity.board, identity.tick_us, identity.adc_full_scale), ("bench", 500, 65_520));
    assert_eq!(identity.model, "Voigt (4.8)");
    assert_eq!(identity.source, TableSource::Compiled { reason: text("no table is stored") });
    let checksum = |table: &Admitted| estimator_core::record::checksum(&record(table)).unwrap();
    assert_eq!(identity.table_crc, checksum(&compiled()));
    assert_ne!(identity.table_crc, checksum(&other()));
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert_eq!((health.reset, health.supply_mv, health.flash_errors), (ResetCause::WATCHDOG, Some(3301), 3));
    assert_eq!((health.frames_refused, health.line_errors), (4, 5));
    assert_eq!(health.last_words.unwrap(), "panicked");
    assert_eq!(bench.ask(Request::Forget), Reply::Done);
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert_eq!((health.frames_refused, health.line_errors, health.last_words), (0, 0, None));
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done, "which takes a tick");
    assert_eq!(bench.ask(Request::Reset), Reply::Resetting { in_ms: 0 }, "it drives nothing");
    let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
    assert!(health.ticks > 0);
    let mut empty = Bench::new(None);
    assert_eq!(empty.ask(Request::Pull), Reply::Refused(Refusal::NoTable));
    assert_eq!(empty.ask(push(&compiled(), false)), Reply::Done, "without a table nothing is estimated");
}

/// Longer than a tick, after which a command is obeyed.
const TICKS: std::time::Duration = std::time::Duration::from_millis(20);

/// The compiled table with an interval that is told an hour after the start at the earliest.
fn late() -> Admitted {
    let mut spread_um = [0.0; TRIANGLE];
    (0..PLAYS).for_each(|row| spread_um[row * (row + 3) / 2] = 0.2);
    let interval = IntervalParameters {
        memory_um: [0.0; SPANS],
        misfit_um: 0.1,
        rate_ticks: 1.0,
        spread_um,
        prototypes: [[0; PLAYS]; PROTOTYPES],
        prototype_um: 0.01,
        untrained_um: 0.1,
        gain: 0.02,
        drift_um: 0.05,
        earliest_s: 3_600.0,
    };
    Table { interval: Some(interval), ..*compiled() }.admit().expect("every part of the interval has a size")
}

#[test]
fn the_bias_is_told_only_where_something_is_estimated_and_in_reason() {
    let span_um = compiled().displacement_limits_um.span();
    type Tell = fn(f32) -> Request;
    let ways: [Tell; 2] = [|at_um| Request::SetZero { at_um }, |by_um| Request::ShiftBias { by_um }];
    for tell in ways {
        let mut early = Bench::new(Some(late()));
        std::thread::sleep(TICKS);
        assert_eq!(early.ask(tell(0.0)), Reply::Refused(Refusal::TooSoon), "it has not run for an hour");
        let mut bench = Bench::new(Some(compiled()));
        std::thread::sleep(TICKS);
        assert_eq!(bench.ask(tell(-span_um)), Reply::Done);
        for odd in [f32::NAN, f32::NEG_INFINITY, 1.01 * span_um] {
            assert_eq!(bench.ask(tell(odd)), Reply::Refused(Refusal::BeyondSpan { span_um }));
        }
        assert_eq!(bench.ask(Request::SetMode(Mode::Pause)), Reply::Done);
        assert_eq!(bench.ask(tell(0.0)), Reply::Refused(Refusal::NotEstimating));
        assert_eq!(Bench::new(None).ask(tell(0.0)), Reply::Refused(Refusal::NotEstimating));
        let mut excited = Bench::new(Some(driving()));
        assert_eq!(excited.ask(Request::SetMode(Mode::Excite)), Reply::Done);
        std::thread::sleep(TICKS);
        assert_eq!(excited.ask(tell(1.0)), Reply::Done, "the sensor beside it says where it is");
    }
}

#[test]
fn health_has_the_bias_and_its_age() {
    let mut bench = Bench::new(Some(compiled()));
    let bias = |bench: &mut Bench| {
        std::thread::sleep(TICKS);
        let Reply::Health(health) = bench.ask(Request::Health) else { panic!() };
        (health.bias_um, health.bias_age_ticks)
    };
    assert_eq!(bias(&mut bench), (0.0, None));
    assert_eq!(bench.ask(Request::ShiftBias { by_um: 1.5 }), Reply::Done);
    let (um, age) = bias(&mut bench);
    assert!(um == 1.5 && age.is_some(), "{um} {age:?}");
    assert!(bias(&mut bench).1 > age, "it grows old");
    assert_eq!(bench.ask(Request::SetMode(Mode::Estimate)), Reply::Done);
    assert_eq!(bias(&mut bench), (0.0, None));
}

#[test]
fn codes_are_taken_in_their_mode_and_as_many_as_there_is_room() {
    let mut bench = Bench::new(Some(compiled()));
    let codes = || Request::Feed([30_000; 64].iter().copied().collect());
    assert_eq!(bench.ask(codes()), Reply::Refused(Refusal::NotPil));
    assert_eq!(bench.ask(Request::SetMode(Mode::Pil)), Reply::Done);
    let mut taken = 0;
    // Much faster than ticks: the queue fills.
    let full = (0..1_000).any(|_| match bench.ask(codes()) {
        Reply::Fed(64) => {
            taken += 64;
            false
        }
        Reply::Fed(some) => {
            taken += usize::from(some);
            true
        }
        reply => panic!("{reply:?}"),
    });
    assert!(full && taken >= 255, "{taken}");
}

#[test]
fn references_are_taken_where_the_dac_drives_and_are_numbers() {
    let refer = |first, wanted: f32| {
        let references = [wanted; 64].iter().copied().collect();
        Request::Refer { first, references, go: false, hold: false }
    };
    let mut plain = Bench::new(Some(compiled()));
    let mut bench = Bench::new(Some(driving()));
    assert_eq!(bench.ask(refer(0, 10.0)), Reply::Refused(Refusal::NotFollowing));
    for mode in [Mode::Excite, Mode::Follow] {
        assert_eq!(plain.ask(Request::SetMode(mode)), Reply::Refused(Refusal::NoDrive));
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Done);
        for odd in [f32::NAN, f32::INFINITY] {
            assert_eq!(bench.ask(refer(0, odd)), Reply::Refused(Refusal::NotFinite));
        }
        assert_eq!(bench.ask(push(&driving(), false)), Reply::Refused(Refusal::Estimating), "flash may cost ticks");
        assert!(bench.device.lent(), "{mode:?} ends with the host that has set it");
        assert_eq!(bench.ask(refer(0, 2.0)), Reply::Referred { next: 64, starved: 0 }, "{mode:?} counts from 0");
    }
    assert_eq!(
        bench.ask(Request::SetZero { at_um: 0.0 }),
        Reply::Refused(Refusal::NotEstimating),
        "references have the model's zero"
    );
    let next = |bench: &mut Bench, first| match bench.ask(refer(first, 10.0)) {
        Reply::Referred { next, starved: 0 } => next,
        reply => panic!("{reply:?}"),
    };
    for first in [64, 128, 192] {
        next(&mut bench, first);
    }
    assert_eq!(next(&mut bench, 255), 255, "nothing is taken before it is to go");
    assert_eq!(
        bench.ask(Request::Refer { first: 255, references: Default::default(), go: true, hold: true }),
        Reply::Referred { next: 255, starved: 0 }
    );
    let start = std::time::Instant::now();
    while next(&mut bench, 255) == 255 {
        assert!(start.elapsed() < std::time::Duration::from_secs(10), "ticks make room");
    }
}

/// A device that follows, and what runs so many of its ticks.
fn following() -> (Bench, impl FnMut(u32)) {
    let (mut tick, link) = started(Startup::new(Some(&driving()), &FACTS, false));
    let mut bench = Bench::still(Some(driving()), link);
    bench.device.queues.commands.enqueue(Command::SetMode(Mode::Follow)).unwrap();
    let mut clock = 0u32;
    let mut run = move |ticks: u32| {
        for _ in 0..ticks {
            tick.sample(triangle(clock).into(), clock.wrapping_mul(PERIOD));
            clock += 1;
        }
    };
    run(1);
    (bench, run)
}

#[test]
fn references_that_come_twice_are_taken_once_and_none_behind_a_gap() {
    let (mut bench, mut run) = following();
    let mut refer = |first, count, go| {
        let references = (first..first + count).map(|k| k as f32 * 1e-3).collect();
        match bench.ask(Request::Refer { first, references, go, hold: false }) {
            Reply::Referred { next, starved } => (next, starved),
            reply => panic!("{reply:?}"),
        }
    };
    assert_eq!(refer(0, 0, false), (0, 0), "how far it is");
    assert_eq!(refer(0, 20, true), (20, 0));
    assert_eq!(refer(0, 20, true), (20, 0), "its reply was lost");
    assert_eq!(refer(30, 10, true), (20, 0), "ten are missing");
    assert_eq!(refer(10, 20, true), (30, 0), "ten of them are new");
    // Thirty references, and five ticks that find none.
    run(35);
    assert_eq!(refer(10, 20, true), (30, 0), "as they were taken: nothing was starved");
    assert_eq!(refer(30, 10, true), (40, 5));
    run(12);
    assert_eq!(refer(20, 10, true), (40, 5), "a frame that is late");
    assert_eq!(refer(40, 1, true), (41, 7));
}

/// A host that dies behind a frame of which a part found no room leaves nothing on the way that is held.
#[test]
fn the_displacement_is_held_once_the_last_reference_is_in() {
    let (mut bench, mut run) = following();
    let mut taken = 0;
    let refer = |bench: &mut Bench, first: u32| {
        let references = (first..300).take(64).map(|k| k as f32 * 1e-3).collect();
        let last = first + 64 >= 300;
        match bench.ask(Request::Refer { first, references, go: last, hold: last }) {
            Reply::Referred { next, .. } => next,
            reply => panic!("{reply:?}"),
        }
    };
    for _ in 0..5 {
        taken = refer(&mut bench, taken);
    }
    assert!((236..300).contains(&taken), "the queue is full within the last frame: {taken}");
    run(60);
    assert!(!bench.device.telemetry.holding.load(Relaxed), "references are missing");
    assert_eq!(refer(&mut bench, taken), 300);
    run(1);
    assert!(bench.device.telemetry.holding.load(Relaxed));
}

#[test]
fn the_dac_is_not_rewired_by_a_table_alone() {
    let push = |table: &Admitted, rewired| Request::Push { record: record(table), while_estimating: true, rewired };
    let erase = |rewired| Request::Erase { while_estimating: true, rewired };
    let (mut plain, mut drives) = (Bench::new(Some(compiled())), Bench::new(Some(driving())));
    for (bench, table) in [(&mut plain, driving()), (&mut drives, compiled())] {
        assert_eq!(bench.ask(push(&table, false)), Reply::Refused(Refusal::Rewired));
        assert_eq!(bench.stored(), None);
        assert_eq!(bench.ask(push(&table, true)), Reply::Done);
    }
    assert_eq!(plain.ask(erase(false)), Reply::Done, "the compiled table has no drive either");
    assert_eq!(drives.ask(erase(false)), Reply::Refused(Refusal::Rewired));
    assert_eq!(drives.ask(erase(true)), Reply::Done);
}

#[test]
fn it_starts_with_the_newest_stored_table_else_the_compiled_else_none_and_says_why() {
    let choose = |store: &mut ParameterStore<Flash>, compiled: Table| block_on(boot::choose(store, compiled, &FACTS));
    let mut store = flash(vec![0xFF; 4096]);
    let Chosen { table, source, fallback } = choose(&mut store, TABLE);
    assert_eq!((table, source), (Some(compiled()), TableSource::Compiled { reason: text("no table is stored") }));
    assert!(!fallback, "nothing was lost");
    for _ in 0..30 {
        block_on(store.store(&record(&compiled()))).unwrap();
        block_on(store.store(&record(&other()))).unwrap();
    }
    let Chosen { table, source, fallback } = choose(&mut store, TABLE);
    assert_eq!((table, source, fallback), (Some(other()), TableSource::Stored, false));

    let failing = Facts { restarts: Restarts { count: TOO_MANY, safe: None }, ..FACTS };
    let Chosen { table, source, fallback } = block_on(boot::choose(&mut store, TABLE, &failing));
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(fallback && table == Some(compiled()) && reason.contains("failed 3 times"), "{reason}");

    // As an older firmware may have left it.
    block_on(store.store(&record(&too_long()))).unwrap();
    let Chosen { table, source, fallback } = choose(&mut store, TABLE);
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(fallback && table == Some(compiled()) && reason.contains("takes up to 106500 cycles"), "{reason}");

    block_on(store.store(b"PZTB\x63\x00\x00\x00and more")).unwrap();
    let Chosen { table, source, fallback } = choose(&mut store, TABLE);
    let TableSource::Compiled { reason } = source else { panic!("{source:?}") };
    assert!(fallback && table == Some(compiled()) && reason.contains("format version 99"), "{reason}");

    let Chosen { table, source, fallback } = choose(&mut store, Table { deadband_v: f32::NAN, ..TABLE });
    let TableSource::None { stored, compiled } = source else { panic!("{source:?}") };
    assert!(
        fallback && table.is_none() && stored.contains("format version 99") && compiled.contains("deadband_v"),
        "{compiled}"
    );
}

#[test]
fn a_set_point_is_followed_where_board_and_table_have_one_and_for_as_long_as_nobody_says_otherwise() {
    let linearise = Request::SetMode(Mode::Linearise);
    let mut without = Bench::new(Some(driving()));
    assert_eq!(without.ask(linearise.clone()), Reply::Refused(Refusal::NoSetpoint));
    let mut blind = Bench::new(Some(linearising(false)));
    blind.device.facts.has_setpoint = false;
    assert_eq!(blind.ask(linearise.clone()), Reply::Refused(Refusal::NoSetpointInput));
    let mut bench = Bench::new(Some(linearising(false)));
    assert_eq!(bench.ask(linearise), Reply::Done);
    assert!(bench.device.telemetry.mode() == Mode::Linearise && !bench.device.lent());
    let refer = Request::Refer { first: 0, references: [1.0].iter().copied().collect(), go: true, hold: true };
    assert_eq!(bench.ask(refer), Reply::Refused(Refusal::NotFollowing));
    assert_eq!(bench.ask(push(&linearising(true), false)), Reply::Refused(Refusal::Estimating));
}

#[test]
fn a_device_that_is_asked_again_for_its_set_point_goes_on_as_it_was() {
    let linearise = Request::SetMode(Mode::Linearise);
    let code = Arc::new(AtomicU16::new(0));
    let mut bench = Bench::controlled(code.clone());
    let goes_on = |bench: &mut Bench| {
        let epoch = bench.device.telemetry.epoch.load(Relaxed);
        assert_eq!(bench.ask(linearise.clone()), Reply::Done);
        std::thread::sleep(TICKS);
        assert_eq!(bench.device.telemetry.epoch.load(Relaxed), epoch, "nothing has changed");
    };
    bench.until(Faults::SETPOINT | Faults::SAFE_OUTPUT);
    goes_on(&mut bench);
    code.store(32_760, Relaxed);
    bench.until(Faults::empty());
    assert_eq!(bench.ask(Request::Stream(true)), Reply::Done);
    goes_on(&mut bench);
    assert!(bench.device.telemetry.faults().is_empty(), "it follows");
    assert!(bench.device.telemetry.streaming.load(Relaxed), "what is streamed goes on");
}

#[test]
fn a_fault_of_the_set_point_refuses_the_set_point_alone() {
    for mode in [Mode::Follow, Mode::Excite] {
        let code = Arc::new(AtomicU16::new(32_760));
        let mut bench = Bench::controlled(code.clone());
        bench.until(Faults::empty());
        code.store(0, Relaxed);
        bench.until(Faults::SETPOINT | Faults::SAFE_OUTPUT);
        assert_eq!(bench.ask(Request::SetMode(Mode::Linearise)), Reply::Refused(Refusal::Faulty));
        assert_eq!((bench.ask(Request::SetMode(mode)), bench.device.telemetry.mode()), (Reply::Done, mode));
        // What concerns every drive refuses every one.
        (0..2).for_each(|_| bench.device.telemetry.set_supply(Some(3000), FACTS.supply_good));
        bench.until(Faults::SUPPLY);
        for mode in [Mode::Follow, Mode::Excite, Mode::Linearise] {
            assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Refused(Refusal::Faulty), "{mode:?}");
        }
    }
}

/// Asks for a reset and brings the output to rest, which must end within ten seconds.
fn resets(bench: &mut Bench) {
    assert!(matches!(bench.ask(Request::Reset), Reply::Resetting { .. }));
    let rested = block_on(select(bench.device.rest(), Timer::after(Duration::from_secs(10))));
    assert!(matches!(rested, Either::First(())), "the reset never comes");
}

#[test]
fn after_failures_in_a_row_a_driving_compiled_table_drives_nothing_and_a_reset_that_is_asked_for_ends() {
    let kept = DacCode(1234);
    assert_ne!(Drive::rest(&driving()), Some(kept));
    let facts = Facts { restarts: Restarts { count: TOO_MANY, safe: Some(kept) }, ..FACTS };
    let start = || started(Startup::new(Some(&driving()), &facts, true));

    let (mut tick, mut link) = start();
    for (k, mode) in
        [Mode::Estimate, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Pause, Mode::Pil].into_iter().enumerate()
    {
        link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
        link.queues.commands.enqueue(Command::Go { hold: true }).unwrap();
        link.queues.references.enqueue(20.0).unwrap();
        link.queues.fed.enqueue(triangle(700)).unwrap();
        for k in (0..3_000).map(|tick| 3_000 * k as u32 + tick) {
            assert_eq!(tick.sample(triangle(k).into(), k * PERIOD), kept, "{mode:?}, tick {k}");
        }
    }
    assert_eq!((link.telemetry.safe(), link.telemetry.drives()), (kept, false));

    let mut bench = Bench::of(Some(driving()), start());
    std::thread::sleep(TICKS);
    for mode in [Mode::Follow, Mode::Excite] {
        assert_eq!(bench.ask(Request::SetMode(mode)), Reply::Refused(Refusal::Faulty));
    }
    assert_eq!(bench.ask(Request::Reset), Reply::Resetting { in_ms: 0 });
    resets(&mut bench);
}

#[test]
fn without_its_crystal_a_device_estimates_and_drives_nothing_and_says_so() {
    let facts = Facts { clock_good: false, ..FACTS };
    for table in [compiled(), driving(), linearising(true)] {
        let safe = Drive::rest(&table).unwrap_or(table.dac.code(0.0f32));
        let start = || started(Startup::new(Some(&table), &facts, false));
        let (mut tick, mut link) = start();
        for mode in [Mode::Estimate, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Pil] {
            link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
            for k in 0..3_000 {
                assert_eq!(tick.sample(triangle(k).into(), k * PERIOD), safe, "{mode:?}, tick {k}");
                assert!(!tick.valid(), "{mode:?}, tick {k}");
            }
        }
        let mut bench = Bench::of(Some(table), start());
        bench.until(Faults::CLOCK | Faults::SAFE_OUTPUT);
        let drives = table.drive.is_some();
        let refusal = if drives { Refusal::Faulty } else { Refusal::NoDrive };
        assert_eq!(bench.ask(Request::SetMode(Mode::Follow)), Reply::Refused(refusal));
        assert_eq!(bench.ask(Request::SetZero { at_um: 0.0 }), Reply::Refused(Refusal::TooSoon));
        resets(&mut bench);
    }
}

#[test]
fn a_reset_ends_even_where_the_output_never_comes_to_its_safe_code() {
    // The drive's rest is another code.
    let startup = Startup { safe: SAFE, ..Startup::new(Some(&driving()), &FACTS, false) };
    let mut bench = Bench::of(Some(driving()), started(startup));
    std::thread::sleep(TICKS);
    assert!(bench.device.telemetry.ticks_to_safe() > 0);
    resets(&mut bench);
    assert!(bench.device.telemetry.ticks_to_safe() > 0);
}
