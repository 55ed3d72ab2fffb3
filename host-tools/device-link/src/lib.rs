//! The host's end of the link to a device ([`protocol`]), and what is done with a device over it or over a debug probe.

pub mod board;
pub mod busy;
pub mod client;
pub mod cycle;
pub mod error;
pub mod interrupt;
pub mod motion;
pub mod pages;
pub mod pil;
pub mod play;
pub mod port;
pub mod probe;
pub mod recording;
pub mod sensor;
pub mod stlink;
pub mod streamed;
pub mod table;
pub mod told;
pub mod window;
pub mod words;
pub mod write;

#[cfg(test)]
mod tests;

pub use client::{Client, WriteConsent};
pub use error::LinkError;
pub use port::Address;
