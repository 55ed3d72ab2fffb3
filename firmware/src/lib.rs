//! The estimator on a microcontroller: everything but the peripherals.
//!
//! ```text
//!            highest priority                       async, may be late
//! timer ─► ADC ─► interrupt ─► Tick ─► DAC          Link ◄─► serial line
//!                    samples ─────┼──► queue ─────►  │
//!        commands, references ◄───┼─── queues ◄───── ├──► ParameterStore ◄─► flash
//!                    Telemetry ◄──┘    atomics ────►  └──► watchdog
//! ```
//!
//! A board (`src/board/`) brings up its peripherals, hands them to [`run()`], and calls [`Tick::sample`] from the
//! interrupt of its converter. It knows no logic; nothing here knows a register but two of the core's, which a hard
//! fault leaves ([`last_words`]). The tick shares nothing with the rest
//! but single-producer single-consumer queues and atomics: it takes no lock and waits for nobody.
#![cfg_attr(not(test), no_std)]

pub mod amplifier_check;
pub mod boot;
pub mod chip;
pub mod compiled;
pub mod conversion;
pub mod correction;
pub mod decimation;
pub mod drive;
pub mod ends;
pub mod facts;
pub mod last_words;
pub mod leap;
pub mod link;
pub mod marked_reads;
pub mod panel;
pub mod peripherals;
pub mod queues;
pub mod ramp;
pub mod rate;
pub mod restarts;
pub mod run;
pub mod setpoint;
pub mod shaping;
pub mod startup;
pub mod supply;
/// The parameter table of the image, made by `piezo emit --face rust`.
#[rustfmt::skip]
pub mod table;
pub mod telemetry;
pub mod tick;
pub mod watch;
pub mod waveform;

pub use chip::Chip;
pub use conversion::Conversion;
pub use facts::Facts;
pub use peripherals::Peripherals;
pub use run::{Resources, run};
pub use telemetry::Telemetry;
pub use tick::Tick;
