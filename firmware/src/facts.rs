//! What a board says of itself.

use crate::restarts::Restarts;
use estimator_core::DacCode;
use estimator_core::table::Board;
use protocol::{ResetCause, Uid};

/// What is known of a board before its first tick, and how to ask it for the errors that only it can count.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// The board's name.
    pub name: &'static str,
    /// Which of these boards, where its chip says so.
    pub uid: Option<Uid>,
    /// Whether an emulator stands for the board. The demonstration's table is then as good as any, and the main loop is as late as
    /// the emulator's host.
    pub emulated: bool,
    /// Whether one of its converter's channels is for a set-point.
    pub has_setpoint: bool,
    /// Whether one of its pins is for a trigger, whose level it tells each tick that asks for it ([`crate::Tick::sync`]).
    pub has_trigger: bool,
    /// What the board asks of a table.
    pub interface: Board,
    /// Parts into which the board's DAC divides a code ([`crate::shaping`]); 1 where it takes whole ones.
    pub dac_parts: u16,
    /// Counts of the board's cycle counter from tick to tick.
    pub cycles_per_tick: u32,
    /// Why the board started.
    pub reset: ResetCause,
    /// What is known of the starts before ([`crate::restarts`]).
    pub restarts: Restarts,
    /// Called when their count begins anew.
    pub forget_restarts: fn(),
    /// Keeps the DAC's safe code for the starts after.
    pub keep_safe: fn(DacCode),
    /// Keeps for them that a displacement was told.
    pub keep_told: fn(),
    /// Analogue supply at boot, mV, where the board can measure it.
    pub supply_mv: Option<f32>,
    /// Measures it, mV, while the ticks go on: gives what the call before has begun, if that has ended, and begins anew.
    pub measure_supply: fn() -> Option<f32>,
    /// The level of the chip's brown-out reset, where it has one ([`protocol::Health::brown_out_level`]).
    pub brown_out_level: Option<u8>,
    /// Whether the ticks are as far apart as they should be: where the crystal did not start, nobody knows.
    pub clock_good: bool,
    /// Why the parameter store is neither read nor written, where the board cannot have one.
    pub no_store: Option<&'static str>,
    /// Whether so many mV are within tolerance.
    pub supply_good: fn(f32) -> bool,
    /// Uncorrectable flash words met so far.
    pub flash_errors: fn() -> u32,
    /// Errors of the serial line so far that its driver does not report by itself.
    pub line_errors: fn() -> u32,
}
