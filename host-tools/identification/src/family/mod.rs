//! The models beyond the Voigt family, identified by variable projection: a search varies the few numbers in
//! which a model is not linear, and for each candidate the weights follow by (non-negative) least squares (Golub
//! and Pereyra, 2003).

mod bouc_wen;
mod duhem;
mod generalised_prandtl_ishlinskii;
mod maxwell_slip;
mod model_family;
mod narx;
mod prandtl_ishlinskii;
mod preisach;
mod projection;
mod reversal_curves;
pub mod voigt;
mod voigt_chain;

pub(crate) use generalised_prandtl_ishlinskii::{LONGEST_DELAY, LONGEST_LAG, Late};
pub use model_family::{AnyFamily, Family};
pub use narx::{BlackBoxInputs, structures_with as black_boxes};
pub use projection::Projection;

use crate::problem::Problem;
use estimator_core::Model;

/// The structures of a model, simplest first, each with the genes of those before it among its own; none for the Voigt
/// family, whose parameters are all searched.
pub fn of(model: Model, problem: &Problem) -> Vec<AnyFamily> {
    match model {
        Model::Voigt | Model::VoltageExtremum | Model::DisplacementExtremum | Model::Enhanced => Vec::new(),
        Model::VoigtChain => voigt_chain::structures(problem),
        Model::PrandtlIshlinskii => vec![Box::new(prandtl_ishlinskii::Family::new(problem))],
        Model::MaxwellSlip => vec![Box::new(maxwell_slip::Family::new(problem))],
        Model::Duhem => vec![Box::new(duhem::Family::new(problem))],
        Model::BoucWen => vec![Box::new(bouc_wen::Family::new(problem))],
        Model::Preisach => preisach::structures(problem),
        Model::Narx => narx::structures(problem),
        Model::GeneralisedPrandtlIshlinskii => generalised_prandtl_ishlinskii::structures(problem),
    }
}
