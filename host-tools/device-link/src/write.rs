//! How a device's flash is written: whether it estimates meanwhile, and what it does afterwards.

use crate::client::{Client, WriteConsent};
use crate::error::LinkError;
use crate::table;
use estimator_core::Table;
use parameter_store::StoreError;
use protocol::{Faults, Identity, Mode, Refusal};
use std::fmt::Display;

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
    /// The link fails while flash is written.
    #[error("{}", sentences(.0, UNSURE))]
    Unsure(LinkError),
    /// The link fails, or the device can no longer mark the table of before, when flash has been written, and the
    /// device has not restarted.
    #[error("{}", sentences(.0, WRITTEN))]
    Written(LinkError),
    /// The link fails when flash has been written, while the device restarts.
    #[error("{}", sentences(.0, RESTARTING))]
    Restarting(LinkError),
}

/// What is known where the reply to a write never came.
pub const UNSURE: &str = "So it is not known whether the device has written its flash: it holds what it held before, or all that it was to \
                          hold, and uses it from its next restart on.";
/// What is known where a reply after that never came.
pub const WRITTEN: &str = "What was to be written is written, and used from the next restart on.";
/// What is known where the device was then asked to restart, and no reply came.
pub const RESTARTING: &str = "What was to be written is written; whether the device has restarted is not known.";

/// What went wrong and what is known: two sentences, also where the first comes without its full stop.
pub fn sentences(wrong: &impl Display, known: &str) -> String {
    let wrong = wrong.to_string();
    let stop = if wrong.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{wrong}{stop} {known}")
}

impl Writing {
    /// Why a device would not be written as asked, or refuse it: by what it does, and by its own table beside the one
    /// to be written, where it is to be one; an erased store leaves it to the one of the firmware image, which is not
    /// known here. Where a stored table could not be used, what the device runs says nothing of its wires.
    ///
    /// # Errors
    /// The link fails.
    pub fn refusals(self, client: &mut Client, table: Option<&Table>) -> Result<Vec<WriteError>, LinkError> {
        let mut refusals = Vec::new();
        match self.may_write(client) {
            Err(WriteError::Link(error)) => return Err(error),
            may => refusals.extend(may.err()),
        }
        // One that cannot be read is refused for that.
        let former = table::in_use(client)?.and_then(|record| Table::parse(&record).ok());
        let rewires = table.zip(former).is_some_and(|(table, former)| table.drive.is_some() != former.drive.is_some());
        let unknown = client.health()?.faults.contains(Faults::TABLE_FALLBACK);
        if (rewires || unknown) && !self.rewired {
            let refusal = Box::new(Refusal::Rewired);
            refusals.push(LinkError::Refused { port: client.address().clone(), refusal }.into());
        }
        Ok(refusals)
    }

    fn pauses(self) -> bool {
        self.pause || (self.reset && !self.while_estimating)
    }

    fn may_write(self, client: &mut Client) -> Result<(), WriteError> {
        match !self.pauses() && !self.while_estimating && estimating(client)? {
            true => Err(WriteError::Estimating),
            false => Ok(()),
        }
    }

    /// Has `write` write as asked; returns the identity after the restart, where there was one. A device that would
    /// refuse it for anything but that it estimates does so before it is paused: with a pause it loses its zero.
    ///
    /// # Errors
    /// The device is estimating and nothing was said about it, or it fails.
    pub fn write(
        self,
        client: &mut Client,
        write: impl Fn(&mut Client, WriteConsent) -> Result<(), LinkError>,
    ) -> Result<Option<Identity>, WriteError> {
        self.may_write(client)?;
        let pauses = self.pauses();
        let consent = WriteConsent { while_estimating: self.while_estimating && !pauses, rewired: self.rewired };
        let estimates =
            |error: &LinkError| matches!(error, LinkError::Refused { refusal, .. } if **refusal == Refusal::Estimating);
        let (mut pause, mut written) = (false, write(client, consent));
        if pauses && written.as_ref().is_err_and(estimates) {
            client.set_mode(Mode::Pause)?;
            (pause, written) = (true, write(client, consent));
        }
        // A device that paused before, and was written, goes on as well.
        let resumed = match (pause && written.is_err()) || (pauses && written.is_ok() && !self.reset) {
            true => client.set_mode(Mode::Estimate),
            false => Ok(()),
        };
        // What went wrong first is what is said.
        written.map_err(|error| match &error {
            LinkError::Refused { refusal, .. } if stored(refusal) => WriteError::Written(error),
            LinkError::Refused { .. } => WriteError::Link(error),
            _ => WriteError::Unsure(error),
        })?;
        resumed.map_err(WriteError::Written)?;
        if !self.reset {
            return Ok(None);
        }
        client.restart().map(Some).map_err(|error| match error {
            LinkError::Refused { .. } => WriteError::Written(error),
            error => WriteError::Restarting(error),
        })
    }
}

/// Whether a device that refuses says that the new table is stored all the same.
fn stored(refusal: &Refusal) -> bool {
    matches!(refusal, Refusal::Store(why) if **why == *StoreError::NotMarked.to_string())
}

fn estimating(client: &mut Client) -> Result<bool, LinkError> {
    if matches!(client.health()?.mode, Mode::Pil | Mode::Pause) {
        return Ok(false);
    }
    Ok(table::in_use(client)?.is_some())
}

#[cfg(test)]
mod tests;
