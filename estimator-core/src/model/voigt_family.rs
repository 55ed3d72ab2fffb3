//! What the four models of the Voigt family have in common, and which of them have which terms: they share one type of
//! parameters.

use super::catalogue::{Model, Parameters};
use super::voigt::VoigtParameters;
use crate::rule::{self, Rule};

impl Model {
    /// The Voigt family, simplest first.
    pub const VOIGT_FAMILY: [Self; 4] =
        [Self::Voigt, Self::VoltageExtremum, Self::DisplacementExtremum, Self::Enhanced];

    /// Whether it is one of the four with the parameters of Eq. (5.3).
    pub const fn is_voigt(self) -> bool {
        matches!(self, Self::Voigt | Self::VoltageExtremum | Self::DisplacementExtremum | Self::Enhanced)
    }

    /// Whether the model has the term `g·sgn(V_ext)·|V_ext|^h`.
    pub const fn has_voltage_term(self) -> bool {
        matches!(self, Self::VoltageExtremum | Self::Enhanced)
    }

    /// Whether the model has the term `e·sgn(y_ext)·|y_ext|^f`.
    pub const fn has_displacement_term(self) -> bool {
        matches!(self, Self::DisplacementExtremum | Self::Enhanced)
    }
}

impl Parameters {
    /// Checks every parameter by itself and beside the others ([`Published::check`](super::Published::check)); terms
    /// that a model lacks must be 0.
    ///
    /// # Errors
    /// The rule that they break.
    pub fn check(&self) -> Result<(), Rule> {
        self.check_numbers()?;
        let (Some(of), model) = (self.voigt(), self.model()) else { return Ok(()) };
        rule::check([
            (
                "g_um_per_s and h must be 0 in a model without the voltage-extremum term",
                model.has_voltage_term() || (of.g_um_per_s == 0.0 && of.h == 0.0),
            ),
            (
                "e_m_per_s and f must be 0 in a model without the displacement-extremum term",
                model.has_displacement_term() || (of.e_m_per_s == 0.0 && of.f == 0.0),
            ),
        ])
    }

    /// The parameters of a model of the Voigt family. Any other model is taken for the enhanced one, which
    /// has all terms.
    pub const fn of_voigt_family(model: Model, parameters: VoigtParameters) -> Self {
        match model {
            Model::Voigt => Self::Voigt(parameters),
            Model::VoltageExtremum => Self::VoltageExtremum(parameters),
            Model::DisplacementExtremum => Self::DisplacementExtremum(parameters),
            _ => Self::Enhanced(parameters),
        }
    }

    /// Those of a model of the Voigt family.
    pub const fn voigt(&self) -> Option<&VoigtParameters> {
        match self {
            Self::Voigt(of) | Self::VoltageExtremum(of) | Self::DisplacementExtremum(of) | Self::Enhanced(of) => {
                Some(of)
            }
            _ => None,
        }
    }
}
