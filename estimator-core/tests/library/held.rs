//! The memory of Duhem's and Bouc-Wen's equations, held within the table's deadband: what lies within it leaves nothing
//! behind, what goes beyond it has the equation's own answer.

use crate::common::models::parameters;
use estimator_core::*;
use proptest::prelude::*;

const DEADBAND: f64 = 0.5;

/// Each of the two, behind no lag.
fn without_lag() -> [Parameters; 2] {
    [Model::Duhem, Model::BoucWen].map(|model| {
        let mut parameters = parameters(model);
        match &mut parameters {
            Parameters::Duhem(of) => of.lag_s = 0.0,
            Parameters::BoucWen(of) => *of = BoucWenParameters { lag_s: 0.0, n: 1.0, ..*of },
            _ => unreachable!("the two models"),
        }
        parameters
    })
}

/// Each with the deadband and without.
fn pairs() -> [[Engine<f64>; 2]; 2] {
    without_lag().map(|parameters| {
        [DEADBAND, 0.0].map(|deadband| {
            parameters.build(&Discretisation { sample_period: 5e-4, scheme: Scheme::ForwardEuler, deadband })
        })
    })
}

/// Displacements at voltages.
fn run(engine: &mut Engine<f64>, voltages: &[f64]) -> Vec<f64> {
    voltages.iter().map(|&voltage| engine.step(voltage, None)).collect()
}

/// From each of these voltages to the next in so many ticks.
fn legs(turns: &[f64], ticks: u32) -> Vec<f64> {
    let leg = |pair: &[f64]| {
        let (from, to) = (pair[0], pair[1]);
        (1..=ticks).map(move |k| from + (to - from) * f64::from(k) / f64::from(ticks))
    };
    turns.windows(2).flat_map(leg).collect()
}

proptest! {
    /// Neither shifted by the deadband nor cut short at the turns, at every tick.
    #[test]
    fn reversals_beyond_the_deadband_have_the_equation_s_own_answer(
        swings in prop::collection::vec(1.51 * DEADBAND..60.0, 2..12),
        ticks in 1u32..60,
    ) {
        let mut turns = vec![10.0];
        for (k, swing) in swings.iter().enumerate() {
            let last = turns[k];
            turns.push(if k % 2 == 0 { last + swing } else { last - swing });
        }
        for [mut held, mut plain] in pairs() {
            let voltages = legs(&turns, ticks);
            for (a, b) in run(&mut held, &voltages).into_iter().zip(run(&mut plain, &voltages)) {
                prop_assert!((a - b).abs() < 1e-9, "{} against {}", a, b);
            }
        }
    }

    /// To and fro on one curve, and from there on as if it had not been.
    #[test]
    fn what_stays_within_the_deadband_leaves_nothing_behind(
        noise in prop::collection::vec(-0.749 * DEADBAND..0.749 * DEADBAND, 1..300),
    ) {
        for [mut noisy, _] in pairs() {
            // Three quarters of a deadband back from where the voltage turned, in the middle of what the play allows.
            let middle = 30.0;
            run(&mut noisy, &legs(&[-20.0, middle + 0.75 * DEADBAND, middle], 50));
            let mut still = noisy.clone();
            let voltages: Vec<f64> = noise.iter().map(|volts| middle + volts).collect();
            run(&mut noisy, &voltages);
            let onwards = legs(&[middle, 60.0, 20.0], 40);
            prop_assert_eq!(run(&mut noisy, &onwards), run(&mut still, &onwards));
        }
    }

    /// No retreat is one at which it jumps: a microvolt more makes less than a picometre.
    #[test]
    fn what_is_shown_is_continuous(retreat in 0.0..4.0 * DEADBAND) {
        for [engine, _] in pairs() {
            let at = |volts: f64| {
                let mut engine = engine.clone();
                *run(&mut engine, &[-20.0, 40.0, 40.0 - retreat, 40.0 - retreat - volts]).last().unwrap()
            };
            prop_assert!((at(0.0) - at(1e-6)).abs() < 1e-6, "{} and {}", at(0.0), at(1e-6));
        }
    }
}

/// Of codes, which retreat by whole numbers: whatever the number and wherever the voltage turns, an `f32` keeps what
/// an `f64` keeps.
#[test]
fn the_rounding_decides_nothing_that_is_kept() {
    const CODES: u16 = 15;
    let step = 60.0 / 4095.0f32;
    let deadband = extremum::between_codes(f32::from(CODES) * step, step);
    let volts = |code: u16| f32::from(code) * step - 20.0;
    for parameters in without_lag() {
        let single =
            parameters.build::<f32>(&Discretisation { sample_period: 5e-4, scheme: Scheme::ForwardEuler, deadband });
        let double = parameters.build::<f64>(&Discretisation {
            sample_period: 5e-4,
            scheme: Scheme::ForwardEuler,
            deadband: deadband.into(),
        });
        for peak in (500..3500).step_by(7) {
            for retreat in [
                CODES,
                CODES + 1,
                3 * CODES / 2,
                3 * CODES / 2 + 1,
                3 * CODES / 2 + 2,
                2 * CODES,
                2 * CODES + 1,
                2 * CODES + 2,
            ] {
                let (mut single, mut double) = (single.clone(), double.clone());
                let codes = [0, peak, peak - retreat, peak + 100];
                let ends: Vec<(f32, f64)> = codes
                    .into_iter()
                    .map(|code| {
                        (single.step(volts(code), None), double.step(f64::from(code) * f64::from(step) - 20.0, None))
                    })
                    .collect();
                let (one, other) = ends[3];
                // What only one of them keeps makes 0.03 µm and more.
                assert!((f64::from(one) - other).abs() < 1e-4, "{peak} {retreat}: {one} {other}");
            }
        }
    }
}
