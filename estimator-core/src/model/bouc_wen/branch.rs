//! Bouc-Wen hysteresis along one direction of the voltage: dh/dw = A − ψ·|h|^n, w the distance in that direction, ψ one
//! value before and another after h passes zero.
//!
//! For n = 1 the equation is linear before and after; a move takes the exact solution (one `expm1`; where h passes zero
//! one `ln` and two more `expm1`), so that the state after a monotone move does not depend on how it is cut into ticks.
//! For other n it takes Runge-Kutta steps of fourth order, to zero and from there, of a quarter of the relaxation
//! length `1/(n·ψ·|h|^(n−1))`. There are no more than 40 a move: a longer one takes longer steps, up to the whole
//! length, and what they do not cover is saturated. Cut differently, h differs by less than 0.2 % of its span.

use crate::math::Real;
use crate::range::Range;

/// |h|^n, without a power function where it needs none.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) enum Power<T> {
    /// n = 1.
    One,
    /// n = 2.
    Two,
    /// Any other n.
    General(T),
}

impl<T: Real> Power<T> {
    /// The power |h|^n of the equation.
    #[inline]
    fn of(self, h: T) -> T {
        match self {
            Self::One => h.abs(),
            Self::Two => h * h,
            Self::General(n) => h.abs().signed_pow(n),
        }
    }
}

/// One direction of the voltage. `h` and its move are counted in that direction, so that loading has `h ≥ 0`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Branch<T> {
    a: T,
    /// dh/du = a − loading·|h|^n for h ≥ 0 …
    loading: T,
    /// … and a − unloading·|h|^n for h < 0.
    unloading: T,
    inverse_unloading: T,
    unloading_per_a: T,
    inverse_a: T,
    /// Where loading ends, V.
    pub limit: T,
    /// Shortest relaxation lengths for h ≥ 0 and for h < 0 up to the knee, V.
    loading_length: T,
    unloading_length: T,
    /// |h| above which the unloading length shrinks as 1/(bend·|h|^(n−1)), V.
    unloading_knee: T,
    bend: T,
}

/// Most Runge-Kutta steps a move.
const SUBSTEPS: u8 = 40;

/// Above this exponent the zero crossing has long been passed; below it nothing overflows.
const LONGEST: f32 = 60.0;

impl<T: Real> Branch<T> {
    pub fn new(a: T, loading: T, unloading: T, n: T) -> Self {
        // A coefficient this small bends nothing over any voltage of an amplifier.
        let unloading = if unloading.abs() < T::of(1e-12) { T::zero() } else { unloading };
        let inverse = |value: T| if value == T::zero() { T::zero() } else { T::one() / value };
        Self {
            a,
            loading,
            unloading,
            inverse_unloading: inverse(unloading),
            unloading_per_a: unloading / a,
            inverse_a: inverse(a),
            limit: if n == T::one() { a / loading } else { (a / loading).signed_pow(T::one() / n) },
            loading_length: T::zero(),
            unloading_length: T::zero(),
            unloading_knee: T::zero(),
            bend: T::zero(),
        }
    }

    /// The relaxation lengths; `other_limit` is where the other direction's loading ends.
    pub fn measure(&mut self, n: T, other_limit: T) {
        let length = |coefficient: T, limit: T| T::one() / (n * coefficient * limit.signed_pow(n - T::one()));
        self.loading_length = length(self.loading, self.limit);
        // Below the knee the slope is that at zero.
        let knee = if self.unloading == T::zero() {
            other_limit
        } else {
            (self.a / self.unloading.abs()).signed_pow(T::one() / n)
        };
        self.unloading_knee = if knee < other_limit { knee } else { other_limit };
        let (straight, bent) = (other_limit * self.inverse_a, length(self.unloading.abs(), self.unloading_knee));
        self.unloading_length = if bent < straight { bent } else { straight };
        self.bend = n * self.unloading.abs();
    }

    /// h after a move by `distance` > 0.
    #[inline]
    pub fn travel(&self, h: T, distance: T, power: Power<T>) -> T {
        if power == Power::One { self.exact(h, distance) } else { self.approximate(h, distance, power) }
    }

    fn approximate(&self, mut h: T, distance: T, power: Power<T>) -> T {
        let mut rest = distance;
        for left in (1..=SUBSTEPS).rev() {
            let (length, longest) = if h >= T::zero() {
                (self.loading_length, self.loading_length)
            } else if -h <= self.unloading_knee {
                (self.unloading_length, self.unloading_length)
            } else {
                let length = -h / (self.bend * power.of(h));
                (length, length * T::of(0.5))
            };
            let shortest = length * T::of(0.25);
            let mut step = rest;
            if rest > shortest {
                step = Range { min: shortest, max: longest }.clamp(rest / T::of(f32::from(left)));
                if step > rest {
                    step = rest;
                }
            }
            let end = self.runge_kutta(h, step, power);
            if h < T::zero() && end > T::zero() {
                // To zero: by the secant, then with the slope that it has there.
                let part = step * (h / (h - end));
                let used = part - self.runge_kutta(h, part, power) * self.inverse_a;
                rest = rest - Range { min: T::zero(), max: rest }.clamp(used);
                h = T::zero();
            } else {
                rest = rest - step;
                h = if end > self.limit { self.limit } else { end };
            }
            if rest <= T::zero() {
                break;
            }
        }
        h
    }

    /// Exact solution for n = 1 after a move by `distance` > 0.
    #[inline]
    fn exact(&self, h: T, distance: T) -> T {
        if h >= T::zero() {
            return self.load(h, distance);
        }
        let stretched = if self.unloading == T::zero() {
            distance
        } else {
            let exponent = self.unloading * distance;
            let exponent = if exponent > T::of(LONGEST) { T::of(LONGEST) } else { exponent };
            exponent.exp_m1() * self.inverse_unloading
        };
        let end = h + (self.a + self.unloading * h) * stretched;
        if end < T::zero() {
            return end;
        }
        // The distance to the crossing is −ln(1 + t)/unloading with t = unloading·h/a. One Newton step on expm1 takes
        // away the logarithm's cancellation near 1 and, with micromath, its error.
        let t = self.unloading_per_a * h;
        let one_plus = T::one() + t;
        let to_zero = if self.unloading == T::zero() || one_plus <= T::zero() {
            -h * self.inverse_a
        } else {
            let ln = one_plus.ln();
            let error = ln.exp_m1() - t;
            (error / one_plus - ln) * self.inverse_unloading
        };
        if to_zero < distance { self.load(T::zero(), distance - to_zero) } else { T::zero() }
    }

    #[inline]
    fn load(&self, h: T, distance: T) -> T {
        h - (self.limit - h) * (-self.loading * distance).exp_m1()
    }

    /// dh/dw on one side of zero; a stage that looks past zero from below sees the slope at zero.
    fn slope(&self, h: T, loading: bool, power: Power<T>) -> T {
        if loading {
            self.a - self.loading * power.of(h)
        } else if h < T::zero() {
            self.a - self.unloading * power.of(h)
        } else {
            self.a
        }
    }

    /// One Runge-Kutta step by `distance`.
    fn runge_kutta(&self, h: T, distance: T, power: Power<T>) -> T {
        let half = distance * T::of(0.5);
        let loading = h >= T::zero();
        let k1 = self.slope(h, loading, power);
        let k2 = self.slope(h + k1 * half, loading, power);
        let k3 = self.slope(h + k2 * half, loading, power);
        let k4 = self.slope(h + k3 * distance, loading, power);
        h + (k1 + k4 + (k2 + k3) * T::of(2.0)) * distance * (T::one() / T::of(6.0))
    }
}
