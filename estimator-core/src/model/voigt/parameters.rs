//! Published parameters of the Voigt family.

use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// A published parameter set, in the units of Tables 4.6 and 5.2. Terms that a model lacks are 0.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VoigtParameters<T = f32> {
    /// α, µm: scale of the compliance d(V) of Eq. (4.8); Table 4.6.
    pub alpha_um: T,
    /// β, V: voltage about which d(V) is steepest; Table 4.6.
    pub beta_v: T,
    /// λ, 1/V: how fast d(V) falls off about β; Table 4.6.
    pub lambda_per_v: T,
    /// b, Ω as the thesis prints it: the damper; Table 4.6.
    pub b_ohm: T,
    /// P, no unit, 0 to 8: exponent of the drive (|V|/b)^P; Table 4.6.
    pub p: T,
    /// g of Eq. (5.4), µm/s per V^h, signed: weight of the voltage-extremum term; Table 5.2.
    pub g_um_per_s: T,
    /// h of Eq. (5.4), no unit, 0 to 8: exponent of |V_ext|; Table 5.2.
    pub h: T,
    /// e of Eq. (5.5), m/s per m^f as printed, signed: weight of the displacement-extremum term; Table 5.2.
    pub e_m_per_s: T,
    /// f of Eq. (5.5), no unit, 0 to 8: exponent of |y_ext|; Table 5.2.
    pub f: T,
}

impl<T: Copy> VoigtParameters<T> {
    /// The same set in another number type.
    pub fn map<U>(self, number: impl Fn(T) -> U) -> VoigtParameters<U> {
        VoigtParameters {
            alpha_um: number(self.alpha_um),
            beta_v: number(self.beta_v),
            lambda_per_v: number(self.lambda_per_v),
            b_ohm: number(self.b_ohm),
            p: number(self.p),
            g_um_per_s: number(self.g_um_per_s),
            h: number(self.h),
            e_m_per_s: number(self.e_m_per_s),
            f: number(self.f),
        }
    }

    /// Every parameter with its field's name, in the order of Eq. (5.3).
    pub fn named(&self) -> [(&'static str, T); 9] {
        [
            ("alpha_um", self.alpha_um),
            ("beta_v", self.beta_v),
            ("lambda_per_v", self.lambda_per_v),
            ("b_ohm", self.b_ohm),
            ("p", self.p),
            ("g_um_per_s", self.g_um_per_s),
            ("h", self.h),
            ("e_m_per_s", self.e_m_per_s),
            ("f", self.f),
        ]
    }
}

/// Exponents beyond this are refused.
const LARGEST_EXPONENT: f32 = 8.0;

impl VoigtParameters {
    /// Does what [`Published::check`](crate::Published::check) says.
    pub(super) fn check_numbers(&self) -> Result<(), Rule> {
        let positive = |x: f32| x > 0.0 && x.is_finite();
        let exponent = |x: f32| (0.0..=LARGEST_EXPONENT).contains(&x);
        rule::check([
            ("alpha_um must be positive and finite", positive(self.alpha_um)),
            ("beta_v must be finite", self.beta_v.is_finite()),
            ("lambda_per_v must be positive and finite", positive(self.lambda_per_v)),
            ("b_ohm must be positive and finite", positive(self.b_ohm)),
            ("p must lie between 0 and 8", exponent(self.p)),
            ("g_um_per_s must be finite", self.g_um_per_s.is_finite()),
            ("h must lie between 0 and 8", exponent(self.h)),
            ("e_m_per_s must be finite", self.e_m_per_s.is_finite()),
            ("f must lie between 0 and 8", exponent(self.f)),
        ])
    }
}
