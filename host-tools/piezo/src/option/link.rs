//! The options of the verbs that talk to a device: where it is, and how its flash is written.

use anyhow::Result;
use clap::Args;
use device_link::busy::{Busy, idle};
use device_link::write::Writing;
use device_link::{Address, Client, LinkError, WriteConsent};
use estimator_core::Table;
use protocol::Identity;
use std::error::Error;

/// Where the device is.
#[derive(Args, Clone, Debug)]
pub struct PortOption {
    /// Where the device is: a serial port (/dev/ttyACM0, COM3), auto, which is the only ST-Link that is plugged in, or
    /// tcp:HOST:PORT of an emulated board.
    #[arg(long, value_name = "PORT", env = "PIEZO_PORT", default_value = "auto")]
    pub port: Address,
}

impl PortOption {
    /// Opens the link.
    pub fn connect(&self) -> Result<(Client, Identity)> {
        Ok(Client::connect(&self.port)?)
    }
}

/// How flash is written.
#[derive(Args, Clone, Debug)]
pub struct WriteOptions {
    /// Write although the device is estimating: erasing a page may cost ticks.
    #[arg(long, conflicts_with = "pause")]
    pub while_estimating: bool,
    /// Pause the estimate meanwhile (the DAC goes to its safe value); it then starts anew, from rest.
    #[arg(long)]
    pub pause: bool,
    /// Restart the device afterwards, and check that it has taken effect. This includes --pause.
    #[arg(long)]
    pub reset: bool,
    /// The DAC is unplugged, or plugged where it belongs by the new table: by the one it drives the amplifier, by the
    /// other it shows the displacement.
    #[arg(long)]
    pub rewired: bool,
    /// Check everything, say what would be refused, and write nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// What becomes of what the device drives.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

/// What becomes of what the device drives.
#[derive(Args, Clone, Copy, Debug)]
pub struct Interrupting {
    /// End what the device drives: a waveform, the set-point that it follows, what a host told it.
    #[arg(long)]
    pub force: bool,
}

/// What becomes of a table that has doubts.
#[derive(Args, Clone, Copy, Debug)]
pub struct Doubted {
    /// Write a table that has doubts, without being asked.
    #[arg(long)]
    pub doubted: bool,
}

impl Interrupting {
    /// Refuses to end what the device drives, unless that was said; a dry run, which ends nothing, says so, and goes
    /// on with that.
    pub fn consent(self, client: &mut Client, dry_run: bool) -> Result<Option<String>> {
        match idle(client) {
            Err(Busy::Drives(_)) if self.force => Ok(None),
            Err(busy @ Busy::Drives(_)) if dry_run => Ok(Some(careful(&busy))),
            idle => Ok(idle.map(|()| None)?),
        }
    }
}

/// Says what would be refused but for the dry run.
pub fn careful(refusal: &(dyn Error + 'static)) -> String {
    let said = remedy::sentence(refusal);
    eprintln!("piezo: careful: {said}");
    said
}

impl WriteOptions {
    /// Refuses what the device would refuse of [`WriteOptions::write`] with this table.
    pub fn hindered(&self, client: &mut Client, table: &Table) -> Result<()> {
        self.interrupting.consent(client, false)?;
        self.writing().refusals(client, Some(table))?.into_iter().next().map_or(Ok(()), |refusal| Err(refusal.into()))
    }

    fn writing(&self) -> Writing {
        let &Self { while_estimating, pause, reset, rewired, .. } = self;
        Writing { while_estimating, pause, reset, rewired }
    }

    /// Writes as asked, a table or none; returns the identity after the restart, where there was one. A dry run says
    /// what would be refused, and returns it.
    ///
    /// # Errors
    /// The device is estimating and nothing was said about it, or it fails.
    pub fn write(
        &self,
        client: &mut Client,
        table: Option<&Table>,
        write: impl Fn(&mut Client, WriteConsent) -> Result<(), LinkError>,
    ) -> Result<(Option<Identity>, Vec<String>)> {
        let busy = self.interrupting.consent(client, self.dry_run)?;
        let writing = self.writing();
        if self.dry_run {
            let refusals = writing.refusals(client, table)?;
            return Ok((None, busy.into_iter().chain(refusals.iter().map(|refusal| careful(refusal))).collect()));
        }
        Ok((writing.write(client, write)?, Vec::new()))
    }
}
