//! Why a device does not do what it was asked.

use crate::text::Text;
use serde::{Deserialize, Serialize};

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
    /// Codes were fed, but the mode is not [`Mode::Pil`](crate::Mode::Pil).
    NotPil,
    /// The table does not say how the DAC drives the amplifier, or there is none.
    NoDrive,
    /// There is a fault that keeps the DAC at its safe value: nothing can be followed.
    Faulty,
    /// The DAC drives the amplifier by one of the tables only: the one in use, or the one that would be used.
    Rewired,
    /// References came, but the mode is not [`Mode::Follow`](crate::Mode::Follow).
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
            Self::NoDrive => write!(f, "its table does not say how the DAC drives the amplifier"),
            Self::Faulty => write!(f, "a fault keeps its output at rest"),
            Self::Rewired => {
                write!(f, "the new table changes what the DAC output is connected to (amplifier or display)")
            }
            Self::NotFollowing => write!(f, "it takes references in the mode that follows them only"),
            Self::NotFinite => write!(f, "a reference is not a finite number"),
            Self::Busy => write!(f, "it is busy; ask again"),
            Self::Version => write!(f, "it speaks another version of the protocol"),
        }
    }
}
