//! The models. Published parameters (units of the literature) and per-tick coefficients are separate types; so are
//! coefficients and state. [`catalogue`] lists them all.

pub mod catalogue;

mod bouc_wen;
mod duhem;
mod generalised_prandtl_ishlinskii;
mod held;
mod lagged;
mod look_ahead;
mod maxwell_slip;
mod narx;
mod play;
mod prandtl_ishlinskii;
mod preisach;
mod process;
mod published;
mod recursion;
mod relaxation;
mod remanence;
mod resonance;
mod voigt;
mod voigt_chain;
mod voigt_family;

pub use bouc_wen::{BoucWen, BoucWenParameters, BoucWenState};
pub use catalogue::{Engine, Model, Parameters};
pub use duhem::{Duhem, DuhemCondition, DuhemParameters, DuhemState, unmet_condition};
pub use generalised_prandtl_ishlinskii::{GeneralisedPrandtlIshlinskii, GeneralisedPrandtlIshlinskiiParameters};
pub use held::Held;
pub use lagged::{Lagged, LaggedState};
pub use look_ahead::LookAhead;
pub use maxwell_slip::{ELEMENTS, MaxwellSlip, MaxwellSlipParameters, MaxwellSlipState};
pub use narx::{Narx, NarxParameters, NarxState};
pub use play::{Stop, play};
pub use prandtl_ishlinskii::{
    DEAD_ZONES, PLAYS, PrandtlIshlinskii, PrandtlIshlinskiiParameters, PrandtlIshlinskiiState, Superposition,
};
pub use preisach::{
    CELLS, Preisach, PreisachParameters, PreisachState, REVERSALS, SIDE, densities_from_reversal_curves,
};
pub use process::{Process, Running};
pub use published::{Discretisation, Published, Scheme};
pub use recursion::{Linear, Recursion, solve};
pub use relaxation::{Lag, RampLag, RampLagged, Relaxation, Relaxed};
pub use remanence::Remanence;
pub use resonance::{Resonance, ResonanceState};
pub use voigt::{LEAST_DECAY, Voigt, VoigtParameters, VoigtPoint, VoigtState, VoigtTerms};
pub use voigt_chain::{VoigtChain, VoigtChainParameters, VoigtChainState};
