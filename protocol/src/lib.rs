//! What the host tool and the firmware say to each other over a serial line, and nothing else.
//!
//! ```text
//! host ── ToDevice { sequence, request } ─► device        one request at a time, answered in order
//! host ◄─ ToHost::Reply { to, reply } ────── device
//! host ◄─ ToHost::Samples(..) ────────────── device        unasked, while streaming is on
//! ```
//!
//! Every message travels in a frame of its own ([`frame`]): versioned, CRC-checked, delimited so that either side finds
//! its feet again after noise. A request goes out as bytes, and what comes in is taken byte by byte:
//!
//! ```
//! use protocol::{Deframer, Reply, Request, ToDevice, ToHost, encode, frame::MAX_FRAME};
//!
//! // The host asks.
//! let mut buffer = [0; MAX_FRAME];
//! let asked = ToDevice { sequence: 7, request: Request::Forget };
//! let line = encode(&asked, &mut buffer).expect("no request is longer than a frame");
//!
//! // The device hears, a damaged frame first.
//! let mut deframer = Deframer::new();
//! let heard: Vec<_> = [0x55, 0x00].iter().chain(line).filter_map(|&byte| deframer.push::<ToDevice>(byte)).collect();
//! assert!(heard[0].is_err());
//! assert_eq!(heard[1], Ok(asked));
//!
//! // And answers.
//! let reply = ToHost::Reply { to: 7, reply: Reply::Done };
//! assert_eq!(encode(&reply, &mut buffer).and_then(|line| line.last()), Some(&0));
//! ```
//!
//! `examples/ask.rs` is a whole host in some forty lines of code. Requests may be sent again when no reply comes: only
//! [`Request::Feed`], [`Request::SetZero`] and [`Request::ShiftBias`] do more on the second time, [`Request::Play`]
//! where the waveform has ended meanwhile, [`Request::SetMode`], which begins most modes anew, and [`Request::Reset`],
//! which resets once more.
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
pub mod waveform;

pub use faults::Faults;
pub use frame::{Deframer, FrameError, VERSION, encode};
pub use health::{Health, ResetCause};
pub use identity::{Identity, TableSource};
pub use message::{Codes, MOST_VALUES, Record, References, Reply, Request, ToDevice, ToHost};
pub use mode::Mode;
pub use refusal::Refusal;
pub use sample::{Sample, Samples, stream_every};
pub use text::{LAST_WORDS, LastWords, Reason, Text, text};
pub use uid::Uid;
pub use waveform::{MOST_POINTS, Playback};

/// The serial line's rate, bit/s, 8 data bits, no parity, one stop bit. The stream takes at most four fifths of it
/// ([`stream_every`]); that of 2,000 ticks a second, which is whole, about half.
pub const BAUD: u32 = 921_600;
