//! How often a tick comes: the same on every board.

/// Ticks a second.
pub const TICK_HZ: u32 = 2_000;
/// From one tick to the next, µs.
pub const TICK_US: u32 = 1_000_000 / TICK_HZ;
