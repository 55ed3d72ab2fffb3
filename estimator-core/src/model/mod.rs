//! The models. Published parameters (units of the literature) and per-tick coefficients are separate types; so are
//! coefficients and state.

mod voigt;

pub use voigt::{Model, Scheme, State, Terms, Voigt, VoigtParameters};
