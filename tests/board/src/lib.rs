//! The NUCLEO-G474RE without the board: the unmodified firmware image on an emulated Cortex-M4F, among models of the
//! STM32G474's registers as ST's reference manual RM0440 describes them.
//!
//! [`Board`] is the board, [`Image`] the firmware, [`Record`] what happened. Each peripheral is a file of its own that
//! says what its model leaves out. Two rules hold for all: a register without a model is plain memory, and
//! [`Record::plain`] lists it (of the core's own registers, the others are refused); a use that the model cannot follow
//! ends the run with an error, never with a guess.
//!
//! Time is counted in core clocks of 1 / 170 MHz. An executed instruction takes one clock, or as many as a test wants
//! ([`Board::slow`]), entering an exception 12, returning 10, going from one to the next 6; a sleeping core and one
//! that polls the flash skip to the next event. Events happen at their exact clock and interrupts are taken before the
//! next instruction, so that two runs are equal to the bit. What this proves is the firmware's logic. It proves
//! nothing about cycles, bus waits, caches, analogue behaviour or errata, and has no MPU, no debugger and no memory at
//! address 0. What a handler would cost is counted from its instructions, by a model of the core and of the flash,
//! where a test asks for it ([`Board::measure`]).

mod adc;
mod bases;
mod board;
mod bus;
mod clock;
mod contents;
mod cpu;
mod cycles;
mod dac;
#[cfg(test)]
mod described;
mod dma;
mod exceptions;
mod execution;
mod flash;
mod gpio;
mod hooks;
mod image;
mod layout;
mod machine;
mod measure;
mod memory;
mod nvic;
mod pin;
#[cfg(test)]
mod programs;
mod ram;
mod rcc;
mod record;
mod stop;
mod timer;
mod uart;
mod watchdog;

pub use board::Board;
pub use contents::{Contents, Tear};
pub use cycles::{Level, Measured};
pub use image::Image;
pub use nvic::exception;
pub use pin::{Pin, Port};
pub use rcc::Reset;
pub use record::{Conversion, Edge, Fault, FlashKind, FlashOperation, Latch, Record, Service};
pub use stop::Stop;

/// Core clocks a second; the image's clock tree must make just these.
pub const CORE_HZ: u32 = 170_000_000;

/// No event to come.
const NEVER: u64 = u64::MAX;

/// The core clocks in so many microseconds.
const fn microseconds(us: u64) -> u64 {
    us * (CORE_HZ / 1_000_000) as u64
}

/// A repeatable sequence (xorshift64*), for the content of memory that nobody has written.
struct Garbage(u64);

impl Garbage {
    fn new(seed: u64) -> Self {
        Self(seed | 1 << 63)
    }

    fn word(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }
}
