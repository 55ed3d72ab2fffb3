//! What the host tool and the firmware say to each other over a serial line, and nothing else.
//!
//! ```text
//! host ── ToDevice { sequence, request } ─► device        one request at a time, answered in order
//! host ◄─ ToHost::Reply { to, reply } ────── device
//! host ◄─ ToHost::Samples(..) ────────────── device        unasked, while streaming is on
//! ```
//!
//! Every message travels in a frame of its own ([`frame`]): versioned, CRC-checked, delimited so that either side finds
//! its feet again after noise. Requests may be sent again when no reply comes: only [`Request::Feed`],
//! [`Request::SetZero`] and [`Request::ShiftBias`] do more on the second time.
#![cfg_attr(not(test), no_std)]

pub mod faults;
pub mod frame;
pub mod health;
pub mod identity;
pub mod message;
pub mod mode;
pub mod refusal;
pub mod sample;
pub mod text;
pub mod uid;

pub use faults::Faults;
pub use frame::{Deframer, FrameError, VERSION, encode};
pub use health::{Health, ResetCause};
pub use identity::{Identity, TableSource};
pub use message::{Codes, Record, References, Reply, Request, ToDevice, ToHost};
pub use mode::Mode;
pub use refusal::Refusal;
pub use sample::{Sample, Samples};
pub use text::{Text, text};
pub use uid::Uid;

/// The serial line's rate, bit/s, 8 data bits, no parity, one stop bit. The full stream takes less than half of it.
pub const BAUD: u32 = 921_600;
