//! A model of your own: written, identified, judged, and what then makes it a choice of `piezo`.
//!
//!     cargo run --release --package identification --example own_model
//!
//! The model here is a straight line behind a first-order lag, `τ·du/dt = V − u`, `y = offset + gain·u`. It
//! has no hysteresis, and its errors say so. Nothing in this file needs a change of any library: a search
//! takes any [`Family`].
//!
//! To make it a choice of the tables, of `piezo` and of the firmware:
//!
//! 1. Part 1 becomes `estimator-core/src/model/toy.rs`, all of it `pub` and documented, with `crate::` for
//!    `estimator_core::` and without `Running`, which Part 2 needs. `mod toy;` and `pub use toy::{Toy, ToyParameters};`
//!    in `model/mod.rs`; `ToyParameters` in the `pub use model::{…}` of `lib.rs`, too. A state of your own derives
//!    `Clone, PartialEq, Debug` and is handed on with them.
//! 2. At the end of `estimator-core/src/model/catalogue.rs`, the sentence of `--help` and the line of the model, last,
//!    since records number the models by their order. The two numbers are the most cycles that a tick takes on the
//!    board, to estimate and to drive, by which a board refuses a table; `table/cycles.rs` says what they are. Begin
//!    with too many: `cargo xtask cycles` fails, and says how many are observed and what to state.
//!
//!        /// Straight line behind a first-order lag.
//!        Toy, "toy", "straight line with lag", ToyParameters, (20_000, 50_000);
//!
//! 3. Part 2 becomes `host-tools/identification/src/family/toy.rs`, `pub`, with `crate::` for `identification::`,
//!    `super::{Family, Projection}`, and without `impl Trial`: [`Parameters`](estimator_core::Parameters) has it. `type
//!    Found = Parameters`, and `project` ends in `.then_some(Parameters::Toy(parameters))`. `mod toy;` and an arm of
//!    `of` in `family/mod.rs`, for which the compiler asks: `Model::Toy => vec![Box::new(toy::ToyFamily)]`. A family
//!    whose ranges follow from the logs (a play's half-width, say) takes the [`Problem`] in a `new`, as
//!    `family/duhem.rs` does. A lag is charged for in `burden`, as `family/duhem.rs` has it, since logs of one
//!    frequency can hardly tell it from a wider loop.
//!
//! `cargo run --release -- identify tests/data/picma-p885-1hz.csv --model toy --out out/toy` then runs, and so does
//! every other verb. What goes through all models wants the new one:
//!
//! 4. In `estimator-core/tests/library/`: a set of it in `common/models.rs` (the compiler asks; the tests of
//!    `identification` need it, too), its bits in `bits.rs` (the test prints the line), and what its `f32` is off by in
//!    `precision.rs`, whose list leaves out what it does not name. A model without an inverse is left out as `Narx` is,
//!    in `common/models.rs` and in `inverse.rs`; outside the core, in `measure_all` and `line.rs` of
//!    `tests/board/tests/image` and where `xtask/src/cycles.rs` counts its rows.
//! 5. Its identified table, `tests/data/table/models/toy.toml` (`README.md` in the folder above says how), which the
//!    tests in QEMU, of C and of the fuzzer's inputs and `cargo xtask size --models` run; the instructions of its tick
//!    in `CEILINGS` of `xtask/src/figures/ceiling.rs` (`cargo xtask figures` says how many). `cargo xtask figures
//!    models cycles tracking` writes its rows in the book; the column of words is yours. The inputs of
//!    `tests/data/fuzz` want it, too: `cargo run --package fuzzed --example seeds FOLDER` writes them.
//! 6. The record's format: bump `VERSION` in `estimator-core/src/record.rs` unless it was bumped since the last
//!    release, since older firmware cannot read the model. With it change the version and the CRC of `record_is_pinned`
//!    in `estimator-core/tests/library/table.rs`, the two `table.bin` in `tests/data/table` (`cargo run --release --
//!    emit FOLDER/table.toml --out FOLDER` writes them), and the line in CHANGELOG.md.
//! 7. What goes on without it and nobody asks: the book's and README's number of models; `FREE` in
//!    `cross_validation.rs` beside Part 2, of a model of many weights that no law ties to each other; `coarse` in
//!    `tests/board/tests/image/cycles/tables.rs`, of one with an offset; and `table/rate.rs` of the core, of one whose
//!    equations know no tick, which alone is brought to another tick without a search.

use estimator_core::admissible::within;
use estimator_core::model::{Lagged, LaggedState};
use estimator_core::{Discretisation, Inadmissible, Linear, Published, Range, Real, Recursion, Rule, Running, rule};
use identification::cost::{Cost, Feedback};
use identification::family::{Family, Projection};
use identification::search::Gene;
use identification::search::Optimiser;
use identification::{Conditions, Problem, StructureSearch, Trial};
use least_squares::Sign;
use recordings::prepare::Recipe;
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};
use recordings::session::Session;
use serde::{Deserialize, Serialize};

// Part 1: the model.

/// Published parameters: `f32`, in units that their names state.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ToyParameters {
    /// τ, s; 0 for no lag.
    lag_s: f32,
    /// Slope, µm/V; at least 0.
    gain_um_per_v: f32,
    /// Displacement at 0 V, µm.
    offset_um: f32,
}

/// Per-tick coefficients, in `f32` on the target and in `f64` as the reference.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Toy<T> {
    gain: T,
    offset: T,
}

impl Published for ToyParameters {
    /// A model without time in it stands behind a lag by this; one with dynamics of its own is itself the coefficients.
    type Coefficients<T: Real> = Lagged<T, Toy<T>>;

    fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Lagged<T, Toy<T>> {
        let model = Toy { gain: T::of(self.gain_um_per_v), offset: T::of(self.offset_um) };
        Lagged::build(self.lag_s, discretisation.sample_period, model)
    }

    fn lag_s(&self) -> f32 {
        self.lag_s
    }

    fn with_lag(self, lag_s: f32) -> Self {
        Self { lag_s, ..self }
    }

    fn check(&self) -> Result<(), Rule> {
        rule::check([
            ("lag_s must lie between 0 and 10", (0.0..=10.0).contains(&self.lag_s)),
            ("gain_um_per_v must be at least 0", self.gain_um_per_v >= 0.0 && self.gain_um_per_v.is_finite()),
            ("offset_um must be finite", self.offset_um.is_finite()),
        ])
    }
}

impl<T: Real> Recursion<T> for Toy<T> {
    /// The last voltage, V.
    type State = T;

    /// A known displacement that is not on the line cannot be remembered.
    fn begin(&self, voltage: T, _displacement: Option<T>) -> T {
        voltage
    }

    fn step(&self, state: &mut T, voltage: T) -> T {
        self.advance(state, voltage);
        self.offset + self.gain * *state
    }

    /// The ends of the range bound the displacement.
    fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
        within(Range::of_values([voltage.min, voltage.max].map(|v| self.offset + self.gain * v)), limits)
    }

    /// What the inverse inverts; parameters with which it falls anywhere are refused where an inverse is built. `None`
    /// for no inverse.
    fn monotone_part(&self) -> Option<Self> {
        Some(*self)
    }
}

/// Columns: the voltage, then 1; weights: `gain_um_per_v`, `offset_um`.
impl<T: Real> Linear<T> for Toy<T> {
    fn advance(&self, state: &mut T, voltage: T) {
        *state = voltage;
    }

    fn columns(&self, state: &T, mut each: impl FnMut(T)) {
        each(*state);
        each(T::one());
    }
}

// Part 2: how it is identified. The lag is searched; gain and offset follow by least squares.

/// How the search runs the model.
impl Trial for ToyParameters {
    type Model = Running<Lagged<f64, Toy<f64>>, LaggedState<f64, f64>>;

    fn model(&self, discretisation: &Discretisation<f64>) -> Self::Model {
        Running::new(self.build(discretisation))
    }
}

struct ToyFamily;

impl Family for ToyFamily {
    type Found = ToyParameters;

    fn genes(&self) -> Vec<Gene> {
        vec![Gene::logarithmic("lag", "time constant of the lag", "s", 1e-4, 0.1)]
    }

    fn project(&self, values: &[f64], problem: &Problem) -> Option<ToyParameters> {
        let base = ToyParameters { lag_s: *values.first()? as f32, gain_um_per_v: 0.0, offset_um: 0.0 };
        let projection = Projection {
            problem,
            model: &base.build(&problem.discretisation()),
            // Of each column but the last, the unknown that it belongs to; several columns may share one.
            unknowns: &[0],
            // Of each unknown; `Sign::Free` for any number.
            signs: &[Sign::NonNegative],
        };
        // Fitted to the sensor as it is; a model that is linear in a function of the displacement says which.
        let (found, offset) = projection.solve(|displacement| displacement)?;
        let parameters = ToyParameters { gain_um_per_v: *found.first()? as f32, offset_um: offset as f32, ..base };
        parameters.check().is_ok().then_some(parameters)
    }

    /// Gain and offset.
    fn solved(&self, _found: &ToyParameters) -> usize {
        2
    }
}

// Part 3: identified on the synthetic rig's logs, judged on the one that is held out.

fn sessions(held_out: bool) -> Vec<Session> {
    let excitations = EXCITATIONS.into_iter().filter(|excitation| (excitation.name == VALIDATION) == held_out);
    let session = |excitation| Recipe::at_tick(500).session(&Rig::default().log(excitation));
    excitations.map(|excitation| session(excitation).expect("the rig is five times as fast as the tick")).collect()
}

fn main() {
    let problem = Problem::new(sessions(false), sessions(true), Conditions::default());
    let cost = Cost::from(Feedback::Simulation);
    let search = StructureSearch { problem: &problem, cost, method: Optimiser::Local, evaluations: 200, seed: 1 };
    let found = search.run(&ToyFamily, &[], None);
    let parameters = found.parameters.expect("a straight line fits any log somehow");
    let held_out = problem.held_out(&parameters, cost).expect("one log was held out");
    println!("{parameters:?}, identified with {} evaluations", found.evaluations);
    let stroke = problem.stroke().span();
    println!(
        "mean absolute error: {:.3} µm on the training logs, {held_out:.3} µm on {VALIDATION}; the stroke is {stroke:.1} µm",
        found.cost
    );
    assert!(held_out < 0.1 * stroke, "even a straight line is nearer than a tenth of the stroke");
}

#[test]
fn the_example_runs() {
    main();
}
