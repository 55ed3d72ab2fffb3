//! Whether anything depends on the voltage that a device puts out: a waveform, a controller's set-point, a host's trajectory.

use crate::client::Client;
use crate::error::LinkError;
use protocol::{Faults, Mode};

/// Why a device is not interrupted.
#[derive(Debug, thiserror::Error)]
pub enum Busy {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// It drives the amplifier.
    #[error("the device {}, and this would end it", match .0 {
        Mode::Waveform => "plays a waveform",
        Mode::Linearise => "follows the set-point at its ADC",
        _ => "is driven by a host, or holds what one told it",
    })]
    Drives(Mode),
}

/// Refuses a device that drives the amplifier. One whose voltage is at rest, since a waveform is over, a fault sent it there or it
/// waits for its set-point, is interrupted in nothing.
///
/// # Errors
/// It drives, or the link fails.
pub fn idle(client: &mut Client) -> Result<(), Busy> {
    let health = client.health()?;
    match health.mode.drives() && !health.faults.contains(Faults::SAFE_OUTPUT) {
        true => Err(Busy::Drives(health.mode)),
        false => Ok(()),
    }
}
