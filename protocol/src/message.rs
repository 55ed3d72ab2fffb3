//! Requests, replies, and what comes unasked.

use crate::Text;
use crate::health::Health;
use crate::identity::Identity;
use crate::sample::Samples;
use estimator_core::record::MAX_LENGTH;
use heapless::Vec;
use serde::{Deserialize, Serialize};

/// A table's binary record ([`estimator_core::record`]).
pub type Record = Vec<u8, MAX_LENGTH>;
/// ADC codes to be fed to the tick.
pub type Codes = Vec<u16, 64>;
/// Wanted displacements, µm relative to the model's zero.
pub type References = Vec<f32, 64>;

/// What the tick does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Mode {
    /// Estimates from the ADC; the DAC follows.
    #[default]
    Estimate,
    /// Estimates from codes fed over the link (processor in the loop), one a tick, none where there is none; the DAC is safe.
    Pil,
    /// Estimates nothing; the DAC is safe.
    Pause,
    /// Estimates from the ADC, while the DAC drives the amplifier to where the references want the displacement, one a tick, the
    /// last one where there is none; at rest before the first. A fault, or a second without references, sends it back to rest,
    /// and there it stays until the mode is set again.
    Follow,
}

/// Host to device.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct ToDevice {
    /// Comes back in the reply.
    pub sequence: u16,
    /// What is wanted.
    pub request: Request,
}

/// What the host may ask.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Request {
    /// Who are you? → [`Reply::Identity`]
    Identify,
    /// How are you? → [`Reply::Health`]
    Health,
    /// Forget counts, faults seen, and last words. → [`Reply::Done`]
    Forget,
    /// The table in use. → [`Reply::Table`]
    Pull,
    /// Store a table; it is used from the next reset on. → [`Reply::Done`]
    Push {
        /// Its record.
        record: Record,
        /// Write although the tick is estimating: flash operations may cost ticks.
        while_estimating: bool,
        /// Write although the DAC is then no longer wired as it was: it drives the amplifier by one of the tables only.
        rewired: bool,
    },
    /// Empty the parameter store; the compiled table is used from the next reset on. → [`Reply::Done`]
    Erase {
        /// As in [`Self::Push`].
        while_estimating: bool,
        /// As in [`Self::Push`], of the compiled table.
        rewired: bool,
    },
    /// Stream samples, or stop. → [`Reply::Done`]
    Stream(bool),
    /// Call the displacement of now 0. → [`Reply::Done`]
    SetZero,
    /// Change what the tick does; the estimate starts anew, from rest, samples are counted from 0, and streaming ends.
    /// → [`Reply::Done`]
    SetMode(Mode),
    /// Codes for the next ticks, in [`Mode::Pil`]. → [`Reply::Fed`]
    Feed(Codes),
    /// Wanted displacements for the next ticks, in [`Mode::Follow`]. → [`Reply::Referred`]
    Refer {
        /// One a tick.
        references: References,
        /// Follow them from now on. Until then they wait, so that the first ones need not be in a hurry.
        go: bool,
        /// Stay at the last one for good. Otherwise the voltage goes back to rest when none has come for a second.
        stay: bool,
    },
    /// Start again. → [`Reply::Done`], then the reset.
    Reset,
}

/// Device to host.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum ToHost {
    /// The answer to a request.
    Reply {
        /// The request's sequence number.
        to: u16,
        /// The answer.
        reply: Reply,
    },
    /// Samples, while streaming.
    Samples(Samples),
}

/// What the device may answer.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Reply {
    /// To [`Request::Identify`].
    Identity(Identity),
    /// To [`Request::Health`].
    Health(Health),
    /// To [`Request::Pull`].
    Table(Record),
    /// It is done.
    Done,
    /// To [`Request::Feed`]: how many codes there was room for; the rest must be sent again.
    Fed(u16),
    /// To [`Request::Refer`].
    Referred {
        /// How many there was room for; the rest must be sent again.
        taken: u16,
        /// Ticks since the mode was set that found no reference after the first, and held the last one.
        starved: u32,
    },
    /// It is not done.
    Refused(Refusal),
}

/// Why the device does not do it.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum Refusal {
    /// Writing flash while estimating, without having been told to.
    Estimating,
    /// The record is not one that this device can run.
    Table(Text<120>),
    /// The parameter store could not be written or read.
    Store(Text<120>),
    /// There is no table to send.
    NoTable,
    /// There is no displacement to call 0: nothing is being estimated from the ADC.
    NotEstimating,
    /// Codes were fed, but the mode is not [`Mode::Pil`].
    NotPil,
    /// The table does not say how the DAC drives the amplifier, or there is none.
    NoDrive,
    /// There is a fault that keeps the DAC at its safe value: nothing can be followed.
    Faulty,
    /// The DAC drives the amplifier by one of the tables only: the one in use, or the one that would be used.
    Rewired,
    /// References came, but the mode is not [`Mode::Follow`].
    NotFollowing,
    /// A reference is not a finite number.
    NotFinite,
    /// Too many requests at once; ask again.
    Busy,
    /// The request was of another protocol version. The reply says which the device speaks by its own frame.
    Version,
}

impl core::fmt::Display for Refusal {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Estimating => write!(f, "it is estimating, and writing flash may cost ticks"),
            Self::Table(reason) => write!(f, "the table is refused: {reason}"),
            Self::Store(reason) => write!(f, "the parameter store failed: {reason}"),
            Self::NoTable => write!(f, "it has no admissible table"),
            Self::NotEstimating => write!(f, "it is not estimating"),
            Self::NotPil => write!(f, "it takes fed samples in processor-in-the-loop mode only"),
            Self::NoDrive => {
                write!(f, "its table does not say how the DAC drives the amplifier: piezo emit --drive-span, then push")
            }
            Self::Faulty => write!(f, "a fault keeps its output at rest: piezo info says which"),
            Self::Rewired => write!(
                f,
                "by the one table the DAC drives the amplifier, by the other it shows the displacement: unplug it, say --rewired, \
                 and plug it where it then belongs"
            ),
            Self::NotFollowing => write!(f, "it takes references in the mode that follows them only"),
            Self::NotFinite => write!(f, "a reference is not a finite number"),
            Self::Busy => write!(f, "it is busy; ask again"),
            Self::Version => write!(f, "it speaks another version of the protocol"),
        }
    }
}
