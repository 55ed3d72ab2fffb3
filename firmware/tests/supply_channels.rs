//! A supply that is off, which is the converters' reference: the output, the set-point and the sensor that are not.

mod common;

use common::driven::{REST, STRIDE};
use common::{FACTS, LinkEnd, PERIOD, SETPOINT, compiled, driving, linearising, started_on};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Admitted, DacCalibration, DriveCalibration, Status, Table};
use firmware::queues::Command;
use firmware::setpoint::CALM_TICKS;
use firmware::shaping::DacParts;
use firmware::startup::Startup;
use firmware::supply::{MADE_FOR_MV, Measured};
use firmware::{Conversion, Facts, Tick};
use protocol::{Faults, Mode, Sample};

/// Ticks from measurement to measurement of the supply.
const MEASURED: u32 = 40;
/// A sensor's 0 V are at 0.15 V of the pin.
const SENSOR_ZERO: f32 = 65_520.0 / 22.0;

/// What an ADC reads at a supply (mV) where it would read `code` at the one it is made for, and `zero` at 0 V.
fn read(zero: f32, code: f32, mv: f32) -> AdcCode {
    AdcCode((zero + (code - zero) * MADE_FOR_MV / mv).round() as u16)
}

/// A tick, and an amplifier, a controller and a sensor whose voltages are the same at every supply.
struct Bench {
    tick: Tick<'static>,
    link: LinkEnd,
    table: Admitted,
    k: u32,
    /// The supply, what was measured of it, and what the DAC has been given.
    mv: f32,
    measured: Measured,
    given: DacParts,
    /// What the controller and the sensor have, in codes of the supply that all is made for.
    wants: f32,
    senses: f32,
}

impl Bench {
    /// At a supply that is measured at boot.
    fn new(table: Admitted, mv: f32) -> Self {
        let facts = Facts { supply_mv: Some(mv), ..FACTS };
        let (tick, link) = started_on(&facts, Startup::new(Some(&table), &facts, Faults::empty()));
        let measured = Measured::of(facts.supply_mv);
        link.telemetry.begin(&facts, &measured);
        link.telemetry.streaming.store(true, Relaxed);
        let (given, wants) = (link.telemetry.safe_given(), wanting(30.0));
        Self { tick, link, table, k: 0, mv, measured, given, wants, senses: 40_000.0 }
    }

    fn measure(&mut self) {
        self.measured.take(Some(self.mv));
        self.link.telemetry.supply.publish(&self.measured);
    }

    /// The pin's voltage, in codes of the supply that all is made for.
    fn pin(&self) -> f32 {
        f32::from(self.given.0) * self.mv / MADE_FOR_MV
    }

    /// A tick, of which every fortieth has the supply measured before.
    fn step(&mut self) -> Sample {
        if self.k.is_multiple_of(MEASURED) {
            self.measure();
        }
        let adc = &self.table.adc;
        let zero = f32::from(adc.code(0.0f32).0);
        let volts = self.table.drive.map_or(1.0, |drive| (self.pin() - drive.offset_code) / drive.gain_codes_per_v);
        let noise = (self.k % 2) as f32;
        let code = (volts - adc.offset_v) / adc.gain_v_per_code + noise;
        let conversion = Conversion {
            monitor: read(zero, code, self.mv),
            sensor: Some(read(SENSOR_ZERO, self.senses + noise, self.mv)),
            setpoint: Some(read(wanting(0.0), self.wants + noise, self.mv)),
        };
        let before = self.pin();
        self.given = self.tick.sample(conversion, self.k * PERIOD);
        self.k += 1;
        // Both what is commanded and what is given for it are rounded. What drives nothing may jump.
        let drives = self.link.telemetry.drives();
        assert!(!drives || (self.pin() - before).abs() < f32::from(STRIDE) + 1.0, "{before} → {}", self.pin());
        self.link.queues.samples.dequeue().expect("a sample a tick").sample
    }

    /// Has the amplifier go to a voltage and stay there.
    fn excite(&mut self, volts: f32) -> Sample {
        self.link.queues.commands.enqueue(Command::SetMode(Mode::Excite)).expect("there is room");
        self.step();
        self.link.queues.commands.enqueue(Command::Go { hold: true }).expect("there is room");
        self.link.queues.references.enqueue(volts).expect("there is room");
        self.run(1_000)
    }

    fn run(&mut self, ticks: u32) -> Sample {
        (0..ticks).map(|_| self.step()).last().expect("at least one tick")
    }
}

/// The set-point's code of a displacement, µm.
fn wanting(um: f32) -> f32 {
    (um - SETPOINT.offset_um) / SETPOINT.gain_um_per_code
}

#[test]
fn a_supply_that_ramps_by_a_twentieth_moves_output_set_point_and_sensor_by_less_than_a_thousandth() {
    for end in [3460.0, 3140.0] {
        let mut bench = Bench::new(linearising(true), MADE_FOR_MV);
        let (mut output, mut setpoint, mut sensor) = (0.0f32, 0.0f32, 0.0f32);
        let mut uncorrected = 0.0f32;
        // Ten seconds of ramp, and two after.
        for k in 0..24_000u32 {
            bench.mv = MADE_FOR_MV + (end - MADE_FOR_MV) * (k as f32 / 20_000.0).min(1.0);
            let phase = k as f32 * 2e-3;
            (bench.wants, bench.senses) = (wanting(20.0 + 15.0 * phase.sin()), 34_000.0 + 28_000.0 * phase.cos());
            let (sample, noise) = (bench.step(), (k % 2) as f32);
            assert!(k < CALM_TICKS || sample.faults == Faults::empty(), "tick {k}: {:?}", sample.faults);
            output = output.max((bench.pin() - f32::from(sample.dac)).abs() / 4095.0);
            uncorrected = uncorrected.max(f32::from(sample.dac) * (bench.mv / MADE_FOR_MV - 1.0).abs() / 4095.0);
            let of = |code: u16, wish: f32| (f32::from(code) - wish - noise).abs() / 65_520.0;
            sensor = sensor.max(of(sample.sensor.expect("it is streamed"), bench.senses));
            setpoint = setpoint.max(of(bench.link.telemetry.setpoint().expect("it is read").0, bench.wants));
        }
        println!(
            "to {end} mV, of full scale: output {output:.6} (as it is {uncorrected:.3}), set-point {setpoint:.6}, \
             sensor {sensor:.6}"
        );
        assert!(output < 1e-3 && setpoint < 1e-3 && sensor < 1e-3);
        assert!(uncorrected > 0.02);
    }
}

#[test]
fn nothing_jumps_when_the_supply_does() {
    let mut bench = Bench::new(driving(), MADE_FOR_MV);
    let wish = bench.excite(3.0).dac;
    for mv in [3450.0, 3150.0] {
        bench.mv = mv;
        for _ in 0..8_000 {
            let before = bench.given.0;
            assert_eq!(bench.step().dac, wish);
            assert!(bench.given.0.abs_diff(before) <= 1, "{before} → {:?} at {mv} mV", bench.given);
        }
        assert!((bench.pin() - f32::from(wish)).abs() <= 0.6, "{} for {wish} at {mv} mV", bench.pin());
    }
}

#[test]
fn it_starts_where_the_supply_has_it_and_is_as_fast_as_it_may_at_any() {
    for mv in [3150.0, 3300.0, 3450.0] {
        let mut bench = Bench::new(linearising(true), mv);
        let rest = bench.pin();
        assert!((rest - f32::from(REST.0)).abs() <= 0.6, "{rest} at {mv} mV");
        let before = bench.given;
        bench.step();
        assert_eq!(bench.given, before, "the first tick moves nothing");
        bench.run(CALM_TICKS - 10);
        let ticks = (0..).take_while(|_| bench.step().dac < REST.0 + 1_000).count();
        assert!((56..60).contains(&ticks), "{ticks} ticks for a thousand codes at {mv} mV");
    }
}

#[test]
fn the_way_to_rest_without_the_tick_is_of_what_the_dac_is_given() {
    for mv in [3150.0, 3300.0, 3450.0] {
        let mut bench = Bench::new(linearising(true), mv);
        bench.run(CALM_TICKS + 2_000);
        let from = bench.given;
        let way: Vec<DacParts> = bench.link.telemetry.ramp(from).collect();
        let volts = |DacParts(code): DacParts| f32::from(code) * mv / MADE_FOR_MV;
        assert!((volts(way[way.len() - 1]) - f32::from(REST.0)).abs() <= 0.6, "{way:?} at {mv} mV");
        let before = std::iter::once(&from).chain(&way);
        assert!(
            before.zip(&way).all(|(a, b)| (volts(*a) - volts(*b)).abs() < f32::from(STRIDE) + 0.5),
            "{way:?} at {mv} mV"
        );
        assert!(way.len().abs_diff(bench.link.telemetry.ticks_to_safe() as usize) <= 1, "at {mv} mV");
    }
}

#[test]
fn a_supply_too_low_for_a_code_is_said_and_nothing_wraps() {
    let top = Table {
        dac: DacCalibration { gain_codes_per_um: 1.0, offset_code: 4_000.0, full_scale: 4_095 },
        ..*compiled()
    };
    let drive = driving().drive.map(|drive| DriveCalibration { offset_code: 409.0, ..drive });
    let driven = Table { drive, ..*driving() };
    for (mv, low) in [(3300.0, false), (3160.0, true), (3450.0, false)] {
        let mut bench = Bench::new(top.admit().expect("an offset"), mv);
        let sample = bench.run(100);
        let code = sample.dac;
        assert!((3_900..4_095).contains(&code), "{code}");
        assert_eq!((sample.status.contains(Status::DAC_SATURATED), bench.given == DacParts(4_095)), (low, low), "{mv}");
        // A drive that is told to go to the end of its range.
        let mut bench = Bench::new(driven.admit().expect("an offset"), mv);
        let sample = bench.excite(3.6);
        assert_eq!((sample.dac, sample.faults), (4_094, Faults::empty()), "{mv}");
        assert_eq!(sample.status.contains(Status::OUT_OF_REACH), low, "{mv}: {:?}", sample.status);
        assert!(!sample.status.contains(Status::DAC_SATURATED));
    }
}

#[test]
fn while_it_is_paused_and_while_codes_are_fed_the_output_goes_along_too() {
    for mode in [Mode::Pause, Mode::Pil] {
        let mut bench = Bench::new(driving(), MADE_FOR_MV);
        bench.link.queues.commands.enqueue(Command::SetMode(mode)).expect("there is room");
        bench.mv = 3400.0;
        for k in 0..8_000 {
            if k % MEASURED == 0 {
                bench.measure();
            }
            bench.given = bench.tick.sample(AdcCode(30_000).into(), k * PERIOD);
        }
        assert!((bench.pin() - f32::from(REST.0)).abs() <= 0.6, "{mode:?}: {}", bench.pin());
    }
}
