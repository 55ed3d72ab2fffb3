//! The parameters of any model, and any model running: what the table holds and what the estimator has of it.

use super::{
    BoucWen, BoucWenParameters, Champion, ChampionParameters, Duhem, DuhemParameters, MaxwellSlip,
    MaxwellSlipParameters, Model, Narx, NarxParameters, PrandtlIshlinskii, PrandtlIshlinskiiParameters, Preisach,
    PreisachParameters, Recursion, Scheme, Voigt, VoigtChain, VoigtChainParameters, VoigtParameters,
};
use crate::math::Real;
use crate::range::Range;
use core::fmt;
use serde::{Deserialize, Serialize};

/// A model with its memory, once it has begun.
#[derive(Clone, PartialEq, Debug)]
pub struct Run<M, S> {
    model: M,
    state: Option<S>,
}

impl<M, S> Run<M, S> {
    fn step<T: Real>(&mut self, voltage: T, known: Option<T>) -> T
    where
        M: Recursion<T, State = S>,
    {
        let model = &self.model;
        model.step(self.state.get_or_insert_with(|| model.begin(voltage, known)), voltage)
    }

    fn peek<T: Real>(&self, voltage: T) -> T
    where
        M: Recursion<T, State = S>,
        S: Clone,
    {
        let mut state = self.state.clone().unwrap_or_else(|| self.model.begin(voltage, None));
        self.model.step(&mut state, voltage)
    }

    fn prompt<T: Real>(&self) -> Option<Self>
    where
        M: Recursion<T, State = S>,
    {
        Some(Self { model: self.model.prompt()?, state: None })
    }
}

/// A model's coefficients, and the memory of all but the Voigt family's, which is a [`State`](super::State).
#[derive(Clone, PartialEq, Debug)]
pub enum Engine<T: Real> {
    /// Affine in the displacement.
    Voigt(Voigt<T>),
    /// Any other.
    Other(Running<T>),
}

/// The models beyond the Voigt family, by name, parameters and coefficients.
macro_rules! models {
    ($($model:ident, $parameters:ident, $coefficients:ident;)*) => {
        /// The published parameters of a model; those of the Voigt family are one type.
        #[derive(Clone, Copy, PartialEq, Serialize, Deserialize)]
        #[serde(rename_all = "kebab-case")]
        pub enum Parameters {
            /// Of Eq. (4.8), (5.3), (5.4) or (5.5).
            Voigt(VoigtParameters),
            $(#[doc = concat!("Of [`", stringify!($coefficients), "`].")] $model($parameters),)*
        }

        /// As a Rust expression.
        impl fmt::Debug for Parameters {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self {
                    Self::Voigt(of) => f.debug_tuple("Parameters::Voigt").field(of).finish(),
                    $(Self::$model(of) => {
                        f.debug_tuple(concat!("Parameters::", stringify!($model))).field(of).finish()
                    })*
                }
            }
        }

        impl Parameters {
            /// Whether these are parameters of this model.
            pub fn are_of(&self, model: Model) -> bool {
                match self {
                    Self::Voigt(_) => model.is_voigt(),
                    $(Self::$model(_) => model == Model::$model,)*
                }
            }

            /// The rule that they break, if any; those of the Voigt family have theirs in the table's checks.
            pub fn fault(&self) -> Option<&'static str> {
                match self {
                    Self::Voigt(_) => None,
                    $(Self::$model(of) => of.fault(),)*
                }
            }

            /// The model made ready to run, with ticks of `sample_period` seconds. `scheme` is the Voigt family's.
            pub fn build<T: Real>(&self, sample_period: T, scheme: Scheme) -> Engine<T> {
                match self {
                    Self::Voigt(of) => Engine::Voigt(Voigt::build(&of.map(T::of), sample_period, scheme)),
                    $(Self::$model(of) => {
                        let model = $coefficients::build(of, sample_period);
                        Engine::Other(Running::$model(Run { model, state: None }))
                    })*
                }
            }
        }

        /// Any model beyond the Voigt family, running: coefficients and memory.
        #[derive(Clone, PartialEq, Debug)]
        pub enum Running<T: Real> {
            $(
                #[doc = concat!("[`", stringify!($coefficients), "`].")]
                $model(Run<$coefficients<T>, <$coefficients<T> as Recursion<T>>::State>),
            )*
        }

        impl<T: Real> Running<T> {
            /// One tick: takes this tick's voltage (V), returns the displacement (µm) a tick later. The first one begins
            /// long at rest at its voltage, with the displacement that is known there.
            pub fn step(&mut self, voltage: T, known: Option<T>) -> T {
                match self { $(Self::$model(run) => run.step(voltage, known),)* }
            }

            /// What [`step`](Self::step) would return.
            pub fn peek(&self, voltage: T) -> T {
                match self { $(Self::$model(run) => run.peek(voltage),)* }
            }

            /// As [`Recursion::reach`].
            pub fn reach(&self, voltage: Range<T>) -> Option<Range<T>> {
                match self { $(Self::$model(run) => run.model.reach(voltage),)* }
            }

            /// As [`Recursion::prompt`], with nothing remembered.
            pub fn prompt(&self) -> Option<Self> {
                Some(match self { $(Self::$model(run) => Self::$model(run.prompt()?),)* })
            }

            /// Forgets everything.
            pub fn forget(&mut self) {
                match self { $(Self::$model(run) => run.state = None,)* }
            }
        }
    };
}

models! {
    VoigtChain, VoigtChainParameters, VoigtChain;
    PrandtlIshlinskii, PrandtlIshlinskiiParameters, PrandtlIshlinskii;
    MaxwellSlip, MaxwellSlipParameters, MaxwellSlip;
    Duhem, DuhemParameters, Duhem;
    BoucWen, BoucWenParameters, BoucWen;
    Preisach, PreisachParameters, Preisach;
    Narx, NarxParameters, Narx;
    Champion, ChampionParameters, Champion;
}
