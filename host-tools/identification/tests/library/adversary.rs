//! Admission, attacked: the project's own optimisers look for the codes that draw an admitted table's displacement
//! furthest, or its two precisions furthest apart. What admission promises must hold of whatever they find, and limits
//! that what they found breaks must be refused.

#[path = "../../../../estimator-core/tests/library/common/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the core's tests use the rest")]
mod common;

use common::models::table_of;
use estimator_core::{
    AdcCode, Admitted, Estimator, GeneralisedPrandtlIshlinskiiParameters, Inadmissible, List, Model, NarxParameters,
    Parameters, Process, Range, Status, Table, TableError,
};
use minimisation::{Budget, Optimiser, each, minimise};

/// Stretches of a sequence; each has two levels to swing between, a length and how long it stays at a level.
const STRETCHES: usize = 4;
const GENES: usize = 4;
const EVALUATIONS: usize = 1_000;
/// What an `f32` may be off by, of the limits' span, as `precision.rs` of the core has it.
const APART: f64 = 2e-6;

/// The codes that a point of the unit cube stands for.
fn codes(at: &[f64], full_scale: u16) -> impl Iterator<Item = AdcCode> {
    let stretches: Vec<[f64; GENES]> = at.chunks(GENES).map(|genes| std::array::from_fn(|i| genes[i])).collect();
    stretches.into_iter().flat_map(move |[one, other, length, dwell]| {
        let code = move |level: f64| 1 + (level * f64::from(full_scale - 2)) as u16;
        let dwell = 1 + (dwell * dwell * 30.0) as usize;
        let ticks = 10 + (length * 300.0) as usize;
        (0..ticks).map(move |tick| AdcCode(code(if (tick / dwell).is_multiple_of(2) { one } else { other })))
    })
}

/// What a sequence does to a table.
struct Run {
    displaced: Range<f64>,
    /// Largest difference of the precisions, µm.
    apart: f64,
    clamped: bool,
}

fn run(table: &Admitted, at: &[f64]) -> Run {
    let (mut single, mut double) = (Estimator::<f32>::new(table), Estimator::<f64>::new(table));
    let mut run = Run { displaced: Range::empty(), apart: 0.0, clamped: false };
    for code in codes(at, table.adc.full_scale) {
        let (one, other) = (single.tick(code), double.tick(code));
        let displacement = f64::from(one.displacement);
        run.displaced = run.displaced.include(displacement);
        run.apart = run.apart.max((displacement - other.displacement).abs());
        run.clamped |= one.status.contains(Status::CLAMPED);
    }
    run
}

/// The run with the most of something.
fn worst(table: &Admitted, optimiser: Optimiser, stretches: usize, most: impl Fn(&Run) -> f64 + Sync) -> Run {
    let costs = each(|at: &[f64]| -most(&run(table, at)));
    let budget = Budget { evaluations: EVALUATIONS, seed: 1 };
    let minimum = minimise(optimiser, stretches * GENES, budget, &[], &costs, &mut |_, _| {});
    run(table, &minimum.at)
}

/// A table of the core's tests, with limits as tight as can be proven, a resonance's swing among it, and a thousandth
/// for what rounds.
fn table(model: Model) -> Table {
    let base = Table { drive: None, ..table_of(model) };
    let Range { min, max } = base.voltage_range_v;
    let adc = estimator_core::AdcCalibration {
        gain_v_per_code: (max - min) * 1.02 / 4095.0,
        offset_v: min - 0.01 * (max - min),
        ..base.adc
    };
    let wide = Range { min: -1e4, max: 1e4 };
    let reach = base.engine::<f32>().bound(base.voltage_range_v, wide);
    let limits = match reach {
        Ok(reach) if reach != wide => {
            Range { min: reach.min - 1e-3 * reach.span(), max: reach.max + 1e-3 * reach.span() }
        }
        _ => base.displacement_limits_um,
    };
    Table { adc, displacement_limits_um: limits, ..base }
}

#[test]
fn no_sequence_that_the_optimisers_find_leaves_the_limits_or_parts_the_precisions() {
    for model in Model::ALL {
        let table = table(model).admit().unwrap_or_else(|error| panic!("{model}: {error}"));
        let limits = table.displacement_limits_um;
        let span = f64::from(limits.span());
        let highest = worst(&table, Optimiser::DifferentialEvolution, STRETCHES, |run| run.displaced.max);
        let lowest = worst(&table, Optimiser::CmaEs, STRETCHES, |run| -run.displaced.min);
        let apart = worst(&table, Optimiser::DifferentialEvolution, STRETCHES, |run| run.apart);
        for run in [&highest, &lowest, &apart] {
            assert!(!run.clamped, "{model}: {:?} of {limits:?}", run.displaced);
            assert!(run.apart <= APART * span, "{model}: {} µm apart, of {span} µm", run.apart);
        }
        // The search is one: it goes over what the table can do, by bounds of which some are wide.
        let (low, high) = (lowest.displaced.min, highest.displaced.max);
        println!("{model}: {:.2} of the limits, {:.1e} apart", (high - low) / span, apart.apart / span);
        assert!(high - low > 0.1 * span, "{model}: {low} … {high} µm of {limits:?}");
        // Limits that do not hold what it has found are refused, with the reason.
        // NARX is held within limits of its own; what is refused of it is what spreads (below).
        if model == Model::Narx {
            continue;
        }
        let within = Range { min: (low + 0.01 * span) as f32, max: (high - 0.01 * span) as f32 };
        let Err(TableError::Inadmissible(reason)) = (Table { displacement_limits_um: within, ..*table }).admit() else {
            panic!("{model}: the limits {within:?} are admitted, and left")
        };
        assert!(reason.to_string().contains("µm, beyond"), "{model}: {reason}");
    }
}

/// A voltage that swings with the resonance goes most of the way that a table says it can.
#[test]
fn the_optimisers_find_the_resonance_that_a_table_tells_of() {
    let limits = table_of(Model::GeneralisedPrandtlIshlinskii).displacement_limits_um;
    let mut ringing = Table { displacement_limits_um: limits, ..table(Model::GeneralisedPrandtlIshlinskii) };
    let Parameters::GeneralisedPrandtlIshlinskii(of) = ringing.parameters else { panic!("the play model's") };
    ringing.parameters = Parameters::GeneralisedPrandtlIshlinskii(GeneralisedPrandtlIshlinskiiParameters {
        delay_ticks: 0.0,
        lag_s: 0.0,
        slew_v_per_s: 0.0,
        resonance_hz: 100.0,
        damping: 0.05,
        // Without a memory nothing of the voltage's swing is lost in it.
        weights: of.weights.map(|_| 0.0),
        ..of
    });
    let table = ringing.admit().unwrap();
    let reach = table.rings().expect("a light damping swings beyond the limits");
    let wide = Range { min: reach.min - 1.0, max: reach.max + 1.0 };
    let wide = Table { displacement_limits_um: wide, drive: None, ..ringing }.admit().unwrap();
    assert_eq!(wide.rings(), None);
    let found = worst(&wide, Optimiser::DifferentialEvolution, 1, |run| -run.displaced.min);
    assert!(!found.clamped && found.displaced.min >= reach.min.into());
    assert!(found.displaced.min < 0.8 * f64::from(reach.min), "{:?} of {reach:?}", found.displaced);
    // Within its own limits it is held there, and says so.
    let held = worst(&table, Optimiser::DifferentialEvolution, 1, |run| -run.displaced.min);
    assert!(held.clamped && held.displaced.min == f64::from(limits.min), "{:?} of {limits:?}", held.displaced);
}

/// A polynomial that its clamp bounds and whose two precisions part: y' = 1 + 0.1·v − `bend`·y², normalised, which
/// makes a difference up to 2·`bend` times as large.
fn bending(bend: f32) -> Table {
    let base = table(Model::Narx);
    let Parameters::Narx(of) = base.parameters else { panic!("the polynomial's") };
    let parameters = NarxParameters {
        output_order: 1,
        input_order: 1,
        degree: 2,
        with_voltage_extremum: false,
        with_displacement_extremum: false,
        displacement_centre_um: of.limits_um.middle(),
        displacement_scale_um: of.limits_um.span() / 2.0,
        // y, v, v², v·y, y², 1.
        coefficients: List::of([0.0, 0.1, 0.0, 0.0, -bend, 0.9]),
        ..of
    };
    Table { parameters: Parameters::Narx(parameters), ..base }
}

/// How far apart a sequence brings the two precisions of a table, admitted or not, of the limits' span.
fn parts(table: &Table, at: &[f64]) -> f64 {
    let (mut single, mut double) = (table.engine::<f32>(), table.engine::<f64>());
    let apart = codes(at, table.adc.full_scale).map(|code| {
        let voltage = table.voltage_range_v.clamp(table.adc.voltage::<f32>(code));
        (f64::from(single.step(voltage, None)) - double.step(voltage.into(), None)).abs()
    });
    apart.fold(0.0, f64::max) / f64::from(table.displacement_limits_um.span())
}

#[test]
fn a_polynomial_that_the_optimisers_part_the_precisions_of_is_refused() {
    let worst = |table: &Table| {
        let costs = each(|at: &[f64]| -parts(table, at));
        let budget = Budget { evaluations: EVALUATIONS, seed: 1 };
        let minimum =
            minimise(Optimiser::DifferentialEvolution, STRETCHES * GENES, budget, &[], &costs, &mut |_, _| {});
        parts(table, &minimum.at)
    };
    let (forgets, spreads) = (bending(0.45), bending(1.8));
    assert!(forgets.admit().is_ok(), "{:?}", forgets.admit().err());
    // What a tick rounds, of numbers up to 1 in limits of −1 … 1, adds up to ten times that.
    let (apart, added_up) = (worst(&forgets), f64::from(4.0 * f32::EPSILON) / (1.0 - 0.9));
    assert!(apart <= added_up, "{apart} of the limits apart, not {added_up}");
    let apart = worst(&spreads);
    assert!(apart > 0.1, "{apart} of the limits apart");
    let refused = spreads.admit().expect_err("its contraction is 3.6");
    assert!(matches!(refused, TableError::Inadmissible(Inadmissible::Spreads { by }) if by > 3.5), "{refused}");
}
