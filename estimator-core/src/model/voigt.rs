//! The Voigt family: Voigt (Eq. 4.8), its voltage-extremum (5.4) and displacement-extremum (5.5) variants, and the
//! enhanced model (5.3) that has both terms.
//!
//! ```text
//! d(V)    = α·λ·x/(1 + x)²,  x = exp(−λ(V−β))                          µm/V
//! rate(V) = 1/(1e-6·d(V)·b) = (2 + x + 1/x)·1e6/(α·λ·b)                1/s
//! drive(V) = 1e6·sgn(V)·(|V|/b)^P                                      µm/s
//! ext     = g·sgn(V_ext)·|V_ext|^h + e_µm·sgn(y_ext)·|y_ext|^f         µm/s
//! dy/dt   = drive(V) − rate(V)·y + ext
//! ```
//!
//! A tick is one affine map, `y ← a(V)·y + c(V) + m(V)·ext`, with
//!
//! | scheme | a | m | c |
//! |---|---|---|---|
//! | forward Euler (the thesis's, Eq. 4.7) | 1 − t_s·rate | t_s | m·drive |
//! | zero-order hold (exact for a voltage that stays for the tick) | exp(−t_s·rate) | (1 − a)/rate | m·drive |
//!
//! `ext` changes only at a reversal. The two power terms of it are signed: with both positive (as Table 5.2 prints them)
//! the recursion cannot reproduce the thesis's own strokes. `V_ext` keeps its own sign (Eq. 5.3; Eq. 5.2 prints `sgn(V)`).

use crate::extremum::{Extremum, Tracker};
use crate::math::Real;
use serde::{Deserialize, Serialize};

/// How the differential equation becomes a recursion.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scheme {
    /// Forward Euler, Eq. (4.7).
    #[default]
    ForwardEuler,
    /// Exact for a voltage held over the tick; stable for any rate.
    ZeroOrderHold,
}

/// A published parameter set, in the units of Tables 4.6 and 5.2. Terms that a model lacks are 0.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VoigtParameters<T = f32> {
    /// α, µm.
    pub alpha_um: T,
    /// β, V.
    pub beta_v: T,
    /// λ, 1/V.
    pub lambda_per_v: T,
    /// b, Ω.
    pub b_ohm: T,
    /// P, no unit.
    pub p: T,
    /// g, µm/s per V^h; signed.
    pub g_um_per_s: T,
    /// h, no unit.
    pub h: T,
    /// e, m/s per m^f as printed; signed.
    pub e_m_per_s: T,
    /// f, no unit.
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

/// The affine map of one tick: `y ← a·y + c + m·ext`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Terms<T> {
    /// What remains of the displacement.
    pub a: T,
    /// What the voltage drives, µm.
    pub c: T,
    /// What a unit of the extremum term adds, s.
    pub m: T,
}

impl<T: Real> Terms<T> {
    /// The displacement (µm) a tick later.
    #[inline]
    pub fn apply(self, displacement: T, ext: T) -> T {
        self.a * displacement + (self.c + self.m * ext)
    }
}

/// Per-tick coefficients of the Voigt family, in the direct form (one `exp` and one power a tick).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Voigt<T> {
    scheme: Scheme,
    sample_period: T,
    rate_scale: T,
    lambda: T,
    lambda_beta: T,
    p: T,
    ln_drive_scale: T,
    g: T,
    h: T,
    e_um: T,
    f: T,
}

/// Displacement and reversal memory of a running recursion.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct State<T> {
    /// Displacement now, µm.
    pub displacement: T,
    tracker: Tracker<T>,
    ext: T,
}

impl<T: Real> State<T> {
    /// Starts at a known displacement (µm) with no reversal seen; `deadband` (V) is the tracker's.
    pub fn new(displacement: T, deadband: T) -> Self {
        Self { displacement, tracker: Tracker::new(deadband), ext: T::zero() }
    }

    /// The last reversal; zeros before the first.
    pub fn last_extremum(&self) -> Extremum<T> {
        self.tracker.last()
    }

    /// Takes this tick's voltage (V); `true` when it reveals a reversal.
    #[inline]
    pub fn track(&mut self, voltage: T) -> bool {
        self.tracker.update(voltage, self.displacement)
    }

    /// Goes on to the next tick; returns its displacement (µm).
    #[inline]
    pub fn apply(&mut self, terms: Terms<T>) -> T {
        self.displacement = terms.apply(self.displacement, self.ext);
        self.displacement
    }
}

impl<T: Real> Voigt<T> {
    /// Coefficients for ticks of `sample_period` seconds. Checks nothing: see [`crate::admissible`].
    pub fn build(parameters: &VoigtParameters<T>, sample_period: T, scheme: Scheme) -> Self {
        let micro = T::of(1e6);
        let ln_micro = micro.ln();
        let p = parameters;
        Self {
            scheme,
            sample_period,
            rate_scale: micro / (p.alpha_um * p.lambda_per_v * p.b_ohm),
            lambda: p.lambda_per_v,
            lambda_beta: p.lambda_per_v * p.beta_v,
            p: p.p,
            ln_drive_scale: ln_micro - p.p * p.b_ohm.ln(),
            g: p.g_um_per_s,
            h: p.h,
            // e·(1e-6)^f m/s for a displacement of 1 µm is 1e6 times that in µm/s.
            e_um: p.e_m_per_s * (ln_micro * (T::one() - p.f)).exp(),
            f: p.f,
        }
    }

    /// How the differential equation became a recursion.
    pub fn scheme(&self) -> Scheme {
        self.scheme
    }

    /// 1/(d(V)·b), 1/s.
    pub fn rate(&self, voltage: T) -> T {
        let x = (self.lambda_beta - self.lambda * voltage).exp();
        self.rate_scale * (T::of(2.0) + x + T::one() / x)
    }

    /// The voltage at which `rate` is least, V (β).
    pub fn slowest_voltage(&self) -> T {
        self.lambda_beta / self.lambda
    }

    /// `sgn(V)·(|V|/b)^P`, µm/s.
    #[inline]
    pub fn drive(&self, voltage: T) -> T {
        if voltage == T::zero() {
            return T::zero();
        }
        let magnitude = (self.p * voltage.abs().ln() + self.ln_drive_scale).exp();
        if voltage < T::zero() { -magnitude } else { magnitude }
    }

    /// The affine map of a tick at this voltage (V).
    #[inline]
    pub fn terms(&self, voltage: T) -> Terms<T> {
        let rate = self.rate(voltage);
        let (a, m) = match self.scheme {
            Scheme::ForwardEuler => (T::one() - self.sample_period * rate, self.sample_period),
            Scheme::ZeroOrderHold => {
                let decay = -(-self.sample_period * rate).exp_m1();
                (T::one() - decay, decay / rate)
            }
        };
        Terms { a, c: m * self.drive(voltage), m }
    }

    /// `g·sgn(V_ext)·|V_ext|^h`, µm/s.
    pub fn voltage_term(&self, voltage: T) -> T {
        if self.g == T::zero() { T::zero() } else { self.g * voltage.signed_pow(self.h) }
    }

    /// `e_µm·sgn(y_ext)·|y_ext|^f`, µm/s.
    pub fn displacement_term(&self, displacement: T) -> T {
        if self.e_um == T::zero() { T::zero() } else { self.e_um * displacement.signed_pow(self.f) }
    }

    /// Both extremum terms, µm/s.
    pub fn extremum_input(&self, extremum: Extremum<T>) -> T {
        self.voltage_term(extremum.voltage) + self.displacement_term(extremum.displacement)
    }

    /// One tick of the direct form: takes this tick's voltage (V), returns the displacement (µm) a tick later.
    pub fn step(&self, state: &mut State<T>, voltage: T) -> T {
        let terms = self.terms(voltage);
        self.step_with(state, voltage, terms)
    }

    /// One tick with the affine map given, as the tabulated form and the identification have it.
    #[inline]
    pub fn step_with(&self, state: &mut State<T>, voltage: T, terms: Terms<T>) -> T {
        if state.track(voltage) {
            self.turn(state);
        }
        state.apply(terms)
    }

    /// Takes the reversal that [`State::track`] has found into account.
    pub fn turn(&self, state: &mut State<T>) {
        state.ext = self.extremum_input(state.tracker.last());
    }
}
