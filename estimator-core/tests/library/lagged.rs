//! The lag in front of a rate-independent model; and one below 0: the displacement ahead of a tick after its voltage.

use crate::common::models;
use estimator_core::model::{Lagged, Recursion};
use estimator_core::*;
use proptest::prelude::*;

const TICK_S: f64 = 5e-4;
/// Those that have one.
const MODELS: [Model; 5] =
    [Model::PrandtlIshlinskii, Model::MaxwellSlip, Model::Duhem, Model::BoucWen, Model::Preisach];

/// Of the test tables, with another lag (s).
fn with_lag(model: Model, lag_s: f32) -> Parameters {
    models::parameters(model).with_lag(lag_s)
}

/// Displacements (µm) for the voltages 40 + 30·sin of 10 Hz, and of the same model for a voltage that stands
/// for a tick.
fn runs(parameters: &Parameters) -> [Vec<f64>; 2] {
    let discretisation = Discretisation { sample_period: TICK_S, scheme: Scheme::ForwardEuler, deadband: 0.0 };
    let engine = parameters.build::<f64>(&discretisation);
    [engine.of_held_voltage(), engine].map(|mut engine| {
        let voltage = |k: u32| 40.0 + 30.0 * (f64::from(k) * TICK_S * 62.83).sin();
        (0..400).map(|k| engine.step(voltage(k), None)).collect()
    })
}

/// A micrometre a volt, and nothing remembered.
#[derive(Clone)]
struct Straight;

impl<T: Real> Recursion<T> for Straight {
    type State = ();

    fn begin(&self, _voltage: T, _displacement: Option<T>) {}

    fn step(&self, (): &mut (), voltage: T) -> T {
        voltage
    }

    fn bound(&self, voltage: Range<T>, _limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        Ok(voltage)
    }

    fn monotone_part(&self) -> Option<Self> {
        Some(Self)
    }
}

#[test]
fn the_lag_is_first_order_and_none_is_none() {
    let model = Lagged::<f64, _>::build(0.002, TICK_S, Straight);
    let mut state = model.begin(0.0, None);
    for k in 1..100 {
        let expected = 50.0 * (1.0 - (-f64::from(k) * TICK_S / f64::from(0.002f32)).exp());
        assert!((model.peek(&state, 50.0) - expected).abs() < 1e-10);
        assert!((model.step(&mut state, 50.0) - expected).abs() < 1e-10);
    }
    let model = Lagged::<f32, _>::build(0.0, TICK_S as f32, Straight);
    let mut state = model.begin(0.1, None);
    for voltage in [33.3f32, -7.1, 1e-3] {
        assert_eq!(model.step(&mut state, voltage), voltage);
    }
}

#[test]
fn a_lag_comes_late_by_itself() {
    for model in MODELS {
        let [plain, _] = runs(&with_lag(model, 0.0));
        let [late, same] = runs(&with_lag(model, 2.0 * TICK_S as f32));
        assert_eq!(late, same, "{model}: a lag is of a voltage that stands for a tick");
        // Two ticks of a lag less the half by which a voltage that stands is late anyhow; the swing is far slower.
        let off = |ticks: usize| {
            late.iter().skip(20 + ticks).zip(&plain[20..]).map(|(late, plain)| (late - plain).abs()).sum::<f64>()
        };
        assert!(off(1) < 0.6 * off(0) && off(1) < 0.6 * off(3), "{model}: {} {} {}", off(0), off(1), off(3));
    }
}

#[test]
fn a_whole_tick_ahead_is_what_comes_a_tick_later() {
    for model in MODELS {
        let [plain, none] = runs(&with_lag(model, 0.0));
        assert_eq!(plain, none, "{model}");
        let [held, ahead] = runs(&with_lag(model, -TICK_S as f32));
        assert_eq!(plain, held, "{model}: a voltage that stands for a tick");
        let [_, half] = runs(&with_lag(model, -0.5 * TICK_S as f32));
        // (At the kinks of plays, slips and relays it is off by what the slope changes.)
        let mean =
            |seen: &[f64]| seen.iter().zip(&plain[1..]).skip(20).map(|(a, b)| (a - b).abs()).sum::<f64>() / 379.0;
        let (late, off) = (mean(&plain), mean(&ahead));
        assert!(late > 0.03 && off < 0.07 * late, "{model}: {off} instead of {late} µm");
        // Half-way between the two.
        for (at, half) in half.iter().enumerate() {
            assert!((half - 0.5 * (plain[at] + ahead[at])).abs() < 1e-6, "{model} at {at}");
        }
    }
}

#[test]
fn no_more_than_a_tick_counts() {
    for model in MODELS {
        assert_eq!(runs(&with_lag(model, -TICK_S as f32)), runs(&with_lag(model, -1.0)), "{model}");
    }
}

#[test]
fn a_lag_that_is_none_is_refused() {
    for model in MODELS {
        for (lag_s, part) in [(f32::NAN, "finite"), (f32::INFINITY, "finite"), (-1.1, "at least -1")] {
            let table = Table { parameters: with_lag(model, lag_s), ..crate::common::table() };
            let error = table.admit().map(|_| ()).expect_err("no lag").to_string();
            assert!(error.contains("lag_s") && error.contains(part), "{model}: {error}");
        }
    }
}

proptest! {
    /// What has come through a lag is a mean of voltages.
    #[test]
    fn a_lag_leads_out_of_no_bound(
        model in prop::sample::select(MODELS.to_vec()), lag_s in prop_oneof![Just(0.0f32), 1e-5f32..0.1],
        voltages in prop::collection::vec(-20f32..80.0, 1..300),
    ) {
        let discretisation =
            Discretisation { sample_period: TICK_S as f32, scheme: Scheme::ForwardEuler, deadband: 0.1 };
        let mut engine = with_lag(model, lag_s).build::<f32>(&discretisation);
        let wide = Range { min: -1e6, max: 1e6 };
        let bound = engine.bound(Range { min: -20.0, max: 80.0 }, wide).unwrap();
        let slack = 1e-5 * bound.span();
        for voltage in voltages {
            let displacement = engine.step(voltage, None);
            prop_assert!(bound.min - slack <= displacement && displacement <= bound.max + slack, "{displacement}");
        }
    }
}
