//! Designs a drive: the voltages that a session beside a sensor plays, so that a model can be learnt from it.
//!
//! ```text
//! rest, first branch, major loops     what no earlier swing has marked, then the whole range
//! shrinking loops                     every amplitude class, from the whole range down to a tenth
//! reversals                           first-order reversal curves: from the top down to ever lower turns, and back
//! three frequencies                   lowest and middle as sines, highest as a triangle, each at three amplitudes
//! staircase                           a step that is held, then back and forth in smaller ones: creep
//! random                              tones of random phases, swelling and fading; held out
//! ```
//!
//! Every segment starts and ends at rest. Every one but the first begins with a swing over the whole range, which wipes
//! out what the one before has left in the hysteresis: it can be learnt from by itself. Every sample lies within the
//! range, and no two of them are further apart than the slew limit lets them; where that forbids an amplitude,
//! [`Drive::forbidden`] says so.

mod design;
mod hertz;
mod path;
mod random;
mod request;

#[cfg(test)]
mod tests;

pub use design::Drive;
pub use hertz::hertz;
pub use request::{ExcitationError, Request};

/// A part of a drive, from rest to rest.
#[derive(Clone, PartialEq, Debug)]
pub struct Segment {
    /// Its name, fit for a file's.
    pub name: &'static str,
    /// What it is for, as the end of a sentence.
    pub what: &'static str,
    /// It is not to be learnt from, but to prove with.
    pub held_out: bool,
    /// Ticks from its beginning until the swing that wipes out what was before is over, and it has rested; 0 where
    /// there is none.
    pub lead_in: usize,
    /// Amplifier voltages, V, one a tick.
    pub volts: Vec<f32>,
}

/// An amplitude that a drive swings with at a frequency.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Swing {
    /// Its frequency, Hz.
    pub hertz: f64,
    /// From the lowest to the highest voltage, V.
    pub span_v: f64,
    /// What the same swing would be if nothing forbade it, V.
    pub wanted_v: f64,
    /// The slew rate that this would need, V/s.
    pub needs_v_per_s: f64,
}

impl Swing {
    /// Whether the slew limit made it smaller than wanted.
    pub fn reduced(&self) -> bool {
        self.span_v < 0.999 * self.wanted_v
    }
}
