//! Laws that several models obey, each stated once.
#![allow(dead_code, reason = "each test crate uses its part")]

use estimator_core::{Linear, Range, Real, Recursion};
use proptest::prelude::*;
use serde::{Serialize, de::DeserializeOwned};
use std::fmt::Debug;

/// Parameters come back from a record's bytes as they were.
pub fn survives_the_wire<P: Serialize + DeserializeOwned + PartialEq + Debug>(parameters: P) {
    let mut buffer = [0; 512];
    let bytes = postcard::to_slice(&parameters, &mut buffer).unwrap();
    assert_eq!(postcard::from_bytes::<P>(bytes), Ok(parameters));
}

/// The second of two equal cycles closes, and the displacement is lower on the way up.
pub fn loops_close_and_lag(model: &impl Recursion<f64>) {
    let mut state = model.begin(0.0, None);
    let (mut ends, mut area, mut last) = (Vec::new(), 0.0, (0.0, 0.0));
    for cycle in 0..6 {
        for k in 0..2000 {
            let voltage = if k < 1000 { 0.1 * f64::from(k) } else { 0.1 * f64::from(2000 - k) };
            let y = model.step(&mut state, voltage);
            if cycle == 5 {
                area += 0.5 * (y + last.1) * (voltage - last.0);
            }
            last = (voltage, y);
        }
        ends.push(last.1);
    }
    assert!((ends[5] - ends[4]).abs() < 1e-9, "{ends:?}");
    assert!(area < -10.0, "{area}");
}

/// A run, and one that passes through voltages in between, at the same instants.
pub fn at_two_rates(run: impl Fn(&[f64]) -> Vec<f64>, voltages: &[f64], between: u32) -> (Vec<f64>, Vec<f64>) {
    let mut slow = vec![voltages[0]];
    for pair in voltages.windows(2) {
        slow.extend((1..between).map(|i| pair[0] + (pair[1] - pair[0]) * f64::from(i) / f64::from(between)));
        slow.push(pair[1]);
    }
    (run(voltages), run(&slow).into_iter().step_by(between as usize).collect())
}

/// No voltages carry the displacement further than `slack` beyond its reach.
pub fn stays_within<T: Real>(
    reach: Range<T>,
    slack: T,
    model: &impl Recursion<T>,
    voltages: impl IntoIterator<Item = T>,
    known: Option<T>,
) -> Result<(), TestCaseError> {
    let mut voltages = voltages.into_iter().peekable();
    let mut state = model.begin(*voltages.peek().unwrap(), known);
    for voltage in voltages {
        let y = model.step(&mut state, voltage);
        prop_assert!(reach.min - slack <= y && y <= reach.max + slack, "{} not in {:?}", y, reach);
    }
    Ok(())
}

/// What the weights weigh.
pub fn columns<T: Real, M: Linear<T>>(model: &M, state: &M::State) -> Vec<T> {
    let mut columns = Vec::new();
    model.columns(state, |column| columns.push(column));
    columns
}

/// The columns, weighed, are the displacement to within `error`, whether it was asked for or not.
pub fn columns_weigh_to_the_displacement(
    model: &impl Linear<f64>,
    weights: &[f64],
    start: f64,
    voltages: impl IntoIterator<Item = f64>,
    error: f64,
) -> Result<(), TestCaseError> {
    let (mut stepped, mut advanced) = (model.begin(start, None), model.begin(start, None));
    for voltage in voltages {
        let displacement = model.step(&mut stepped, voltage);
        model.advance(&mut advanced, voltage);
        for columns in [&stepped, &advanced].map(|state| columns(model, state)) {
            prop_assert_eq!(columns.len(), weights.len());
            let sum: f64 = columns.iter().zip(weights).map(|(column, weight)| column * weight).sum();
            prop_assert!((sum - displacement).abs() < error, "{} against {}", sum, displacement);
        }
    }
    Ok(())
}
