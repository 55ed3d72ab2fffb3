//! What a board says of itself.

use crate::restarts::Restarts;
use estimator_core::table::Interface;
use protocol::{ResetCause, Uid};

/// What is known of a board before its first tick.
#[derive(Clone, Copy, Debug)]
pub struct Facts {
    /// The board's name.
    pub name: &'static str,
    /// Which of these boards, where its chip says so.
    pub uid: Option<Uid>,
    /// Whether an emulator stands for the board. The demonstration's table is then as good as any, and the main loop is
    /// as late as the emulator's host.
    pub emulated: bool,
    /// Whether one of its converter's channels is for a set-point.
    pub has_setpoint: bool,
    /// Whether one of its pins is for a trigger, whose level it tells each tick that asks
    /// for it ([`crate::Tick::sync`]).
    pub has_trigger: bool,
    /// What the board asks of a table.
    pub interface: Interface,
    /// Parts into which the board's DAC divides a code ([`crate::shaping`]); 1 where it takes whole ones.
    pub dac_parts: u16,
    /// Counts of the board's cycle counter from tick to tick.
    pub cycles_per_tick: u32,
    /// Why the board started.
    pub reset: ResetCause,
    /// What is known of the starts before ([`crate::restarts`]).
    pub restarts: Restarts,
    /// Analogue supply at boot, mV, where the board can measure it.
    pub supply_mv: Option<f32>,
    /// The level of the chip's brown-out reset, where it has one ([`protocol::Health::brown_out_level`]).
    pub brown_out_level: Option<u8>,
    /// Whether the ticks are as far apart as they should be: where the crystal did not start, nobody knows.
    pub clock_good: bool,
    /// Why the parameter store is neither read nor written, where the board cannot have one.
    pub no_store: Option<&'static str>,
}
