//! The firmware on the host, behind a TCP socket: a device without a board.
//!
//! ```text
//! Plant ── codes ─► Tick ── DAC code ─► Plant        at the emulated rate
//! host ◄─► socket ◄─► Link ◄─► ParameterStore ◄─► flash
//! ```
//!
//! Tick, link, parameter store and all that they answer are the firmware's own library; what is emulated here is a
//! board: a clock, a serial line, a flash, and converters with something behind them ([`Plant`]). The emulated time
//! goes on at a multiple of real time, and more slowly where this machine is too busy, so that no tick is ever late.
//!
//! ```
//! # fn main() -> Result<(), emulator::EmulatorError> {
//! let device = emulator::Emulator::new().speed(4.0).start()?;
//! println!("piezo info --port tcp:{}", device.address());
//! device.shutdown();
//! # Ok(())
//! # }
//! ```
//!
//! A [`FaultyLine`] stands between a host and a device and loses, damages or changes what goes over it.

mod bench;
mod board;
mod emulator;
pub mod faults;
mod faulty_line;
mod file_flash;
mod plant;
mod readings;
mod serial_line;
pub mod signal;

pub use bench::{Bench, Meters};
pub use emulator::{EmulatedDevice, Emulator, EmulatorError, PAGES, UID, numbered};
pub use faulty_line::{Direction, Fault, FaultyLine};
pub use file_flash::{FileFlash, FileFlashError};
pub use firmware::Conversion;
/// The table of the firmware image, by which the device estimates where none is stored.
pub use firmware::compiled::TABLE;
/// From one tick of the device to the next, µs.
pub use firmware::rate::TICK_US;
pub use plant::{Plant, amplifier, triangle};
pub use readings::Readings;
