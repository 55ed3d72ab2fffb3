//! Which model a table has.

use serde::{Deserialize, Serialize};

/// Which model.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Eq. (4.8): five parameters, no extremum term.
    Voigt,
    /// Eq. (5.4): the voltage-extremum term `g, h`.
    VoltageExtremum,
    /// Eq. (5.5): the displacement-extremum term `e, f`.
    DisplacementExtremum,
    /// Eq. (5.3): both.
    Enhanced,
    /// Eq. (3.20): Kelvin–Voigt elements in series.
    VoigtChain,
    /// Eq. (3.6–3.9): play operators and a superposition of dead zones.
    PrandtlIshlinskii,
    /// Eq. (3.10): elasto-slide elements in parallel.
    MaxwellSlip,
    /// Eq. (3.11) in Coleman and Hodgdon's form.
    Duhem,
    /// Of the Duhem family: Bouc–Wen with asymmetry.
    BoucWen,
    /// Eq. (3.1–3.5): relays with a density on a grid.
    Preisach,
    /// Black box of Table 5.1: a polynomial of past voltages and displacements, and of extrema.
    Narx,
    /// Lag, functions of play operators, creep: what the estimator is meant to run.
    Champion,
}

impl Model {
    /// All, simplest first within the Voigt family, then in the order of the thesis.
    pub const ALL: [Self; 12] = [
        Self::Voigt,
        Self::VoltageExtremum,
        Self::DisplacementExtremum,
        Self::Enhanced,
        Self::VoigtChain,
        Self::PrandtlIshlinskii,
        Self::MaxwellSlip,
        Self::Duhem,
        Self::BoucWen,
        Self::Preisach,
        Self::Narx,
        Self::Champion,
    ];

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

impl core::fmt::Display for Model {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.pad(match self {
            Self::Voigt => "Voigt (4.8)",
            Self::VoltageExtremum => "voltage-extremum (5.4)",
            Self::DisplacementExtremum => "displacement-extremum (5.5)",
            Self::Enhanced => "enhanced (5.3)",
            Self::VoigtChain => "Voigt chain (3.20)",
            Self::PrandtlIshlinskii => "Prandtl–Ishlinskii (3.9)",
            Self::MaxwellSlip => "Maxwell-slip (3.10)",
            Self::Duhem => "Duhem (3.11)",
            Self::BoucWen => "Bouc–Wen",
            Self::Preisach => "Preisach (3.1)",
            Self::Narx => "NARX (Table 5.1)",
            Self::Champion => "champion",
        })
    }
}
