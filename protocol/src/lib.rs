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
//! [`Request::Refer`] and [`Request::SetZero`] do more on the second time.
#![cfg_attr(not(test), no_std)]

pub mod frame;
pub mod health;
pub mod identity;
pub mod message;
pub mod sample;

pub use frame::{Deframer, FrameError, encode};
pub use health::{Faults, Health, ResetCause};
pub use identity::{Identity, TableSource};
pub use message::{Codes, Mode, Record, References, Refusal, Reply, Request, ToDevice, ToHost};
pub use sample::{Sample, Samples};

/// Version of everything in this crate. It is the first byte of every frame; frames of another are refused by name.
pub const VERSION: u8 = 2;

/// The serial line's rate, bit/s, 8 data bits, no parity, one stop bit. The full stream takes about a quarter of it.
pub const BAUD: u32 = 921_600;

/// Text on the wire; longer text is cut.
pub type Text<const N: usize> = heapless::String<N>;

/// Writes as much of something as fits into a [`Text`], in whole characters.
pub fn text<const N: usize>(content: impl core::fmt::Display) -> Text<N> {
    struct Cut<const N: usize>(Text<N>);
    impl<const N: usize> core::fmt::Write for Cut<N> {
        fn write_str(&mut self, more: &str) -> core::fmt::Result {
            more.chars().try_for_each(|c| self.0.push(c).map_err(|_| core::fmt::Error))
        }
    }
    let mut cut = Cut(Text::new());
    // An error says that the text is full.
    let _ = core::fmt::write(&mut cut, format_args!("{content}"));
    cut.0
}
