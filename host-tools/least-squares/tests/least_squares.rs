//! Least squares with and without signs, against what defines a solution.

use least_squares::{Normal, Sign, Waiting};
use proptest::prelude::*;

const FREE: Sign = Sign::Free;
const LIMITED: Sign = Sign::NonNegative;

#[derive(Clone, Debug)]
struct Problem {
    rows: Vec<(Vec<f64>, f64, f64)>,
    sign: Vec<Sign>,
}

impl Problem {
    fn normal(&self) -> Normal {
        let mut normal = Normal::new(self.sign.len());
        self.rows.iter().for_each(|(row, target, weight)| normal.add(row, *target, *weight));
        normal
    }

    fn cost(&self, x: &[f64]) -> f64 {
        let error = |row: &[f64], target: f64| row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - target;
        self.rows.iter().map(|(row, target, weight)| weight * error(row, *target).powi(2)).sum()
    }

    /// Half of the slope of the cost along each column of unit norm, as a fraction of the target's norm.
    fn slopes(&self, x: &[f64]) -> Vec<f64> {
        let whole = self.cost(&vec![0.0; x.len()]).sqrt().max(f64::MIN_POSITIVE);
        let slope = |i: usize| {
            let (mut slope, mut norm) = (0.0, 0.0);
            for (row, target, weight) in &self.rows {
                let error = row.iter().zip(x).map(|(a, x)| a * x).sum::<f64>() - target;
                slope += weight * row[i] * error;
                norm += weight * row[i] * row[i];
            }
            if norm > 0.0 { slope / norm.sqrt() / whole } else { 0.0 }
        };
        (0..x.len()).map(slope).collect()
    }

    /// The least cost over all choices of columns held at 0 whose least squares is admissible.
    fn exhaustive(&self) -> f64 {
        let n = self.sign.len();
        let solution = |held: usize| {
            let row =
                |row: &[f64]| row.iter().enumerate().map(|(i, a)| if held >> i & 1 == 1 { 0.0 } else { *a }).collect();
            let rows = self.rows.iter().map(|(a, target, weight)| (row(a), *target, *weight)).collect();
            let sign = vec![FREE; n];
            Self { rows, sign: sign.clone() }.normal().solve(&sign).expect("solvable")
        };
        let admissible = |x: &Vec<f64>| x.iter().zip(&self.sign).all(|(x, sign)| *sign == FREE || *x >= 0.0);
        (0..1 << n).map(solution).filter(admissible).map(|x| self.cost(&x)).fold(f64::INFINITY, f64::min)
    }
}

/// Columns of widely different scales, some collinear or zero.
fn problem() -> impl Strategy<Value = Problem> {
    let shape = (1usize..6, 1usize..25);
    shape.prop_flat_map(|(n, m)| {
        let row = (prop::collection::vec(-1.0..1.0, n), -1.0..1.0, 0.01..2.0);
        let column = (-6..6i32, 0..6usize, 0..n);
        let sign = prop::collection::vec(prop_oneof![1 => Just(FREE), 2 => Just(LIMITED)], n);
        (prop::collection::vec(row, m), prop::collection::vec(column, n), sign).prop_map(
            |(mut rows, columns, sign): (Vec<(Vec<f64>, f64, f64)>, _, _)| {
                for (row, _, _) in &mut rows {
                    for (i, &(scale, kind, other)) in columns.iter().enumerate() {
                        let factor = 10f64.powi(scale);
                        row[i] = match kind {
                            0 => 0.0,
                            1 => row[other] * factor,
                            2 => -row[other] * factor,
                            _ => row[i] * factor,
                        };
                    }
                }
                Problem { rows, sign }
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_solution_meets_the_conditions_of_karush_kuhn_and_tucker(problem in problem()) {
        let x = problem.normal().solve(&problem.sign).expect("solvable");
        for ((&x, slope), &sign) in x.iter().zip(problem.slopes(&x)).zip(&problem.sign) {
            prop_assert!(sign == FREE || x >= 0.0);
            prop_assert!(slope > -1e-5, "{slope} at {x}");
            prop_assert!(slope < 1e-5 || (sign == LIMITED && x == 0.0), "{slope} at {x}");
        }
    }

    #[test]
    fn no_choice_of_active_columns_is_better(problem in problem()) {
        let x = problem.normal().solve(&problem.sign).expect("solvable");
        let whole = problem.cost(&vec![0.0; x.len()]);
        prop_assert!(problem.cost(&x) <= problem.exhaustive() + 1e-8 * whole);
    }

    #[test]
    fn an_unconstrained_solution_that_is_admissible_is_the_solution(
        mut problem in problem(), known in prop::collection::vec(0.1..3.0, 6)
    ) {
        for (row, target, _) in &mut problem.rows {
            *target = row.iter().zip(&known).map(|(a, x)| a * x).sum();
        }
        let normal = problem.normal();
        let free = normal.solve(&vec![FREE; problem.sign.len()]).expect("solvable");
        let limited = normal.solve(&vec![LIMITED; problem.sign.len()]).expect("solvable");
        let whole = problem.cost(&vec![0.0; limited.len()]);
        prop_assert!(problem.cost(&limited) <= 1e-8 * whole);
        if free.iter().all(|x| *x >= 0.0) {
            for (i, (limited, free)) in limited.iter().zip(&free).enumerate() {
                let norm: f64 = problem.rows.iter().map(|(row, _, weight)| weight * row[i] * row[i]).sum();
                let share = (limited - free) * norm.sqrt();
                prop_assert!(share.abs() <= 1e-5 * whole.sqrt(), "{limited} {free}");
            }
        }
    }

    #[test]
    fn the_residual_sum_is_that_of_the_rows(problem in problem(), x in prop::collection::vec(-2.0..2.0, 6)) {
        let x = &x[..problem.sign.len()];
        let (expected, size) = (problem.cost(x), x.iter().map(|x| x.abs()).sum::<f64>() * 1e6 + 1.0);
        let rounding = 1e-13 * size * size * problem.rows.len() as f64;
        let found = problem.normal().residual_sum(x);
        prop_assert!((found - expected).abs() <= rounding.max(1e-9 * expected));
    }
}

#[test]
fn known_coefficients_are_found_whatever_their_scale() {
    let mut normal = Normal::new(3);
    for i in 0..1000 {
        let t = f64::from(i) * 0.01;
        let row = [1e6, t, 1e-6 * (3.0 * t).sin()];
        normal.add(&row, 1e6 * 2e-6 - 0.5 * t + 1e-6 * 4e6 * (3.0 * t).sin(), 0.3);
    }
    let x = normal.solve(&[LIMITED, FREE, LIMITED]).unwrap();
    for (x, expected) in x.iter().zip([2e-6, -0.5, 4e6]) {
        assert!((x / expected - 1.0).abs() < 1e-6, "{x} {expected}");
    }
    let x = normal.solve(&[LIMITED; 3]).unwrap();
    assert_eq!(x[1], 0.0);
    assert!(x[0] >= 0.0 && x[2] > 0.0);
}

#[test]
fn collinear_columns_share_and_a_column_of_zeros_gets_nothing() {
    let mut normal = Normal::new(3);
    for i in 0..20 {
        let t = f64::from(i);
        normal.add(&[t, t, 0.0], 4.0 * t, 1.0);
    }
    let x = normal.solve(&[LIMITED, FREE, FREE]).unwrap();
    assert!((x[0] + x[1] - 4.0).abs() < 1e-6 && x[2] == 0.0, "{x:?}");
    assert!((x[0] - x[1]).abs() < 1e-5, "{x:?}");
}

#[test]
fn nothing_to_solve_is_solved_and_what_cannot_be_is_not() {
    assert_eq!(Normal::new(0).solve(&[]), Some(vec![]));
    assert_eq!(Normal::new(2).solve(&[FREE, LIMITED]), Some(vec![0.0, 0.0]));
    assert_eq!(Normal::new(2).solve(&[FREE]), None);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut normal = Normal::new(2);
        normal.add(&[1.0, bad], 1.0, 1.0);
        assert_eq!(normal.solve(&[LIMITED, FREE]), None);
        let mut normal = Normal::new(1);
        normal.add(&[1.0], bad, 1.0);
        assert_eq!(normal.solve(&[FREE]), None);
    }
}

#[test]
fn the_ridge_draws_towards_zero() {
    let mut normal = Normal::new(1);
    normal.add(&[3.0], 6.0, 2.0);
    let x = normal.clone().ridge(1.0).solve(&[FREE]).unwrap();
    assert!((x[0] - 1.0).abs() < 1e-12);
    assert!((normal.solve(&[FREE]).unwrap()[0] - 2.0).abs() < 1e-8);
    assert!((normal.residual_sum(&x) - 18.0).abs() < 1e-12);
}

/// Rows in numbers that are no multiple of those added together, some with columns of zeros.
#[test]
fn rows_added_together_give_the_bits_of_rows_added_one_by_one() {
    for count in [0, 1, 4, 7, 33, 64, 65, 130] {
        let row = |i: usize| [1.0 / (1.0 + i as f64), (i as f64).sin(), if i < 9 { 0.0 } else { 1.0 }];
        let rows: Vec<[f64; 3]> = (0..count).map(row).collect();
        let targets: Vec<f64> = (0..count).map(|i| (0.3 * i as f64).cos()).collect();
        let (mut together, mut one_by_one) = (Normal::new(3), Normal::new(3));
        let mut waiting = Waiting::of_weight(0.1);
        rows.iter().zip(&targets).for_each(|(row, &target)| waiting.add(&mut together, row, target));
        waiting.finish(&mut together);
        rows.iter().zip(&targets).for_each(|(row, &target)| one_by_one.add(row, target, 0.1));
        assert_eq!(together, one_by_one, "{count} rows");
    }
}

/// Two problems that share their first column, in powers of two, so that sums have one value in any order.
#[test]
fn merged_problems_are_the_problem_of_all_their_rows() {
    let mut merged = Normal::new(3);
    let mut whole = Normal::new(3);
    for (columns, weight) in [([0, 1], 2.0), ([0, 2], 0.5)] {
        let mut part = Normal::new(2);
        for (row, target) in [([1.0, 2.0], 4.0), ([0.5, -1.0], 1.0), ([8.0, 0.25], -2.0)] {
            part.add(&row, target, 1.0);
            let mut wide = [0.0; 3];
            columns.iter().zip(row).for_each(|(&column, value)| wide[column] = value);
            whole.add(&wide, target, weight);
        }
        merged.merge(&part, &columns, weight);
    }
    assert_eq!(merged, whole);
}
