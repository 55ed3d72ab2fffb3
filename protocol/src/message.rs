//! Requests, replies, and what comes unasked.

use crate::health::Health;
use crate::identity::Identity;
use crate::mode::Mode;
use crate::refusal::Refusal;
use crate::sample::Samples;
use crate::waveform::Playback;
use estimator_core::record::MAX_LENGTH;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A table's binary record ([`estimator_core::record`]).
pub type Record = Vec<u8, MAX_LENGTH>;
/// Most values in one request.
pub const MOST_VALUES: usize = 64;
/// ADC codes to be fed to the tick.
pub type Codes = Vec<u16, MOST_VALUES>;
/// What is wanted, one a tick: displacements in [`Mode::Follow`], µm relative to the model's zero; the amplifier's
/// voltages in [`Mode::Excite`], V.
pub type References = Vec<f32, MOST_VALUES>;

/// What a host sends: a request with a number, by which its reply is known.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct ToDevice {
    /// Comes back in the reply.
    pub sequence: u16,
    /// What the device is asked to do or to tell.
    pub request: Request,
}

/// What the host may ask.
#[expect(clippy::large_enum_variant, reason = "the device has no allocator, and holds one at a time")]
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Request {
    /// Who are you? → [`Reply::Identity`]
    Identify,
    /// How are you? → [`Reply::Health`]
    Health,
    /// Set the counters to 0, a waveform's count of lines excepted, and forget the faults seen and the last
    /// words. → [`Reply::Done`]
    Forget,
    /// The table in use. → [`Reply::Table`]
    Pull,
    /// Store a table; it is used from the next reset on. → [`Reply::Done`]
    Push {
        /// The table as [`estimator_core::record`] encodes it, checksum included.
        record: Record,
        /// Write although the tick is estimating: flash operations may cost ticks.
        while_estimating: bool,
        /// Write although the DAC is then no longer wired as it was: it drives the amplifier by one of the tables only.
        rewired: bool,
    },
    /// Empty the parameter store; the compiled table is used from the next reset on. → [`Reply::Done`]
    Erase {
        /// Erase although the tick is estimating: flash operations may cost ticks.
        while_estimating: bool,
        /// As in [`Self::Push`], of the compiled table.
        rewired: bool,
    },
    /// Stream samples, or stop. → [`Reply::Done`]
    Stream(bool),
    /// Tell the bias by a displacement that is known now, in every mode but [`Mode::Pause`]; until the estimate starts
    /// anew. → [`Reply::Done`]
    SetZero {
        /// What the displacement of now is called, µm; no larger than the span of the table's displacement limits.
        at_um: f32,
    },
    /// Shift the bias, in every mode but [`Mode::Pause`]; until the estimate starts anew. → [`Reply::Done`]
    ShiftBias {
        /// What is added to the displacement from now on, µm; no larger than the span of the
        /// table's displacement limits.
        by_um: f32,
    },
    /// Change what the tick does, but for [`Mode::Waveform`]; samples are counted from 0, and streaming ends. The
    /// estimate goes on from one mode that [measures](Mode::measures) to another; else it starts anew, from rest, as it
    /// does when a fault that it suffers from has passed. To a device that follows its set-point, or waits for that,
    /// [`Mode::Linearise`] says nothing new and changes nothing. → [`Reply::Done`]
    SetMode(Mode),
    /// Codes for the next ticks, in [`Mode::Pil`]. → [`Reply::Fed`]
    Feed(Codes),
    /// Wanted displacements for the next ticks, in [`Mode::Follow`], or voltages, in
    /// [`Mode::Excite`]. → [`Reply::Referred`]
    ///
    /// Those that have been taken before are not taken again, and none where some before them are missing: a request
    /// that comes twice does what it does once, and one without references and `go` asks how far it is.
    Refer {
        /// The number of the first one, counted from 0 when the mode was set.
        first: u32,
        /// One a tick, µm in [`Mode::Follow`] and V in [`Mode::Excite`], the earliest first.
        references: References,
        /// Follow them from now on. Until then they wait, so that the first ones need not be in a hurry.
        go: bool,
        /// Hold the last one: in [`Mode::Follow`] for ever, in [`Mode::Excite`] for as long as the host speaks.
        /// Otherwise the voltage goes back to rest when none has come for a second.
        hold: bool,
    },
    /// Go to the safe output, then start again. → [`Reply::Resetting`], then the reset.
    Reset,
    /// Points of a waveform into the device's memory, while none is played. → [`Reply::Loaded`]
    ///
    /// What was loaded from `first` on is forgotten, by a request without points, too. They are not taken where some
    /// before them are missing: a request that comes twice does what it does once.
    Load {
        /// The number of the first one, counted from 0.
        first: u16,
        /// µm relative to the model's zero.
        points: References,
    },
    /// Play what has been loaded, in [`Mode::Waveform`]. To a device that plays it just so it says nothing new and
    /// changes nothing. → [`Reply::Done`]
    Play(Playback),
}

/// What a device sends: one reply to each request, and samples unasked while it streams.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
#[expect(clippy::large_enum_variant, reason = "a device has no heap")]
pub enum ToHost {
    /// The answer to a request.
    Reply {
        /// [`ToDevice::sequence`] of the request that is answered.
        to: u16,
        /// The answer to the request.
        reply: Reply,
    },
    /// Samples of the ticks since the last such frame, after [`Request::Stream`].
    Samples(Samples),
}

/// What the device may answer.
#[allow(
    clippy::large_enum_variant,
    reason = "the device has no allocator, and holds one at a time; not on a 64-bit host"
)]
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Reply {
    /// To [`Request::Identify`]: who the device is.
    Identity(Identity),
    /// To [`Request::Health`]: how the device is.
    Health(Health),
    /// To [`Request::Pull`]: the record of the table in use.
    Table(Record),
    /// What was asked is done.
    Done,
    /// To [`Request::Feed`]: how many codes there was room for; the rest must be sent again.
    Fed(u16),
    /// To [`Request::Refer`]: what became of the references.
    Referred {
        /// The number of the next one: all before were taken, and it and those behind must be sent (again).
        next: u32,
        /// Ticks since the mode was set that had found no reference after the first, and held the last one, when the
        /// reference before `next` was taken.
        starved: u32,
    },
    /// To [`Request::Reset`]: it will start again.
    Resetting {
        /// How long the way to the safe output takes at the drive's slew rate, ms.
        in_ms: u32,
    },
    /// What was asked is not done, and why.
    Refused(Refusal),
    /// To [`Request::Load`]: how many points there are now; those behind must be sent (again).
    Loaded(u16),
}
