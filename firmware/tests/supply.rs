//! A supply that is off, which is the converters' reference, and the estimate, the set-point, the sensor and the output
//! that are not.

mod common;

use common::{FACTS, LinkEnd, PERIOD, compiled, tick, triangle};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCalibration, AdcCode, Admitted, Estimator, Status, Table};
use firmware::Tick;
use firmware::correction::Correction;
use firmware::queues::Command;
use firmware::supply::{MADE_FOR_MV, MISSING, Measured, Supply};
use firmware::watch::{HOLD, SATURATED};
use protocol::{Faults, Mode};

/// Ticks from measurement to measurement of the supply.
const MEASURED: u32 = 40;

fn corrected(table: &Admitted, off: i32, code: AdcCode) -> AdcCode {
    Correction::new(FACTS.interface.adc_full_scale, Some(table)).tick(off, code.into()).corrected.monitor
}

/// What an ADC reads at a supply (mV) where it would read `code` at the one it is made for.
fn read(adc: &AdcCalibration, AdcCode(code): AdcCode, mv: f32) -> AdcCode {
    let zero = f32::from(adc.code(0.0f32).0);
    AdcCode((zero + (f32::from(code) - zero) * MADE_FOR_MV / mv).round() as u16)
}

/// A tick, its other half, streaming, and the number of ticks so far.
struct Bench {
    tick: Tick<'static>,
    link: LinkEnd,
    k: u32,
    measured: Measured,
}

impl Bench {
    fn new() -> Self {
        let (tick, link) = tick(Some(&compiled()), Faults::empty());
        link.telemetry.streaming.store(true, Relaxed);
        Self { tick, link, k: 0, measured: Measured::default() }
    }

    fn measures(&mut self, mv: impl Into<Option<f32>>) {
        self.measured.take(mv.into());
        self.link.telemetry.supply.publish(&self.measured);
    }

    /// The sample of a code.
    fn sample(&mut self, code: AdcCode) -> protocol::Sample {
        self.k += 1;
        self.tick.sample(code.into(), self.k * PERIOD);
        self.link.queues.samples.dequeue().expect("a sample a tick").sample
    }
}

#[test]
fn a_supply_that_ramps_by_a_twentieth_moves_the_estimate_by_less_than_a_thousandth_of_the_stroke() {
    let table = compiled();
    for end in [3460.0, 3140.0] {
        let (mut bench, mut reference) = (Bench::new(), Estimator::<f32>::new(&table));
        let mut uncorrected = Estimator::<f32>::new(&table);
        let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        let (mut worst, mut worst_uncorrected) = (0.0f32, 0.0f32);
        // Ten seconds of ramp, and two after.
        for k in 0..24_000 {
            let mv = MADE_FOR_MV + (end - MADE_FOR_MV) * (k as f32 / 20_000.0).min(1.0);
            if k % MEASURED == 0 {
                bench.measures(mv);
            }
            let code = read(&table.adc, triangle(k), mv);
            let (found, expected) = (bench.sample(code), reference.tick(triangle(k)).displacement);
            (least, greatest) = (least.min(expected), greatest.max(expected));
            worst = worst.max((found.displacement - expected).abs());
            worst_uncorrected = worst_uncorrected.max((uncorrected.tick(code).displacement - expected).abs());
            assert_eq!(found.faults, Faults::empty());
        }
        let stroke = greatest - least;
        println!("to {end} mV: {} of the stroke, uncorrected {}", worst / stroke, worst_uncorrected / stroke);
        assert!(worst < 1e-3 * stroke, "{end} mV: {worst} of {stroke} µm");
        assert!(worst_uncorrected > 0.02 * stroke, "{end} mV: {worst_uncorrected} of {stroke} µm, uncorrected");
    }
}

#[test]
fn a_voltage_is_scaled_and_0_v_stays_whatever_the_divider() {
    let of = |offset_v, invert| AdcCalibration { gain_v_per_code: 3.3e-4, offset_v, invert, full_scale: 65_520 };
    for adc in [of(-10.8, false), of(-0.5, false), of(0.0, false), of(10.8, true), of(5.0, false), of(-30.0, false)] {
        let table = Table { adc, ..*compiled() }.admit().expect("any divider");
        for off in [-3277, -1, 0, 1, 3277] {
            for code in (0..=65_520).step_by(91).map(AdcCode) {
                let corrected = corrected(&table, off, code);
                let volts = adc.voltage::<f32>(code) * (1.0 + off as f32 / 65_536.0);
                assert!(corrected.0.abs_diff(adc.code(volts).0) <= 1, "{adc:?}: {code:?} at {off}: {corrected:?}");
                assert!(off != 0 || corrected == code);
            }
            let zero = adc.code(0.0f32);
            if !adc.saturated(zero) {
                assert_eq!(corrected(&table, off, zero), zero);
            }
        }
    }
}

#[test]
fn no_code_jumps_when_the_supply_does() {
    let mut bench = Bench::new();
    bench.measures(3300.0);
    let before = AdcCode(60_000);
    let mut last = bench.sample(before).code;
    assert_eq!(last, 60_000);
    for k in 0..8_000 {
        if k % MEASURED == 0 {
            bench.measures(3450.0);
        }
        let code = bench.sample(before).code;
        assert!(code.abs_diff(last) <= 1, "from {last} to {code}");
        last = code;
    }
    let zero = f32::from(compiled().adc.code(0.0f32).0);
    let expected = zero + (60_000.0 - zero) * 3450.0 / 3300.0;
    assert!((f32::from(last) - expected).abs() <= 1.0, "{last}, {expected} expected");
}

#[test]
fn at_the_start_and_where_the_estimate_begins_anew_it_counts_at_once() {
    let mut bench = Bench::new();
    bench.measures(3400.0);
    let expected = corrected(&compiled(), 1986, AdcCode(50_000)).0;
    assert_eq!(bench.sample(AdcCode(50_000)).code, expected);
    (0..100).for_each(|_| bench.measures(3300.0));
    assert!(bench.sample(AdcCode(50_000)).code.abs_diff(expected) <= 1);
    for mode in [Mode::Pause, Mode::Estimate] {
        bench.link.queues.commands.enqueue(Command::SetMode(mode)).unwrap();
        bench.k += 1;
        bench.tick.sample(AdcCode(50_000).into(), bench.k * PERIOD);
        _ = bench.link.queues.samples.dequeue();
    }
    assert_eq!(bench.sample(AdcCode(50_000)).code, 50_000);
}

#[test]
fn what_is_no_supply_corrects_nothing_and_is_a_fault() {
    let (supply, mut measured) = (Supply::new(), Measured::default());
    let mut take = |mv| {
        measured.take(mv);
        supply.publish(&measured);
    };
    assert_eq!((supply.off(), supply.mv(), supply.bad()), (0, None, false), "not measured yet");
    for mv in [0.0, 3100.0, 3500.0, 1e9, f32::INFINITY, f32::NAN] {
        take(Some(mv));
        assert_eq!((supply.off(), supply.bad()), (0, true), "{mv} mV");
    }
    take(Some(3333.0));
    assert_eq!((supply.off(), supply.bad()), (655, false), "the first that is good");
    for (mv, bad) in [(3500.0, false), (3100.0, true), (3100.0, true)] {
        take(Some(mv));
        assert_eq!((supply.off(), supply.bad()), (655, bad), "as before {mv} mV");
    }
    take(None);
    assert_eq!((supply.off(), supply.mv(), supply.bad()), (655, Some(3100), true), "nothing says that it is better");
}

#[test]
fn fed_codes_are_estimated_as_they_are() {
    let mut bench = Bench::new();
    bench.measures(3450.0);
    let found = bench.sample(AdcCode(50_000));
    assert!(found.code > 51_000, "{}", found.code);
    bench.link.queues.commands.enqueue(Command::SetMode(Mode::Pil)).unwrap();
    bench.k += 1;
    bench.tick.sample(AdcCode(0).into(), bench.k * PERIOD);
    let mut reference = Estimator::<f32>::new(&compiled());
    for code in (0..3_000).map(triangle) {
        bench.link.queues.fed.enqueue(code).unwrap();
        let (found, expected) = (bench.sample(AdcCode(0)), reference.tick(code));
        assert_eq!((found.code, found.displacement.to_bits()), (code.0, expected.displacement.to_bits()));
        assert_eq!(found.status, expected.status);
    }
}

#[test]
fn an_end_of_the_range_says_so() {
    for mv in [3150.0, 3300.0, 3450.0] {
        let mut bench = Bench::new();
        bench.measures(mv);
        for (code, saturated) in [(0, true), (30_000, false), (65_520, true)] {
            let found = bench.sample(AdcCode(code));
            assert_eq!(found.status.contains(Status::ADC_SATURATED), saturated, "{code} at {mv} mV: {found:?}");
            assert!(found.code <= 65_520);
        }
        for _ in 0..SATURATED {
            bench.sample(AdcCode(65_520));
        }
        assert!(bench.link.telemetry.faults().contains(Faults::ADC_SATURATED), "{mv} mV");
    }
}

#[test]
fn a_supply_that_is_not_measured_any_more_is_a_fault_and_one_that_never_was_is_none() {
    let mut bench = Bench::new();
    let mut k = 0;
    let mut faults = |bench: &mut Bench, ticks: u32| {
        let mut seen = Faults::empty();
        for _ in 0..ticks {
            k += 1;
            seen |= bench.sample(triangle(k)).faults;
        }
        seen
    };
    let never = |bench: &mut Bench| bench.measures(None);
    for _ in 0..10 {
        never(&mut bench);
        assert_eq!(faults(&mut bench, MEASURED), Faults::empty(), "this board cannot");
    }
    bench.measures(3_250.0);
    for missing in 1..MISSING {
        never(&mut bench);
        assert_eq!(faults(&mut bench, MEASURED), Faults::empty(), "{missing} did not come");
    }
    bench.measures(3_250.0);
    (1..MISSING).for_each(|_| never(&mut bench));
    assert_eq!(faults(&mut bench, MEASURED), Faults::empty(), "they were not in a row");
    never(&mut bench);
    let lasting = Faults::SUPPLY | Faults::SAFE_OUTPUT;
    assert_eq!((faults(&mut bench, MEASURED), bench.link.telemetry.supply.mv()), (lasting, Some(3_250)));
    // It is off when it is measured again, which is no disturbance of one that was good.
    bench.measures(3_000.0);
    assert_eq!(faults(&mut bench, MEASURED), lasting);
    bench.measures(3_300.0);
    faults(&mut bench, HOLD);
    assert_eq!(faults(&mut bench, 10), Faults::empty());
}
