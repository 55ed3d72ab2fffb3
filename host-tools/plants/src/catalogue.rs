//! The kinds of hysteresis, and a device of each.

use super::bouc_wen::BoucWen;
use super::draw::Draw;
use super::hysteresis::Hysteresis;
use super::jiles_atherton::JilesAtherton;
use super::rate_dependent::RateDependent;
use super::relays::{Density, Relays};

/// What a plant's hysteresis is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// Preisach's relays of a density.
    Relays(Density),
    /// Plays whose thresholds grow with the rate.
    RateDependent,
    /// Jiles and Atherton's equations.
    JilesAtherton,
    /// Bouc and Wen's equation with exponent 1, and a cubic.
    BoucWen,
    /// The same with exponent 2.
    BoucWenSharp,
}

/// Every kind of hysteresis that a plant can have.
pub const CATALOGUE: [Kind; 8] = [
    Kind::Relays(Density::Gaussian),
    Kind::Relays(Density::Lorentzian),
    Kind::Relays(Density::TwoHumped),
    Kind::Relays(Density::Gamma),
    Kind::RateDependent,
    Kind::JilesAtherton,
    Kind::BoucWen,
    Kind::BoucWenSharp,
];

impl Kind {
    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Relays(Density::Gaussian) => "relays, Gaussian",
            Self::Relays(Density::Lorentzian) => "relays, Lorentzian",
            Self::Relays(Density::TwoHumped) => "relays, two-humped",
            Self::Relays(Density::Gamma) => "relays, gamma",
            Self::RateDependent => "rate-dependent plays",
            Self::JilesAtherton => "Jiles–Atherton",
            Self::BoucWen => "Bouc–Wen, n = 1",
            Self::BoucWenSharp => "Bouc–Wen, n = 2",
        }
    }

    /// The operator of a device, virgin.
    pub(super) fn hysteresis(self, device: u64) -> Box<dyn Hysteresis> {
        let mut draw = Draw::new(device.wrapping_mul(2));
        match self {
            Self::Relays(density) => Box::new(Relays::new(density, &mut draw)),
            Self::RateDependent => Box::new(RateDependent::new(&mut draw)),
            Self::JilesAtherton => Box::new(JilesAtherton::new(&mut draw)),
            Self::BoucWen => Box::new(BoucWen::new(1.0, &mut draw)),
            Self::BoucWenSharp => Box::new(BoucWen::new(2.0, &mut draw)),
        }
    }
}
