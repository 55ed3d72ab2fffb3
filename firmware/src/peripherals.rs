//! What a board hands to the firmware.

use crate::facts::Facts;
use crate::restarts::Memory;
use core::ops::Range;
use protocol::LastWords;

/// A board's peripherals, ready to be used; the tick is not running yet.
pub struct Peripherals<'m, C, R, W, F, P, S> {
    /// What the board says of itself.
    pub facts: Facts,
    /// What its chip does for the main loop, and counts ([`Chip`](crate::Chip)).
    pub chip: C,
    /// What this start leaves the next ones, where it has counted itself ([`Facts::restarts`]).
    pub memory: Memory<'m>,
    /// What the last run said before it ended in a panic or a fault.
    pub last_words: Option<LastWords>,
    /// The serial line, inbound.
    pub receiver: R,
    /// The serial line, outbound.
    pub transmitter: W,
    /// The flash that holds the parameter pages.
    pub flash: F,
    /// Where in the flash they are, bytes from its start.
    pub pages: Range<u32>,
    /// The button and the lamp, if there are any.
    pub front: P,
    /// Called once with the tick to start the sampling timer; from then on the board calls
    /// [`Tick::sample`](crate::Tick::sample) at every conversion.
    pub start: S,
}
