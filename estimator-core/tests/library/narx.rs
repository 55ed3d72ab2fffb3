//! NARX: its monomials, its fit by least squares, its rules.

use crate::laws;
use estimator_core::model::{Narx, NarxParameters, NarxState, Published, Recursion};
use estimator_core::{List, Range};
use proptest::prelude::*;

pub fn linear(coefficients: List<40>, output_order: u8, input_order: u8) -> NarxParameters {
    NarxParameters {
        output_order,
        input_order,
        degree: 1,
        with_voltage_extremum: false,
        with_displacement_extremum: false,
        voltage_centre_v: 50.0,
        voltage_scale_v: 50.0,
        displacement_centre_um: 10.0,
        displacement_scale_um: 20.0,
        deadband_v: 0.0,
        coefficients,
        limits_um: Range { min: -40.0, max: 60.0 },
    }
}

fn row(model: &Narx<f64>, state: &NarxState<f64>) -> Vec<f64> {
    let mut row = Vec::new();
    model.row(state, |monomial| row.push(monomial));
    row
}

/// A repeatable voltage without a pattern, −1 … 1.
fn noise(seed: &mut u32) -> f64 {
    *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    f64::from(*seed >> 8) / f64::from(1u32 << 23) - 1.0
}

#[test]
fn an_autoregressive_system_is_reproduced() {
    let p = linear(List::of([1.2, -0.5, 0.1, 0.2, 0.05, 0.01]), 2, 3);
    assert_eq!((p.check(), p.count()), (Ok(()), 6));
    let model = Narx::<f64>::build(&p, 5e-4);
    let c: Vec<f64> = p.coefficients.iter().map(|&c| c.into()).collect();
    let (mut y, mut v, mut seed) = ([0.25, 0.25], [0.3, 0.3, 0.3], 1);
    let mut state = model.begin(65.0, Some(15.0));
    for _ in 0..1000 {
        v = [noise(&mut seed), v[0], v[1]];
        y = [c[0] * y[0] + c[1] * y[1] + c[2] * v[0] + c[3] * v[1] + c[4] * v[2] + c[5], y[0]];
        let found = model.step(&mut state, 50.0 + 50.0 * v[0]);
        assert!((found - (10.0 + 20.0 * y[0])).abs() < 1e-9);
    }
}

#[test]
fn monomials_are_in_the_stated_order() {
    let p = NarxParameters {
        degree: 3,
        with_voltage_extremum: true,
        with_displacement_extremum: true,
        ..linear(List::of([]), 3, 2)
    };
    let model = Narx::<f64>::build(&p, 5e-4);
    let mut state = model.begin(50.0, Some(10.0));
    // Up to v = 0.5, y = 0.75, then down.
    for (voltage, displacement) in [(60.0, 12.0), (75.0, 25.0), (65.0, 20.0)] {
        model.observe(&mut state, voltage, displacement);
    }
    let letters = [0.3, 0.5, 0.5, 0.75];
    let mut expected = vec![0.5, 0.75, 0.1, 0.3, 0.5, 0.5, 0.75];
    for i in 0..4 {
        for j in i..4 {
            expected.push(letters[i] * letters[j]);
        }
    }
    for i in 0..4 {
        for j in i..4 {
            for k in j..4 {
                expected.push(letters[i] * letters[j] * letters[k]);
            }
        }
    }
    expected.push(1.0);
    let found = row(&model, &state);
    assert_eq!((found.len(), p.count()), (expected.len(), expected.len()));
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() < 1e-12, "{found:?} {expected:?}");
    }
}

#[test]
fn the_count_is_that_of_the_monomials_and_extrema_come_only_when_asked() {
    let mut most = 0;
    for bits in 0..4u8 {
        let (with_voltage_extremum, with_displacement_extremum) = (bits & 1 != 0, bits & 2 != 0);
        for order in 1..=3 {
            for degree in 1..=3 {
                let base = linear(List::of([]), order, 4 - order);
                let p = NarxParameters { degree, with_voltage_extremum, with_displacement_extremum, ..base };
                let model = Narx::<f64>::build(&p, 5e-4);
                // The same last values after different reversals.
                let after = |reversal: (f64, f64)| {
                    let mut state = model.begin(50.0, Some(10.0));
                    for (voltage, displacement) in [(40.0, 9.0), reversal, (60.0, 13.0), (59.0, 12.0), (58.0, 11.0)] {
                        model.observe(&mut state, voltage, displacement);
                    }
                    row(&model, &state)
                };
                let (first, by_voltage, by_displacement) =
                    (after((70.0, 14.0)), after((90.0, 14.0)), after((70.0, 30.0)));
                assert_eq!(first.len(), p.count());
                assert_eq!(first != by_voltage, with_voltage_extremum);
                assert_eq!(first != by_displacement, with_displacement_extremum);
                most = most.max(first.len());
            }
        }
    }
    let all = NarxParameters {
        degree: 3,
        with_voltage_extremum: true,
        with_displacement_extremum: true,
        ..linear(List::of([]), 3, 3)
    };
    assert!(most <= all.count() && all.count() == 39);
}

/// Solves the normal equations of the rows by elimination with pivots.
fn least_squares(rows: &[(Vec<f64>, f64)]) -> Vec<f64> {
    let n = rows[0].0.len();
    let mut a = vec![vec![0.0; n + 1]; n];
    for (row, target) in rows {
        for i in 0..n {
            (0..n).for_each(|j| a[i][j] += row[i] * row[j]);
            a[i][n] += row[i] * target;
        }
    }
    for i in 0..n {
        let pivot = (i..n).max_by(|&p, &q| a[p][i].abs().total_cmp(&a[q][i].abs())).unwrap();
        a.swap(i, pivot);
        let above = a[i].clone();
        for (k, row) in a.iter_mut().enumerate() {
            if k != i {
                let factor = row[i] / above[i];
                (i..=n).for_each(|j| row[j] -= factor * above[j]);
            }
        }
    }
    (0..n).map(|i| a[i][n] / a[i][i]).collect()
}

/// The coefficients of a polynomial system come back from its own record, one step ahead.
#[test]
fn a_polynomial_system_is_identified_from_its_rows() {
    let mut seed = 7;
    let count = NarxParameters {
        degree: 3,
        with_voltage_extremum: true,
        with_displacement_extremum: true,
        ..linear(List::of([]), 2, 2)
    }
    .count();
    let coefficients: Vec<f32> = (0..count)
        .map(|i| match i {
            0 => 0.6,
            1 => -0.2,
            2 => 0.3,
            _ => 0.02 * noise(&mut seed) as f32,
        })
        .collect();
    let p = NarxParameters {
        degree: 3,
        with_voltage_extremum: true,
        with_displacement_extremum: true,
        ..linear(List::collect(coefficients.iter().copied()).unwrap(), 2, 2)
    };
    assert_eq!(p.check(), Ok(()));
    let system = Narx::<f64>::build(&p, 5e-4);
    let unfitted = Narx::<f64>::build(&NarxParameters { coefficients: List::of([]), ..p }, 5e-4);
    let (mut running, mut observed) = (system.begin(50.0, Some(10.0)), unfitted.begin(50.0, Some(10.0)));
    let (mut y, mut rows) = (10.0, Vec::new());
    for _ in 0..5000 {
        let voltage = 50.0 + 50.0 * noise(&mut seed);
        unfitted.observe(&mut observed, voltage, y);
        y = system.step(&mut running, voltage);
        rows.push((row(&unfitted, &observed), unfitted.normalise(y)));
    }
    for (found, expected) in least_squares(&rows).iter().zip(&coefficients) {
        assert!((found - f64::from(*expected)).abs() < 1e-6, "{found} {expected}");
    }
}

/// One-step prediction from the run's own displacements is the run.
#[test]
fn observing_its_own_displacements_is_running() {
    let base = linear(List::of([0.7, 0.2, 0.1, -0.05, 0.03, 0.02, 0.01, -0.02, 0.05, 0.0]), 1, 1);
    let p = NarxParameters { degree: 2, with_voltage_extremum: true, ..base };
    assert_eq!(p.check(), Ok(()));
    let model = Narx::<f32>::build(&p, 5e-4);
    let (mut run, mut observed) = (model.begin(20.0, Some(3.0)), model.begin(20.0, Some(3.0)));
    let (mut y, mut seed) = (3.0, 3);
    for _ in 0..500 {
        let voltage = 50.0 + 50.0 * noise(&mut seed) as f32;
        model.observe(&mut observed, voltage, y);
        y = model.step(&mut run, voltage);
        assert!((model.prediction(&observed) - y).abs() < 1e-4);
    }
}

#[test]
fn begins_where_it_stays() {
    let p = linear(List::of([1.9, -0.9025, 0.0025, 0.0001]), 2, 1);
    assert_eq!(p.check(), Ok(()));
    let model = Narx::<f64>::build(&p, 5e-4);
    let mut state = model.begin(75.0, None);
    let first = model.step(&mut state, 75.0);
    assert!((first - (10.0 + 20.0 * (0.0025 * 0.5 + 0.0001) / 0.0025)).abs() < 1e-2, "{first}");
    for _ in 0..2000 {
        assert!((model.step(&mut state, 75.0) - first).abs() < 1e-2);
    }
    assert!((model.prediction(&model.begin(75.0, Some(1e9))) - 60.0).abs() < 1e-9);
}

#[test]
fn what_breaks_a_rule_is_refused_and_still_builds() {
    let good = linear(List::of([0.9, 0.1, 0.0]), 1, 1);
    assert_eq!(good.check(), Ok(()));
    let bad = [
        NarxParameters { output_order: 0, ..good },
        NarxParameters { input_order: 4, ..good },
        NarxParameters { output_order: 255, input_order: 255, degree: 255, ..good },
        NarxParameters { degree: 0, ..good },
        NarxParameters { voltage_scale_v: 0.0, ..good },
        NarxParameters { displacement_scale_um: -1.0, ..good },
        NarxParameters { displacement_centre_um: f32::NAN, ..good },
        NarxParameters { deadband_v: -1.0, ..good },
        NarxParameters { limits_um: Range { min: 1.0, max: 1.0 }, ..good },
        NarxParameters { coefficients: List::of([0.9, 0.1]), ..good },
        NarxParameters { coefficients: List::of([1.0, 0.1, 0.0]), ..good },
        NarxParameters { coefficients: List::of([f32::NAN, 0.1, 0.0]), ..good },
    ];
    for bad in bad {
        assert!(bad.check().is_err(), "{bad:?}");
        let model = Narx::<f32>::build(&bad, 5e-4);
        let mut state = model.begin(1.0, None);
        model.step(&mut state, 30.0);
        model.observe(&mut state, 3.0, 30.0);
    }
}

#[test]
fn survives_the_wire() {
    laws::survives_the_wire(linear(List::of([0.9, 0.1, 0.0]), 1, 1));
}

proptest! {
    /// Jury's criterion beside the roots themselves.
    #[test]
    fn stable_is_what_has_its_roots_inside_the_unit_circle(
        real in -1.4f64..1.4, pair in (0f64..1.4, 0f64..std::f64::consts::PI), order in 1u8..=3,
    ) {
        // z − r, z² − 2·m·cos φ·z + m², and their product.
        let (sum, product) = (2.0 * pair.0 * pair.1.cos(), pair.0 * pair.0);
        let (outputs, largest) = match order {
            1 => (vec![real], real.abs()),
            2 => (vec![sum, -product], pair.0),
            _ => (vec![real + sum, -(product + real * sum), real * product], pair.0.max(real.abs())),
        };
        prop_assume!((largest - 1.0).abs() > 1e-3);
        let coefficients = List::collect(outputs.iter().map(|&c| c as f32).chain([0.1, 0.0])).unwrap();
        prop_assert_eq!(linear(coefficients, order, 1).check().is_ok(), largest < 1.0);
    }
}
