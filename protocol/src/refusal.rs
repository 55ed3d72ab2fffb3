//! Why a device does not do what it was asked.

use crate::text::Reason;
use serde::{Deserialize, Serialize};

/// Why the device does not do it.
#[derive(Clone, PartialEq, Debug, thiserror::Error, Serialize, Deserialize)]
pub enum Refusal {
    /// Writing flash while estimating, without having been told to. Where code and store lie in banks of their own no
    /// tick is expected to be late for it; no silicon has shown that yet.
    #[error("it is estimating, and writing flash may cost ticks")]
    Estimating,
    /// The record is not one that this device can run.
    #[error("the table is refused: {0}")]
    Table(Reason),
    /// The parameter store could not be written or read.
    #[error("the parameter store failed: {0}")]
    Store(Reason),
    /// There is no table to send.
    #[error("it has no admissible table")]
    NoTable,
    /// There is no displacement to tell the bias by: it pauses, or has no table, or no crystal.
    #[error("it is not estimating")]
    NotEstimating,
    /// What the displacement is to be called, or to be shifted by, cannot be true.
    #[error("it takes a bias only from finite displacements of at most {span_um} µm, the span of its table's limits")]
    BeyondSpan {
        /// Span of the table's displacement limits, µm.
        span_um: f32,
    },
    /// The estimate began so lately that an actuator which moved then is still on its way.
    #[error("its estimate has only just begun")]
    TooSoon,
    /// Codes were fed, but the mode is not [`Mode::Pil`](crate::Mode::Pil).
    #[error("it takes fed samples in processor-in-the-loop mode only")]
    NotPil,
    /// The table does not say how the DAC drives the amplifier, or there is none.
    #[error("its table does not say how the DAC drives the amplifier")]
    NoDrive,
    /// The table does not say which displacements the set-point's codes stand for.
    #[error("its table does not say which displacements a set-point wants")]
    NoSetpoint,
    /// The board has no channel for a set-point.
    #[error("this board has no input for a set-point")]
    NoSetpointInput,
    /// There is a fault that keeps the DAC at its safe value: nothing can be followed.
    #[error("a fault keeps its output at rest")]
    Faulty,
    /// The DAC drives the amplifier by one of the tables only: the one in use, or the one that would be used. Or
    /// something is stored that could not be used, and nobody knows what the DAC is wired for.
    #[error("the new table changes, or may change, what the DAC output is connected to (amplifier or display)")]
    Rewired,
    /// References came, but the mode is none that takes them
    /// ([`Mode::takes_references`](crate::Mode::takes_references)).
    #[error("it takes references in the modes that drive by them only")]
    NotFollowing,
    /// A reference is not a finite number.
    #[error("a reference is not a finite number")]
    NotFinite,
    /// What is to be played is not what has been loaded.
    #[error("the waveform in its memory, of {points} points, is not the one to be played")]
    NotLoaded {
        /// How many points have been loaded.
        points: u16,
    },
    /// A waveform is played, so that no other may take its place.
    #[error("it plays a waveform")]
    Playing,
    /// More points than the device keeps ([`MOST_POINTS`](crate::MOST_POINTS)).
    #[error("it keeps no more than {} points", crate::MOST_POINTS)]
    TooManyPoints,
    /// The board has no input for a trigger.
    #[error("this board has no input for a trigger")]
    NoTriggerInput,
    /// Too many requests at once; ask again. A mode may be entered all the same where the tick comes later than it
    /// was waited for.
    #[error("it is busy; ask again")]
    Busy,
    /// The request was of another protocol version. The reply says which the device speaks by its own frame.
    #[error("it speaks another version of the protocol")]
    Version,
    /// [`Mode::Waveform`](crate::Mode::Waveform) is entered by [`Play`](crate::Request::Play) alone, which says how.
    #[error("it plays a waveform only when it is told how")]
    NotByMode,
    /// The displacement of now is to be told where the last code was at an end of the ADC's range, beyond the table's
    /// voltages or held, or a fault lasts: what was estimated of it is not where the actuator is.
    #[error(
        "its voltage is not to be believed now: at an end of the ADC's range, beyond its table's, held, or under a fault"
    )]
    NotBelieved,
}
