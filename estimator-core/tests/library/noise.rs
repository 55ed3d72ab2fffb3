//! What a converter's noise does at rest: nobody moves, and the estimate must not either.
//!
//! A major loop, half of the way back, then rest. One estimator is given the same code at every tick, another one
//! that code with normal noise. What lies between their means is the drift that the noise makes. Duhem's and
//! Bouc-Wen's equations advance with the length of the voltage's path, of which noise has no end: their memory is
//! held within the deadband.

use crate::common::converter::table_read_by_12_bits;
use estimator_core::*;

/// With hysteresis in every model that can have some, and no lag that filters the noise where there need be none.
fn table(model: Model, deadband_codes: f32) -> Admitted {
    let mut table = table_read_by_12_bits(model, deadband_codes);
    if model != Model::GeneralisedPrandtlIshlinskii {
        table.parameters = table.parameters.with_lag(0.0);
    }
    match &mut table.parameters {
        Parameters::Duhem(of) => *of = DuhemParameters { alpha_per_v: 0.1, g0_um_per_v: 0.12, ..*of },
        Parameters::BoucWen(of) => *of = BoucWenParameters { n: 1.0, ..*of },
        Parameters::VoltageExtremum(of) => *of = VoigtParameters { g_um_per_s: -3.0, h: 0.6, ..*of },
        Parameters::DisplacementExtremum(of) => *of = VoigtParameters { e_m_per_s: 2e-5, f: 1.1, ..*of },
        Parameters::Enhanced(of) => {
            *of = VoigtParameters { g_um_per_s: -3.0, h: 0.6, e_m_per_s: 2e-5, f: 1.1, ..*of };
        }
        _ => {}
    }
    table.admit().unwrap_or_else(|error| panic!("{model}: {error}"))
}

/// Normal noise of deviation 1: Box and Muller's transform of a linear congruential generator (Knuth's MMIX).
fn normal(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((*state >> 11) as f64 + 0.5) / 9_007_199_254_740_992.0
    };
    let (radius, angle) = (uniform(), uniform());
    (-2.0 * libm::log(radius)).sqrt() * libm::cos(std::f64::consts::TAU * angle)
}

/// A major loop twice, then from the lower end to the middle of the range, V.
fn major_loop_and_half_way_back(Range { min, max }: Range) -> Vec<f32> {
    let middle = 0.5 * (min + max);
    let leg = |from: f32, to: f32| (0..400).map(move |k| from + (to - from) * k as f32 / 400.0);
    let ways = [(middle, max), (max, min), (min, max), (max, min), (min, middle)];
    ways.into_iter().flat_map(|(from, to)| leg(from, to)).collect()
}

/// Drifts (of the displacement that the major loop covers) after 0.5 s and 10 s at rest, by noise of so many codes rms.
fn drifts(table: &Admitted, codes: f64) -> [f64; 2] {
    let (mut still, mut noisy) = (Estimator::<f32>::new(table), Estimator::<f32>::new(table));
    let mut covered = Range::empty();
    for voltage in major_loop_and_half_way_back(table.voltage_range_v) {
        let code = table.adc.code(voltage);
        covered = covered.include(still.tick(code).displacement);
        noisy.tick(code);
    }
    let rest: AdcCode = table.adc.code(table.voltage_range_v.middle());
    let mut random = 1;
    let apart: Vec<f64> = (0..20_000)
        .map(|_| {
            let read = (f64::from(rest.0) + codes * normal(&mut random)).round() as u16;
            f64::from(noisy.tick(AdcCode(read)).displacement - still.tick(rest).displacement)
        })
        .collect();
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len() as f64 / f64::from(covered.span());
    [mean(&apart[500..1_000]), mean(&apart[19_000..])]
}

#[test]
fn noise_at_rest_does_not_wipe_out_what_a_model_remembers() {
    for model in Model::ALL {
        for codes in [0.5f32, 1.0, 2.0] {
            // As `piezo identify` takes it: eight deviations.
            let drifts = drifts(&table(model, 8.0 * codes), codes.into());
            // A code is a 3723rd of the voltages. In 20,000 draws the noise is now and then four deviations off, and as
            // far a memory is moved once.
            let most = 4.0 * f64::from(codes) / 3723.0;
            assert!(
                drifts.iter().all(|drift| drift.abs() < most),
                "{model}: noise of {codes} codes makes it drift by {drifts:?}"
            );
        }
    }
}

#[test]
fn without_a_deadband_it_does() {
    for model in [Model::Duhem, Model::BoucWen] {
        let [_, drift] = drifts(&table(model, 0.0), 1.0);
        assert!(drift > 0.03, "{model}: {drift}");
    }
}
