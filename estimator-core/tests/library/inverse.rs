//! The inverse: what it commands brings the model to the reference, within its limits, for every model that has one.

use crate::common::models::{DRIVE, table_of};
use estimator_core::*;
use proptest::prelude::*;

const LIMITS: DriveLimits = DRIVE.limits;

fn invertible() -> Vec<Model> {
    Model::ALL.into_iter().filter(|model| *model != Model::Narx).collect()
}

/// Limits that suit a model's table: the Voigt family's is over ±20 V.
fn limits(model: Model) -> DriveLimits {
    if model.is_voigt() {
        DriveLimits { range_v: Range { min: -20.0, max: 20.0 }, rest_v: 0.0, ..LIMITS }
    } else {
        LIMITS
    }
}

/// The table without what an inverse leaves out, and without a displacement that jumps at a reversal.
fn monotone(model: Model) -> Admitted {
    let table = table_of(model);
    let parameters = match table.parameters {
        Parameters::GeneralisedPrandtlIshlinskii(of) => {
            Parameters::GeneralisedPrandtlIshlinskii(GeneralisedPrandtlIshlinskiiParameters {
                delay_ticks: 0.0,
                resonance_hz: 0.0,
                damping: 0.0,
                // The estimator's lag takes a voltage that runs straight, the inverse's one that stands for a tick.
                lag_s: 0.0,
                ..of
            })
        }
        Parameters::VoigtChain(of) => {
            Parameters::VoigtChain(VoigtChainParameters { voltage_extremum_um_per_v: 0.0, deadband_v: 0.0, ..of })
        }
        other => other,
    };
    Table { parameters, ..table }.admit().unwrap()
}

/// Displacements that a slow swing over some of the range reaches, from the rest voltage: middle and half width.
fn reachable<T: Real>(table: &Admitted, limits: &DriveLimits) -> (T, T) {
    let mut estimator = Estimator::<T>::new(table);
    let (middle, half) = ((limits.range_v.max + limits.range_v.min) / 2.0, limits.range_v.span() * 0.3);
    let (mut low, mut high) = (T::infinity(), T::neg_infinity());
    for k in 0..24_000u16 {
        let phase = f32::from(k) / 8_000.0 * core::f32::consts::TAU;
        let y = estimator.tick_volts(T::of(middle + half * phase.sin())).displacement;
        if k > 8_000 {
            (low, high) = (low.min(y), high.max(y));
        }
    }
    ((low + high) / T::of(2.0), (high - low) / T::of(2.0))
}

/// Largest error once the reference has been met for the first time, and how many ticks that took. The model that
/// judges is the estimator.
fn round_trip<T: Real>(table: &Admitted, limits: &DriveLimits, reference: impl Fn(u16) -> T, ticks: u16) -> (T, u16) {
    let mut inverse = table.inverse::<T>(limits).unwrap();
    let mut judge = Estimator::<T>::new(table);
    judge.tick_volts(T::of(limits.rest_v));
    let (mut worst, mut met) = (T::zero(), None);
    for k in 0..ticks {
        let wanted = reference(k);
        let commanded = inverse.tick(wanted);
        let reached = judge.tick_volts(commanded.voltage).displacement;
        if commanded.reached && met.is_none() {
            met = Some(k);
        }
        if met.is_some() {
            worst = worst.max((reached - wanted).abs());
        }
    }
    (worst, met.unwrap_or(u16::MAX))
}

#[test]
fn the_model_of_its_inverse_is_the_reference() {
    for model in invertible() {
        let (table, limits) = (monotone(model), limits(model));
        let span = f64::from(table.displacement_limits_um.span());
        let (middle, half) = reachable::<f64>(&table, &limits);
        let wave = |k: u16| {
            let t = f64::from(k);
            middle + half * (0.5 * (t * 0.004).sin() + 0.3 * (t * 0.0171).sin())
        };
        let (worst, met) = round_trip::<f64>(&table, &limits, wave, 8_000);
        assert!(met < 1_000 && worst < 2e-4 * span, "{model}: {worst} µm after {met} ticks");
        let (single, _) = round_trip::<f32>(&table, &limits, |k| wave(k) as f32, 8_000);
        assert!(f64::from(single) < 4e-4 * span, "{model}, f32: {single} µm");
    }
}

#[test]
fn a_delay_and_a_resonance_are_left_out_and_come_late() {
    let delayed = table_of(Model::GeneralisedPrandtlIshlinskii);
    let Parameters::GeneralisedPrandtlIshlinskii(of) = delayed.parameters else { panic!("the play model's") };
    let only =
        GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 3.0, lag_s: 0.0, resonance_hz: 0.0, damping: 0.0, ..of };
    let table = Table { parameters: Parameters::GeneralisedPrandtlIshlinskii(only), ..delayed }.admit().unwrap();
    let (mut inverse, mut judge) = (table.inverse::<f64>(&LIMITS).unwrap(), Estimator::<f64>::new(&table));
    judge.tick_volts(LIMITS.rest_v.into());
    let wanted = |k: i32| 4.0 + 2.0 * (f64::from(k) * 0.01).sin();
    // What a slow reference makes of a resonance at 400 Hz, and of half a tick between a voltage that stands and one
    // that runs straight, is far below what a delay of three ticks makes.
    let ringing = GeneralisedPrandtlIshlinskiiParameters { delay_ticks: 0.0, ..of };
    let ringing = Table {
        parameters: Parameters::GeneralisedPrandtlIshlinskii(ringing),
        ..table_of(Model::GeneralisedPrandtlIshlinskii)
    }
    .admit()
    .unwrap();
    let (mut free, mut rings) = (ringing.inverse::<f64>(&LIMITS).unwrap(), Estimator::<f64>::new(&ringing));
    rings.tick_volts(LIMITS.rest_v.into());
    for k in 0..4_000 {
        let reached = rings.tick_volts(free.tick(wanted(k)).voltage).displacement;
        assert!(k < 1_000 || (reached - wanted(k)).abs() < 1.5e-2, "tick {k}: {reached} {}", wanted(k));
    }
    for k in 0..2_000 {
        let commanded = inverse.tick(wanted(k));
        let late = judge.tick_volts(commanded.voltage).displacement;
        assert!(k < 200 || (late - wanted(k - 3)).abs() < 1e-3, "tick {k}: {late} {}", wanted(k - 3));
    }
}

#[test]
fn a_displacement_that_jumps_at_a_reversal_is_missed_by_no_more_than_the_jump() {
    let table = table_of(Model::VoigtChain).admit().unwrap();
    let Parameters::VoigtChain(of) = table.parameters else { panic!("the chain's") };
    let (middle, half) = reachable::<f64>(&table, &LIMITS);
    let wave = |k: u16| middle + 0.8 * half * (f64::from(k) * 0.006).sin();
    let (worst, _) = round_trip::<f64>(&table, &LIMITS, wave, 8_000);
    let jump = 2.0 * f64::from(of.voltage_extremum_um_per_v.abs() * LIMITS.range_v.max);
    assert!(worst > 1e-3 && worst < jump, "{worst} of {jump}");
}

#[test]
fn a_hold_holds_and_no_number_changes_nothing() {
    for model in invertible() {
        let (table, limits) = (monotone(model), limits(model));
        let (middle, _) = reachable::<f32>(&table, &limits);
        let mut inverse = table.inverse::<f32>(&limits).unwrap();
        for _ in 0..4_000 {
            inverse.tick(middle);
        }
        let held = inverse.tick(middle);
        assert!(held.reached, "{model}");
        let none = inverse.tick(f32::NAN);
        assert_eq!((none.voltage, none.reached), (held.voltage, false), "{model}");
        assert!(inverse.tick(f32::INFINITY).voltage > held.voltage, "{model}");
    }
}

#[test]
fn what_cannot_be_reached_is_said_and_released_again() {
    let table = monotone(Model::GeneralisedPrandtlIshlinskii);
    let mut inverse = table.inverse::<f32>(&LIMITS).unwrap();
    let stride = LIMITS.slew_v_per_s * 5e-4;
    let mut last = LIMITS.rest_v;
    for k in 0..200 {
        let commanded = inverse.tick(1e3);
        assert!(!commanded.reached && commanded.voltage - last <= stride * 1.0001, "tick {k}");
        last = commanded.voltage;
    }
    assert_eq!(last, LIMITS.range_v.max);
    let back = (0..200).map(|_| inverse.release().voltage).last();
    assert_eq!(back, Some(LIMITS.rest_v));
}

#[test]
fn a_wanted_voltage_is_had_within_the_limits_and_the_model_goes_along() {
    for model in invertible() {
        let (table, limits) = (monotone(model), limits(model));
        let Range { min, max } = limits.range_v;
        let stride = limits.slew_v_per_s * 5e-4;
        let (mut inverse, mut judge) = (table.inverse::<f64>(&limits).unwrap(), Estimator::<f64>::new(&table));
        judge.tick_volts(limits.rest_v.into());
        let mut last = f64::from(limits.rest_v);
        for (wanted, had) in [(2.0 * max - min, max), (min - 1.0, min), ((min + max) / 2.0, (min + max) / 2.0)] {
            let (wanted, had) = (f64::from(wanted), f64::from(had));
            let mut commanded = inverse.steer(wanted);
            assert!(!commanded.reached, "{model}: further than a tick's slew");
            for _ in 0..((max - min) / stride) as u32 + 2 {
                let step = commanded.voltage - last;
                assert!(step.abs() <= f64::from(stride) * 1.0001, "{model}: {last} → {}", commanded.voltage);
                let there = judge.tick_volts(commanded.voltage).displacement;
                assert!((there - commanded.displacement).abs() < 1e-9, "{model}: the inverse's model is the table's");
                last = commanded.voltage;
                commanded = inverse.steer(wanted);
            }
            judge.tick_volts(commanded.voltage);
            last = commanded.voltage;
            assert!((last - had).abs() < 1e-9, "{model}: {wanted} gives {last}");
            assert_eq!(commanded.reached, wanted == had, "{model}");
        }
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let commanded = inverse.steer(odd);
            assert_eq!((commanded.voltage, commanded.reached), (last, false), "{model}");
        }
    }
}

#[test]
fn models_and_limits_without_an_inverse_are_refused() {
    let refused = |table: &Admitted, limits: &DriveLimits| table.inverse::<f32>(limits).unwrap_err();
    let narx = table_of(Model::Narx).admit().unwrap();
    assert_eq!(refused(&narx, &LIMITS), NoInverse::Model);
    let wrong = Table { drive: Some(DRIVE), ..*narx };
    assert_eq!(wrong.admit().unwrap_err(), TableError::Drive(NoInverse::Model));

    let plays = table_of(Model::GeneralisedPrandtlIshlinskii).admit().unwrap();
    let Parameters::BoucWen(of) = table_of(Model::BoucWen).parameters else { panic!("Bouc-Wen's") };
    let down = BoucWenParameters { d1_um_per_v: -0.2, d2_um_per_v2: 0.0, ..of };
    let falling = Table { parameters: Parameters::BoucWen(down), drive: None, ..table_of(Model::BoucWen) };
    assert_eq!(refused(&falling.admit().unwrap(), &LIMITS), NoInverse::Falling);
    // It rises from end to end, and falls behind the vertex.
    let bent = BoucWenParameters { d1_um_per_v: 0.2, d2_um_per_v2: -0.002, ..of };
    let bent = Table { parameters: Parameters::BoucWen(bent), drive: None, ..table_of(Model::BoucWen) };
    assert_eq!(refused(&bent.admit().unwrap(), &LIMITS), NoInverse::Falling);
    let cases = [
        (DriveLimits { range_v: Range { min: 60.0, max: 0.0 }, ..LIMITS }, "ordered"),
        (DriveLimits { range_v: Range { min: 0.0, max: f32::NAN }, ..LIMITS }, "ordered"),
        (DriveLimits { range_v: Range { min: 0.0, max: 81.0 }, ..LIMITS }, "identified on"),
        (DriveLimits { rest_v: -1.0, ..LIMITS }, "rest_v"),
        (DriveLimits { rest_v: f32::NAN, ..LIMITS }, "rest_v"),
        (DriveLimits { slew_v_per_s: 0.0, ..LIMITS }, "slew"),
        (DriveLimits { slew_v_per_s: f32::INFINITY, ..LIMITS }, "slew"),
    ];
    for (limits, rule) in cases {
        assert!(matches!(refused(&plays, &limits), NoInverse::Limits(broken) if broken.contains(rule)), "{rule}");
    }
    let wanted = |gain_um_per_code, offset_um| {
        let setpoint = SetpointCalibration { gain_um_per_code, offset_um, at_start: false };
        DriveCalibration { setpoint: Some(setpoint), ..DRIVE }
    };
    for (drive, rule) in [
        (DriveCalibration { gain_codes_per_v: 0.0, ..DRIVE }, "gain"),
        (DriveCalibration { offset_code: f32::NAN, ..DRIVE }, "gain"),
        (DriveCalibration { offset_code: -100.0, ..DRIVE }, "DAC"),
        (wanted(f32::NAN, 0.0), "set-point's gain"),
        (wanted(0.0, 10.0), "set-point's gain"),
        (wanted(f32::MAX, 10.0), "set-point's gain"),
        (wanted(0.01, f32::NEG_INFINITY), "set-point's gain"),
        // From 90 µm, where the limits end, upwards; and from -60 µm downwards.
        (wanted(0.01, 90.0), "share"),
        (wanted(-0.01, -60.0), "share"),
    ] {
        match (Table { drive: Some(drive), ..*plays }).admit() {
            Err(TableError::OutOfRange { rule: broken }) => assert!(broken.contains(rule), "{broken}"),
            other => panic!("{rule}: {other:?}"),
        }
    }
}

/// Of 60 V at 2 kHz an epsilon is 7.2 µV, and 16 of them a tick are 0.229 V/s; in f64 nothing is lost.
#[test]
fn a_drive_so_slow_that_its_steps_are_lost_or_take_hours_is_refused() {
    let table = table_of(Model::MaxwellSlip);
    let with = |slew_v_per_s| DriveLimits { slew_v_per_s, ..LIMITS };
    let driving = |slew, sample_period_us| {
        let drive = Some(DriveCalibration { limits: with(slew), ..DRIVE });
        Table { drive, sample_period_us, ..table }.admit().map(drop)
    };
    assert_eq!(driving(0.23, 500), Ok(()));
    let lost = driving(0.228, 500).unwrap_err();
    assert!(lost.to_string().contains("slew_v_per_s must be larger"), "{lost}");
    let slow = table.admit().unwrap();
    assert!(matches!(slow.inverse::<f32>(&with(0.228)), Err(NoInverse::Limits(_))));
    assert!(slow.inverse::<f64>(&with(1e-9)).is_ok());
    // What is admitted goes as fast as it is allowed to, wherever in the range.
    let mut inverse = slow.inverse::<f32>(&DriveLimits { rest_v: 55.0, ..with(0.23) }).unwrap();
    let gone = f64::from((0..20_000).fold(0.0, |_, _| inverse.steer(60.0).voltage)) - 55.0;
    assert!((gone - 2.3).abs() < 0.03 * 2.3, "{gone} V in 10 s");
    assert_eq!(driving(0.11, 20_000), Ok(()));
    let hours = driving(0.09, 20_000).unwrap_err();
    assert!(hours.to_string().contains("in 10 minutes"), "{hours}");
}

#[test]
fn a_drive_faster_than_the_amplifier_is_refused() {
    let with = |slew: f32| {
        let table = Table { drive: Some(DRIVE), amplifier_slew_v_per_s: Some(slew), ..table_of(Model::MaxwellSlip) };
        table.admit().map(drop)
    };
    assert_eq!(with(LIMITS.slew_v_per_s), Ok(()));
    let refused = with(0.99 * LIMITS.slew_v_per_s);
    assert!(
        matches!(refused, Err(TableError::OutOfRange { rule }) if rule.contains("no more than amplifier_slew_v_per_s"))
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever is asked: the voltage stays within its range and its slew rate.
    #[test]
    fn limits_hold(model in prop::sample::select(invertible()), asked in prop::collection::vec((-90f32..90.0, 1u8..40, any::<bool>()), 1..12)) {
        let (table, limits) = (monotone(model), limits(model));
        let mut inverse = table.inverse::<f32>(&limits).unwrap();
        let stride = limits.slew_v_per_s * 5e-4 + 1e-4;
        let mut last = limits.rest_v;
        for (reference, ticks, volts) in asked {
            for _ in 0..ticks {
                let voltage = if volts { inverse.steer(reference) } else { inverse.tick(reference) }.voltage;
                prop_assert!(limits.range_v.contains(voltage) && (voltage - last).abs() <= stride, "{last} → {voltage}");
                last = voltage;
            }
        }
    }
}
