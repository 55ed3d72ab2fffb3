//! How a device's flash is written: whether it estimates meanwhile, and what it does afterwards.

use crate::client::{Client, WriteConsent};
use crate::error::LinkError;
use crate::table;
use protocol::{Identity, Mode};

/// How flash is written.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Writing {
    /// Write although the device is estimating: erasing a page may cost ticks.
    pub while_estimating: bool,
    /// Pause the estimate meanwhile; it then starts anew, from rest.
    pub pause: bool,
    /// Restart the device afterwards. It is paused before, unless it may go on estimating.
    pub reset: bool,
    /// The DAC is unplugged, or plugged where it belongs by the new table.
    pub rewired: bool,
    /// Check everything and write nothing.
    pub dry_run: bool,
}

/// Why nothing was written, or not all was done.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The device is estimating, and nothing was said about it.
    #[error("the device is estimating, and writing flash may cost ticks")]
    Estimating,
}

impl Writing {
    /// Has `write` write as asked; returns the identity after the restart, where there was one.
    ///
    /// # Errors
    /// The device is estimating and nothing was said about it, or it fails.
    pub fn write(
        self,
        client: &mut Client,
        write: impl FnOnce(&mut Client, WriteConsent) -> Result<(), LinkError>,
    ) -> Result<Option<Identity>, WriteError> {
        let pause = self.pause || (self.reset && !self.while_estimating);
        if !pause && !self.while_estimating && estimating(client)? {
            return Err(WriteError::Estimating);
        }
        if self.dry_run {
            return Ok(None);
        }
        if pause {
            client.set_mode(Mode::Pause)?;
        }
        let consent = WriteConsent { while_estimating: self.while_estimating, rewired: self.rewired };
        let written = write(client, consent);
        let resumed = match pause && (written.is_err() || !self.reset) {
            true => client.set_mode(Mode::Estimate),
            false => Ok(()),
        };
        // What went wrong first is what is said.
        written?;
        resumed?;
        if self.reset { Ok(Some(client.restart()?)) } else { Ok(None) }
    }
}

fn estimating(client: &mut Client) -> Result<bool, LinkError> {
    if client.health()?.mode != Mode::Estimate {
        return Ok(false);
    }
    Ok(table::in_use(client)?.is_some())
}
