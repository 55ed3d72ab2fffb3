//! The one list of models. A line makes a model a choice of the table, of the tools and of the firmware.
//!
//! To add one: a file with its parameters ([`Published`]) and its recursion, the parameters' `pub use` in `model` and
//! at the root of this crate, where tables written as Rust find them, and a line at the end of this file. No other
//! source of this crate lists them; an identification needs a family, besides. The example `own_model` of the crate
//! `identification` has every step.

use super::published::{Discretisation, Published};
use super::remanence::Remanence;
use super::{Process, Recursion, Running};
use crate::admissible::Inadmissible;
use crate::math::Real;
use crate::range::Range;
use crate::rule::Rule;
use core::fmt;
use serde::{Deserialize, Serialize};

type Coefficients<P, T> = <P as Published>::Coefficients<T>;
type RunningOf<P, T> = Running<Coefficients<P, T>, <Coefficients<P, T> as Recursion<T>>::State>;

macro_rules! models {
    ($($(#[doc = $line:literal])+ $model:ident, $name:literal, $label:literal, $parameters:ident, $cycles:expr;)*) => {
        /// Which model a table has.
        #[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
        pub enum Model {
            $($(#[doc = $line])+ #[serde(rename = $name)] $model,)*
        }

        impl Model {
            /// All, simplest first within the Voigt family, then in the order of the thesis.
            pub const ALL: [Self; [$($name),*].len()] = [$(Self::$model),*];

            /// Its name on a command line and in a table, such as `bouc-wen`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$model => $name,)* }
            }

            /// What it is, in a sentence.
            pub const fn description(self) -> &'static str {
                match self { $(Self::$model => concat!($($line),+).trim_ascii(),)* }
            }

            /// Whether a table may say how an actuator rests: [`Recursion::REMEMBERS`].
            pub const fn remembers(self) -> bool {
                match self { $(Self::$model => <Coefficients<crate::$parameters, f32> as Recursion<f32>>::REMEMBERS,)* }
            }

            /// Most cycles of its tick on the board, to estimate and to drive; [`Parameters::most_cycles`] tells a
            /// model's parameters apart.
            pub(crate) const fn most_cycles(self) -> (u32, u32) {
                match self { $(Self::$model => $cycles,)* }
            }
        }

        /// As it is written in tables and sentences, such as "Voigt (4.8)".
        impl fmt::Display for Model {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.pad(match self { $(Self::$model => $label,)* })
            }
        }

        /// The published parameters of a model, and with them which one it is.
        #[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
        #[expect(clippy::large_enum_variant, reason = "a device has one table, of any model, and no heap")]
        pub enum Parameters {
            $($(#[doc = $line])+ #[serde(rename = $name)] $model(crate::$parameters),)*
        }

        /// As a Rust expression.
        impl fmt::Debug for Parameters {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    $(Self::$model(of) => {
                        f.debug_tuple(concat!("Parameters::", stringify!($model))).field(of).finish()
                    })*
                }
            }
        }

        impl Parameters {
            /// The model that they parametrise; the Voigt family's four share a type, and the variant tells them apart.
            pub const fn model(&self) -> Model {
                match self { $(Self::$model(_) => Model::$model,)* }
            }

            /// The name of their type, for who writes them as Rust.
            pub const fn type_name(&self) -> &'static str {
                match self { $(Self::$model(_) => stringify!($parameters),)* }
            }

            /// As [`Published::check`], whichever of the models that share their type they are of.
            pub(super) fn check_numbers(&self) -> Result<(), Rule> {
                match self { $(Self::$model(of) => of.check(),)* }
            }

            /// Does what [`Published::between_codes`] says.
            pub(crate) fn between_codes(self, step: f32) -> Self {
                match self { $(Self::$model(of) => Self::$model(of.between_codes(step)),)* }
            }

            /// Ticks (with fraction, of either sign) by which the displacement comes later than the monotone part has
            /// it: [`Published::delay_ticks`].
            pub fn delay_ticks(&self) -> f32 {
                match self { $(Self::$model(of) => of.delay_ticks(),)* }
            }

            /// Time constant of its lag, s: [`Published::lag_s`].
            pub fn lag_s(&self) -> f32 {
                match self { $(Self::$model(of) => of.lag_s(),)* }
            }

            /// Does what [`Published::with_lag`] says.
            #[must_use]
            pub fn with_lag(self, lag_s: f32) -> Self {
                match self { $(Self::$model(of) => Self::$model(of.with_lag(lag_s)),)* }
            }

            /// The model ready to run.
            pub fn build<T: Real>(&self, discretisation: &Discretisation<T>) -> Engine<T> {
                match self {
                    $(Self::$model(of) => Engine::$model(Running::new(of.build(discretisation))),)*
                }
            }
        }

        /// Any model, running: coefficients and memory.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Engine<T: Real> {
            $($(#[doc = $line])+ $model(RunningOf<crate::$parameters, T>),)*
        }

        impl<T: Real> Engine<T> {
            /// What the next [`step`](Process::step) would return.
            pub fn peek(&self, voltage: T) -> T {
                match self { $(Self::$model(model) => model.peek(voltage),)* }
            }

            /// As [`Recursion::of_held_voltage`], with nothing remembered.
            #[must_use]
            pub fn of_held_voltage(&self) -> Self {
                match self { $(Self::$model(model) => Self::$model(model.of_held_voltage()),)* }
            }

            /// As [`Recursion::monotone_part`], with nothing remembered.
            pub fn monotone_part(&self) -> Option<Self> {
                Some(match self { $(Self::$model(model) => Self::$model(model.monotone_part()?),)* })
            }

            /// With nothing remembered, of an actuator that rests so where nothing is known ([`Running::resting`]).
            #[must_use]
            pub fn resting(self, remanence: Remanence) -> Self {
                match self { $(Self::$model(model) => Self::$model(model.resting(remanence)),)* }
            }

            /// Forgets everything: the next tick is the first.
            pub fn forget(&mut self) {
                match self { $(Self::$model(model) => model.forget(),)* }
            }
        }

        impl<T: Real> Process<T> for Engine<T> {
            #[inline]
            fn step(&mut self, voltage: T, known: Option<T>) -> T {
                match self { $(Self::$model(model) => model.step(voltage, known),)* }
            }

            fn bound(&self, voltage: Range<T>, limits: Range<T>) -> Result<Range<T>, Inadmissible<T>> {
                match self { $(Self::$model(model) => model.bound(voltage, limits),)* }
            }

            fn set_displacement(&mut self, displacement: T) -> bool {
                match self { $(Self::$model(model) => model.set_displacement(displacement),)* }
            }
        }
    };
}

// Of each: what it is, the name, the label, the parameters; and the most cycles of a tick on the board, to estimate and
// to drive, of which `table/cycles.rs` says more. A model without an inverse has the first twice.
models! {
    /// Eq. (4.8): five parameters, no extremum term.
    Voigt, "voigt", "Voigt (4.8)", VoigtParameters, (10_200, 19_800);
    /// Eq. (5.4): the voltage-extremum term `g, h`.
    VoltageExtremum, "voltage-extremum", "voltage-extremum (5.4)", VoigtParameters, (10_200, 36_400);
    /// Eq. (5.5): the displacement-extremum term `e, f`.
    DisplacementExtremum, "displacement-extremum", "displacement-extremum (5.5)", VoigtParameters, (10_200, 20_900);
    /// Eq. (5.3): both extremum terms.
    Enhanced, "enhanced", "enhanced (5.3)", VoigtParameters, (10_200, 41_500);
    /// Kelvin–Voigt elements in series, Eq. (3.20).
    VoigtChain, "voigt-chain", "Voigt chain (3.20)", VoigtChainParameters, (11_700, 40_600);
    /// Play operators and a superposition of dead zones, Eq. (3.6–3.9).
    PrandtlIshlinskii, "prandtl-ishlinskii", "Prandtl–Ishlinskii (3.9)", PrandtlIshlinskiiParameters, (11_200, 30_600);
    /// Elasto-slide elements in parallel, Eq. (3.10).
    MaxwellSlip, "maxwell-slip", "Maxwell-slip (3.10)", MaxwellSlipParameters, (12_200, 17_500);
    /// Coleman and Hodgdon's form of Eq. (3.11).
    Duhem, "duhem", "Duhem (3.11)", DuhemParameters, (10_200, 16_900);
    /// Of the Duhem family: Bouc–Wen with asymmetry.
    BoucWen, "bouc-wen", "Bouc–Wen", BoucWenParameters, (9_600, 21_700);
    /// Relays with a density on a grid, Eq. (3.1–3.5).
    Preisach, "preisach", "Preisach (3.1)", PreisachParameters, (20_400, 30_300);
    /// Black box of Table 5.1: a polynomial of past voltages and displacements, and of extrema.
    Narx, "narx", "NARX (Table 5.1)", NarxParameters, (36_900, 36_900);
    /// Fifteen play operators behind envelopes in a chain with delay, lag, creep and resonance.
    GeneralisedPrandtlIshlinskii, "generalised-prandtl-ishlinskii", "generalised Prandtl–Ishlinskii",
        GeneralisedPrandtlIshlinskiiParameters, (19_800, 50_900);
}
