//! What a board's chip does for the main loop, and counts.

/// The parts of a chip that differ from board to board and are asked while the firmware runs; by the main loop, never
/// by the tick. A board without a part leaves its method as it is.
pub trait Chip {
    /// Keeps the watchdog from resetting the board for another period.
    fn feed_watchdog(&self) {}

    /// The analogue supply, mV, measured while the ticks go on: gives what the call before has begun, if that has
    /// ended, and begins anew.
    fn measure_supply(&self) -> Option<f32> {
        None
    }

    /// Uncorrectable flash words met so far.
    fn flash_errors(&self) -> u32 {
        0
    }

    /// Errors of the serial line so far that its driver does not report by itself.
    fn line_errors(&self) -> u32 {
        0
    }
}
