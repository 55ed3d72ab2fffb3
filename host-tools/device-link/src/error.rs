//! What can go wrong between host and device.

use super::port::{Address, PortError};
use protocol::{Refusal, VERSION};

/// What went wrong between host and device.
#[derive(Debug, thiserror::Error)]
pub enum LinkError {
    /// The port cannot be opened.
    #[error(transparent)]
    Port(#[from] PortError),
    /// Reading or writing the port failed, as when a cable is pulled.
    #[error("{port}: the link broke: {error}; is the cable still in, the board powered, the emulator running?")]
    Broken {
        /// Address of the device.
        port: Address,
        /// What the operating system says.
        error: std::io::Error,
    },
    /// No reply came in time.
    #[error(
        "{port}: no answer. Is it the board's port, is this project's firmware on the board, made from the same sources as \
         this program (protocol version {VERSION}), and is no other program connected to it?"
    )]
    Silent {
        /// Address of the device.
        port: Address,
    },
    /// The other side speaks another version.
    #[error("{port}: its firmware speaks protocol version {found}, this program version {VERSION}: {}", older(*.found))]
    Version {
        /// Address of the device.
        port: Address,
        /// The version that the device speaks.
        found: u8,
    },
    /// No reply to a request that must not be sent twice.
    #[error("{port}: no answer, so it is not known whether it was done")]
    Unknown {
        /// Address of the device.
        port: Address,
    },
    /// The device refuses what it was asked for, and says why.
    #[error("{port}: the device refuses: {refusal}")]
    Refused {
        /// Address of the device.
        port: Address,
        /// What the device says.
        refusal: Box<Refusal>,
    },
    /// A reply to another question.
    #[error(
        "{port}: the device answered something else than it was asked; build its firmware and this program from the same \
         sources"
    )]
    Confused {
        /// Address of the device.
        port: Address,
    },
}

fn older(found: u8) -> &'static str {
    if found < VERSION {
        "the firmware is older"
    } else {
        "this program is older; build it again from the sources of the firmware"
    }
}
