//! Why a run ended.

use crate::rcc::Reset;

/// Why a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The time is over.
    Time,
    /// The condition holds.
    Condition,
    /// The chip resets; [`Board::reboot`](crate::Board::reboot) goes on.
    Reset(Reset),
    /// Power went during the flash operation that [`Board::cut_power`](crate::Board::cut_power) chose.
    PowerCut,
    /// A fault in HardFault or NMI, or one that could not be stacked: the core stands still.
    Lockup,
}
