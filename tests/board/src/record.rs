//! What happened on the board, for tests to read. Clocks count from power-on and go on over resets.

use std::collections::{BTreeMap, BTreeSet};

use crate::pin::Pin;

/// Everything recorded since power-on.
#[derive(Default)]
pub struct Record {
    /// Every code that came to the DAC's pin: with each trigger, new or not, and with writes and switching on where it
    /// changed what the pin shows.
    pub outputs: Vec<Latch>,
    /// The injected sequences of ADC1, one a trigger.
    pub conversions: Vec<Conversion>,
    /// Triggers that came while an injected conversion was going on; ADC1 ignores them.
    pub lost_triggers: u32,
    /// By pin, every change of the level that the firmware drives it to.
    pub edges: BTreeMap<Pin, Vec<Edge>>,
    /// By exception number, every time a handler was entered.
    pub services: BTreeMap<u8, Vec<Service>>,
    /// Erases and programs begun, the one that power was cut in included.
    pub flash: Vec<FlashOperation>,
    /// Hard faults that were taken.
    pub faults: Vec<Fault>,
    /// Bytes that came while LPUART1's receiver was full.
    pub overruns: u32,
    /// Addresses of registers touched while their peripheral had no clock, which does nothing.
    pub unclocked: BTreeSet<u32>,
    /// Addresses of registers touched that no model has a rule for: plain memory.
    pub plain: BTreeSet<u32>,
}

/// A code at the pin of DAC1's channel 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Latch {
    /// When it was, in clocks.
    pub clock: u64,
    /// The 12-bit code.
    pub code: u16,
}

/// A change of a pin's level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// When it was, in clocks.
    pub clock: u64,
    /// The level from then on.
    pub high: bool,
}

/// An injected sequence of conversions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Conversion {
    /// The trigger's clock.
    pub trigger: u64,
    /// The clock at which the last code is there.
    pub end: u64,
    /// Whether the end of the sequence before was still flagged: the firmware had not come to it.
    pub late: bool,
}

/// One run of an exception handler.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Service {
    /// The clock at which the core left what it was doing.
    pub entry: u64,
    /// Instructions of the handler itself, without handlers nested in it; `None` before it has returned.
    pub instructions: Option<u64>,
}

/// What the flash was told to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlashKind {
    /// Erase the page at the address.
    Erase,
    /// Program the double word at the address.
    Program,
}

/// An erase or program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FlashOperation {
    /// When the operation began, clocks.
    pub clock: u64,
    /// Whether it erases or programs.
    pub kind: FlashKind,
    /// The first byte changed.
    pub address: u32,
}

/// A hard fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// When it was, in clocks.
    pub clock: u64,
    /// Address of the instruction.
    pub pc: u32,
    /// The bits that it sets in CFSR.
    pub status: u32,
    /// The address that could not be reached.
    pub address: Option<u32>,
}
