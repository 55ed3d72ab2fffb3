//! The inverse: the voltage that brings the actuator to a wanted displacement, a tick at a time ("reversibility" of
//! Table 3.1).
//!
//! The displacement a tick later rises with this tick's voltage in the monotone part of every model that has one
//! ([`Recursion::monotone_part`](crate::Recursion::monotone_part)), but for a jump at a reversal. So the voltage is
//! found on the model itself, by a bracketed secant (ITP) over what the limits allow, and one and the same code inverts
//! them all. It runs its own copy of the model, fed with the voltages that it gives: no measured voltage comes in, so
//! that the actuator cannot be made to swing by it.
//!
//! That part has neither delay nor resonance: the displacement comes later by the delay, which whoever knows the
//! reference ahead of time can make up for, and a reference that is fast for the resonance excites it. A lag is undone:
//! where the reference moves fast the voltage leads, as far as the limits let it.

use crate::calibration::DriveLimits;
use crate::math::Real;
use crate::model::{Engine, Process};
use crate::range::Range;
use crate::rule::Rule;

/// Why a table has no inverse.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum NoInverse {
    /// The model has no [`monotone_part`](crate::Recursion::monotone_part): NARX.
    #[error("this model has no inverse")]
    Model,
    /// The displacement at rest does not rise with the voltage all the way from the lower end of the range
    /// to the upper.
    #[error("the displacement does not rise with the voltage")]
    Falling,
    /// The limits break this rule.
    #[error("{0}")]
    Limits(Rule),
}

/// Of one tick: the voltage that is put out from the next one on, and what it does by the model.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Commanded<T> {
    /// Amplifier voltage from the next tick on, V.
    pub voltage: T,
    /// What the model without delay and resonance gives for it a tick later, µm relative to the model's zero.
    pub displacement: T,
    /// Whether that is what was wanted, to within [`REACHED`].
    pub reached: bool,
}

/// How near the reference counts as reached, as a fraction of the displacement limits' width.
pub const REACHED: f32 = 1e-4;

/// How near is near enough to stop searching, as a fraction of that.
const FINE: f32 = 1e-2;

/// Most steps of the search, so that a tick always ends, and in time. They halve what they search in at least as
/// often, but for one of them: to a 2048th of what the limits allow in a tick where the displacement jumps. Elsewhere
/// some six are enough.
const STEPS: usize = 12;

/// How far the search steps beyond the secant, towards the middle, as a part of the bracket's square (κ1 of ITP, with
/// κ2 = 2).
const BEYOND: f32 = 0.2;

/// Parts of the range at whose ends the displacement at rest must rise.
const PARTS: u8 = 32;

/// What an inverse must know of its model's table.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InverseContext<T> {
    /// Amplifier voltage that the model calls 0, V.
    pub voltage_zero: T,
    /// From one tick to the next, s, above 0: the slew rate times it is the most that a tick changes the voltage by.
    pub sample_period: T,
    /// Width of the displacement limits, µm.
    pub displacement_span: T,
}

/// The monotone part of a model with its memory, and the limits within which its voltage is searched each tick.
#[derive(Clone, Debug)]
pub struct Inverse<T: Real> {
    engine: Engine<T>,
    /// Relative to the model's zero, V, as are all voltages here.
    range: Range<T>,
    rest: T,
    /// Most change a tick, V.
    stride: T,
    near: T,
    voltage_zero: T,
    voltage: T,
}

impl<T: Real> Inverse<T> {
    /// The inverse of a model, at rest; [`Admitted::inverse`](crate::Admitted::inverse) knows what it needs. The limits
    /// are taken as they are: [`DriveLimits::check`] is the caller's.
    ///
    /// # Errors
    /// The model has no monotone part, or its displacement at rest does not rise with the voltage.
    pub fn build(engine: &Engine<T>, context: &InverseContext<T>, limits: &DriveLimits) -> Result<Self, NoInverse> {
        let engine = engine.monotone_part().ok_or(NoInverse::Model)?;
        let zero = context.voltage_zero;
        let range: Range<T> = limits.range_v.of();
        let range = Range { min: range.min - zero, max: range.max - zero };
        let rest = range.clamp(T::of(limits.rest_v) - zero);
        let mut inverse = Self {
            engine,
            range,
            rest,
            stride: T::of(limits.slew_v_per_s) * context.sample_period,
            near: T::of(REACHED) * context.displacement_span,
            voltage_zero: zero,
            voltage: rest,
        };
        let at = |part: u8| range.min + range.span() * T::of(f32::from(part) / f32::from(PARTS));
        let mut last = inverse.settle(range.min);
        let rises = (1..=PARTS).all(|part| {
            let here = inverse.settle(at(part));
            core::mem::replace(&mut last, here) < here
        });
        inverse.restart();
        if rises { Ok(inverse) } else { Err(NoInverse::Falling) }
    }

    /// Starts anew, long at rest at the rest voltage.
    pub fn restart(&mut self) {
        self.settle(self.rest);
    }

    /// At rest at a voltage; returns the displacement there.
    fn settle(&mut self, voltage: T) -> T {
        self.voltage = voltage;
        self.engine.forget();
        self.engine.step(voltage, None)
    }

    /// One tick: takes the displacement wanted a tick after the voltage stands (µm relative to the model's zero),
    /// returns the voltage. A reference that is no number changes nothing.
    pub fn tick(&mut self, reference: T) -> Commanded<T> {
        let here = self.peek(self.voltage) - reference;
        let fine = self.near * T::of(FINE);
        let voltage = if here < -fine {
            let most = self.allowed(self.range.max - self.voltage);
            self.voltage + self.distance(-here, most, |distance| reference - self.peek(self.voltage + distance))
        } else if here > fine {
            let most = self.allowed(self.voltage - self.range.min);
            self.voltage - self.distance(here, most, |distance| self.peek(self.voltage - distance) - reference)
        } else {
            self.voltage
        };
        let commanded = self.go(voltage);
        // No number is never reached.
        Commanded { reached: (commanded.displacement - reference).abs() <= self.near, ..commanded }
    }

    /// Distance from here (V, at most `most`) at which `at` crosses zero; `missing` is its value at 0, and it falls
    /// with the distance. `most` where it does not cross. The method ITP of Oliveira and Takahashi (ACM TOMS 47(1),
    /// 2021): a step goes to the secant's zero, a little beyond it, and no further from the middle than lets the
    /// bracket be halved in time.
    fn distance(&self, missing: T, most: T, at: impl Fn(T) -> T) -> T {
        let half = T::of(0.5);
        let fine = self.near * T::of(FINE);
        let (mut low, mut high) = ((T::zero(), missing), (most, at(most)));
        if high.1 >= -fine {
            return most;
        }
        let beyond = T::of(BEYOND) / most;
        let (mut distance, mut due) = (most, most);
        for _ in 0..STEPS {
            let width = high.0 - low.0;
            let middle = low.0 + width * half;
            let secant = low.0 + width * (low.1 / (low.1 - high.1));
            let (aside, short) = (middle - secant, beyond * width * width);
            // Also where the secant is no number.
            let away = if aside.abs() > short { aside.abs() - short } else { T::zero() };
            let most_away = due - width * half;
            let away = if away < most_away { away } else { most_away };
            distance = if aside > T::zero() { middle - away } else { middle + away };
            let left = at(distance);
            if left.abs() <= fine {
                break;
            }
            if left > T::zero() {
                low = (distance, left);
            } else {
                high = (distance, left);
            }
            due = due * half;
        }
        distance
    }

    /// One tick that takes the wanted voltage itself (V, the amplifier's), for whoever asks for no
    /// displacement: as near to it as the limits allow. It is reached where they allow all of it. A voltage
    /// that is not finite changes nothing.
    pub fn steer(&mut self, voltage: T) -> Commanded<T> {
        let wanted = if voltage.is_finite() { voltage - self.voltage_zero } else { self.voltage };
        let commanded = self.towards(wanted);
        Commanded { reached: voltage.is_finite() && self.voltage == wanted, ..commanded }
    }

    /// One tick towards the rest voltage, as fast as the limits allow.
    pub fn release(&mut self) -> Commanded<T> {
        self.towards(self.rest)
    }

    /// Whether the last voltage is the rest voltage.
    pub fn rests(&self) -> bool {
        self.voltage == self.rest
    }

    fn towards(&mut self, voltage: T) -> Commanded<T> {
        let near = Range { min: self.voltage - self.stride, max: self.voltage + self.stride };
        self.go(near.clamp(voltage))
    }

    /// The change (V) that the slew rate allows in a tick, up to an end of the range.
    fn allowed(&self, to_the_end: T) -> T {
        if to_the_end < self.stride { to_the_end } else { self.stride }
    }

    fn go(&mut self, voltage: T) -> Commanded<T> {
        self.voltage = self.range.clamp(voltage);
        let displacement = self.engine.step(self.voltage, None);
        Commanded { voltage: self.voltage + self.voltage_zero, displacement, reached: true }
    }

    /// What [`go`](Self::go) would give.
    fn peek(&self, voltage: T) -> T {
        self.engine.peek(voltage)
    }
}
