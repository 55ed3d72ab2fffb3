//! `piezo erase`: empties the device's parameter store.

use super::device::note_damage;
use super::print::out;
use crate::option::link::{PortOption, WriteOptions};
use anyhow::{Result, ensure};
use clap::Args;
use protocol::TableSource;
use serde_json::json;

/// Arguments of `piezo erase`.
#[derive(Args, Debug)]
pub struct Erase {
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// When it may be written.
    #[command(flatten)]
    pub write: WriteOptions,
}

/// Runs the verb.
pub fn run(arguments: &Erase) -> Result<bool> {
    let (mut client, identity) = arguments.port.connect()?;
    let (restarted, refused) = arguments.write.write(&mut client, None, |client, consent| client.erase(consent))?;
    if let Some(identity) = &restarted {
        ensure!(
            identity.source != TableSource::Stored,
            "after its restart the device still has a stored table: erase again"
        );
    }
    note_damage(&client);
    let board = &identity.board;
    if arguments.json {
        let source = restarted.as_ref().map(|identity| &identity.source);
        let erased = !arguments.write.dry_run;
        out(&serde_json::to_string_pretty(&json!({ "erased": erased, "source": source, "refused": refused }))?);
    } else if arguments.write.dry_run {
        out(&remedy::would_erase(board, refused.is_empty(), arguments.write.rewired));
    } else {
        out(&remedy::erased(board, restarted.as_ref().map(|identity| &identity.source), &arguments.port.port));
    }
    Ok(refused.is_empty())
}
