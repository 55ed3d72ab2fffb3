//! What a board hands up.

use crate::tick::Tick;
use core::ops::Range;
use protocol::ResetCause;

/// Ticks a second on every board.
pub const TICK_HZ: u32 = 2_000;

/// The converters' largest codes. A parameter table is made for one pair of them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Converters {
    /// Of the ADC, oversampling included.
    pub adc_full_scale: u16,
    /// Of the DAC.
    pub dac_full_scale: u16,
}

/// A board's peripherals, ready to be used; the tick is not running yet.
pub struct Peripherals<R, W, F, D: FnMut(), S: FnOnce(Tick<'static>)> {
    /// The board's name.
    pub board: &'static str,
    /// Its converters.
    pub converters: Converters,
    /// Counts of its cycle counter from tick to tick.
    pub cycles_per_tick: u32,
    /// The serial line, inbound.
    pub receiver: R,
    /// The serial line, outbound.
    pub transmitter: W,
    /// The flash that holds the parameter pages.
    pub flash: F,
    /// Where in it they are, bytes from its start.
    pub pages: Range<u32>,
    /// Why the board started.
    pub reset: ResetCause,
    /// Analogue supply, mV, where the board can measure it.
    pub supply_mv: Option<u16>,
    /// Whether the supply is within tolerance.
    pub supply_good: bool,
    /// Keeps the watchdog from resetting the board for another period.
    pub feed_watchdog: D,
    /// Starts the sampling timer; every tick from then on is the board's call of [`Tick::sample`].
    pub start: S,
    /// Uncorrectable flash words met so far.
    pub flash_errors: fn() -> u32,
    /// Errors of the serial line that its driver does not report by itself.
    pub line_errors: fn() -> u32,
    /// Starts the board again.
    pub restart: fn() -> !,
}
