//! The models. Published parameters (units of the literature) and per-tick coefficients are separate types; so are
//! coefficients and state.

mod bouc_wen;
mod bouc_wen_branch;
mod champion;
mod champion_parameters;
mod champion_play;
mod dead_zone;
mod duhem;
mod duhem_conditions;
mod kind;
mod maxwell_slip;
mod narx;
mod parameters;
mod play;
mod prandtl_ishlinskii;
mod prandtl_ishlinskii_inverse;
mod preisach;
mod preisach_everett;
mod preisach_forc;
mod preisach_memory;
mod recursion;
mod resonance;
mod voigt;
mod voigt_chain;

pub use bouc_wen::{BoucWen, BoucWenParameters, BoucWenState};
pub use champion::Champion;
pub use champion_parameters::ChampionParameters;
pub use dead_zone::{DEAD_ZONES, Superposition};
pub use duhem::{Duhem, DuhemParameters, DuhemState};
pub use duhem_conditions::{DuhemCondition, unmet_condition};
pub use kind::Model;
pub use maxwell_slip::{ELEMENTS, MaxwellSlip, MaxwellSlipParameters, MaxwellSlipState};
pub use narx::{Narx, NarxParameters, NarxState};
pub use parameters::{Engine, Parameters, Running};
pub use play::{Stop, play, virgin};
pub use prandtl_ishlinskii::{PLAYS, PrandtlIshlinskii, PrandtlIshlinskiiParameters, PrandtlIshlinskiiState};
pub use prandtl_ishlinskii_inverse::{PrandtlIshlinskiiInverse, PrandtlIshlinskiiInverseState};
pub use preisach::{Preisach, PreisachParameters};
pub use preisach_everett::{CELLS, SIDE};
pub use preisach_forc::{densities_from_reversal_curves, everett_from_reversal};
pub use preisach_memory::{PreisachState, REVERSALS};
pub use recursion::{Linear, Recursion, solve};
pub use resonance::{Resonance, ResonanceState};
pub use voigt::{Scheme, State, Terms, Voigt, VoigtParameters};
pub use voigt_chain::{VoigtChain, VoigtChainParameters, VoigtChainState};
