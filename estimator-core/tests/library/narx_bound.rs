//! NARX: its clamp, and the contraction by which two runs come together.

use crate::laws;
use crate::narx::linear;
use estimator_core::model::{Narx, NarxParameters, Published, Recursion};
use estimator_core::{List, Range};
use proptest::prelude::*;

/// Of these orders and degree, with v_ext and y_ext or not, and as many of the coefficients as that has, times `scale`.
fn scaled(orders: (u8, u8, u8), extrema: (bool, bool), coefficients: &[f32], scale: f32) -> NarxParameters {
    let mut p = linear(List::of([]), orders.0, orders.1);
    (p.degree, p.with_voltage_extremum, p.with_displacement_extremum) = (orders.2, extrema.0, extrema.1);
    p.coefficients = List::collect(coefficients[..p.count()].iter().map(|c| c * scale)).unwrap();
    p
}

/// By hand: y' = 0.5 y + 0.1 v·y − 0.2 y·y_ext, over v of −1 … 1, y and y_ext of −2.5 … 2.5.
#[test]
fn the_contraction_is_the_sum_of_the_derivatives_and_what_spreads_is_refused_with_a_remedy() {
    let mut coefficients = [0.0f32; 10];
    (coefficients[0], coefficients[4], coefficients[7]) = (0.5, 0.1, -0.2);
    let p = NarxParameters { degree: 2, with_displacement_extremum: true, ..linear(List::of(coefficients), 1, 1) };
    assert_eq!((p.check(), p.count()), (Ok(()), 10));
    let model = Narx::<f32>::build(&p, 5e-4);
    let range = Range { min: 0.0, max: 100.0 };
    let contraction = model.contraction(range);
    assert!((contraction - (0.5 + 0.1 + 0.2 * 2.5 + 0.2 * 2.5)).abs() < 1e-6, "{contraction}");
    let limits = Range { min: -40.0, max: 60.0 };
    let refused = model.bound(range, limits).unwrap_err().to_string();
    assert!(refused.contains("times as large") && refused.contains("narrower limits_um"), "{refused}");
    let narrow = NarxParameters { limits_um: Range { min: -5.0, max: 25.0 }, ..p };
    assert!(Narx::<f32>::build(&narrow, 5e-4).bound(range, limits).is_ok());
    // A stable linear part is not enough: ŷ stays, or falls, by what the rounding says.
    let oscillates = linear(List::of([1.9, -0.95, 0.1, 0.0]), 2, 1);
    assert_eq!(oscillates.check(), Ok(()));
    assert!(Narx::<f32>::build(&oscillates, 5e-4).bound(range, limits).is_err());
}

proptest! {
    #[test]
    fn clamped_whatever_the_coefficients(
        orders in (1u8..=3, 1u8..=3, 1u8..=3),
        extrema in (any::<bool>(), any::<bool>()),
        coefficients in prop::collection::vec(prop_oneof![-2f32..2.0, -1e30f32..1e30, any::<f32>()], 0..=40),
        start in prop::option::of(any::<f32>()),
        voltages in prop::collection::vec(0f32..100.0, 1..100),
    ) {
        let p = NarxParameters {
            degree: orders.2,
            with_voltage_extremum: extrema.0,
            with_displacement_extremum: extrema.1,
            ..linear(List::collect(coefficients).unwrap(), orders.0, orders.1)
        };
        let model = Narx::<f32>::build(&p, 5e-4);
        let reach = model.reach(Range { min: 0.0, max: 100.0 }).unwrap();
        prop_assert_eq!(reach, p.limits_um);
        laws::stays_within(reach, 0.0, &model, voltages, start)?;
    }

    /// The bound on the contraction is above every difference quotient. Two runs of what is admitted come together as
    /// ρ^⌊n/r_y⌋, or, where a displacement at a reversal is among the inputs, part no further than they began.
    #[test]
    fn what_contracts_forgets_where_it_began(
        orders in (1u8..=3, 1u8..=3, 1u8..=3),
        extrema in (any::<bool>(), any::<bool>()),
        (share, coefficients) in (0.05f32..1.5, prop::collection::vec(-1f32..1.0, 39)),
        voltages in prop::collection::vec(0f64..100.0, 300..301),
        starts in (-40.0f64..60.0, -40.0f64..60.0),
    ) {
        let of = |scale: f32| scaled(orders, extrema, &coefficients, scale);
        let range = Range { min: 0.0, max: 100.0 };
        // The contraction is proportional to the coefficients: a share of what is just admitted, or more.
        let p = of(share / Narx::<f64>::build(&of(1.0), 5e-4).contraction(range) as f32);
        let model = Narx::<f64>::build(&p, 5e-4);
        let contraction = model.contraction(range);
        prop_assert!((contraction - f64::from(share)).abs() < 1e-4);
        let admitted = model.bound(range, Range { min: -40.0, max: 60.0 }).is_ok();
        prop_assert_eq!(admitted, contraction <= 4095.0 / 4096.0);
        let (mut one, mut other) = (model.begin(voltages[0], Some(starts.0)), model.begin(voltages[0], Some(starts.1)));
        let first = (starts.0 - starts.1).abs();
        let mut apart = std::collections::VecDeque::from([first; 3]);
        let mut largest = first;
        for (n, voltage) in voltages.into_iter().enumerate() {
            let now = (model.step(&mut one, voltage) - model.step(&mut other, voltage)).abs();
            let before = if extrema.1 { largest } else { apart.iter().take(orders.0.into()).copied().fold(0.0, f64::max) };
            prop_assert!(now <= contraction * before + 1e-9, "{} µm apart after {}, with {}", now, before, contraction);
            if admitted {
                // The tick n is the n + 1st of the run.
                let shrinks = if extrema.1 { 1 } else { (n as i32 + 1) / i32::from(orders.0) };
                let most = contraction.powi(shrinks) * first;
                prop_assert!(now <= most + 1e-9, "{} µm apart after {} ticks, not {}", now, n + 1, most);
            }
            apart.push_front(now);
            largest = largest.max(now);
        }
    }
}
