//! How far the tabulated form can be from the direct one.
//!
//! Between two reversals the error obeys `e ← a(V)·e + δ(V)`, where δ is what interpolation adds in a tick: at most
//! `|Δa|·Y + |Δc| + |Δm|·E` for displacements up to Y and extremum terms up to E. If `|e| ≤ B` with
//! `B = max δ(V)/(1 − a(V))`, then `a·B + (1 − a)·B = B` bounds the next error too. B is taken over every voltage that the
//! lookup serves, sixteen to an interval, from the f32 lookup the target has against the f64 direct form. The rounding
//! of the recursion itself is no part of it, nor is what an error at a reversal does through the displacement term.

use estimator_core::{Form, Lookup, Range, Table};

/// Between the sampled voltages the error is a little larger.
const SAMPLING: f64 = 1.01;
/// Voltages an interval between knots is sampled at.
const SAMPLES: u32 = 16;

/// Bound of the displacement error between two reversals that tabulating a table's model adds, µm; 0 for a model that has no
/// tabulated form.
pub fn error_bound(table: &Table) -> f64 {
    let (Some(single), Some(direct)) = (table.coefficients::<f32>(), table.coefficients::<f64>()) else { return 0.0 };
    let lookup = Lookup::tabulate(&single, table.voltage_range_v);
    let voltage: Range<f64> = table.voltage_range_v.of();
    let limits: Range<f64> = table.displacement_limits_um.of();
    let displacement = limits.min.abs().max(limits.max.abs());
    let term = |of: &dyn Fn(f64) -> f64, range: Range<f64>| of(range.min).abs().max(of(range.max).abs());
    let ext = term(&|v| direct.voltage_term(v), voltage) + term(&|y| direct.displacement_term(y), limits);
    let count = SAMPLES * estimator_core::lookup::KNOTS as u32;
    let error = |sample: u32| {
        // Through f32, as the target has it: both forms must be asked at the same voltage.
        let v = (voltage.min + voltage.span() * f64::from(sample) / f64::from(count)) as f32;
        let (exact, tabulated) = (direct.terms(f64::from(v)), lookup.terms(v));
        let delta = (exact.a - f64::from(tabulated.a)).abs() * displacement
            + (exact.c - f64::from(tabulated.c)).abs()
            + (exact.m - f64::from(tabulated.m)).abs() * ext;
        delta / (1.0 - exact.a)
    };
    SAMPLING * (0..=count).map(error).fold(0.0, f64::max)
}

/// The table in its tabulated form, with its error bound.
pub fn tabulated(table: Table) -> Table {
    let bound = error_bound(&table) as f32;
    Table { form: Form::Tabulated { error_bound_um: bound.next_up() }, ..table }
}
