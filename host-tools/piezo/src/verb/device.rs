//! What the verbs that talk to a device have in common.

use anyhow::{Context, Result, anyhow, ensure};
use device_link::{Address, Client};
use estimator_core::table::Board;
use estimator_core::{Admitted, Table, record};
use identification::table_file::TableFile;
use protocol::{Health, Mode};
use std::path::Path;

/// An error where the device does anything but estimate.
pub fn require_estimating(health: &Health, port: &Address) -> Result<()> {
    ensure!(
        health.mode == Mode::Estimate,
        "{port}: the device {}; make it estimate again: piezo reset --port {port}",
        device_link::words::mode(health.mode)
    );
    Ok(())
}

/// Reads a table to be written to a device: a table.toml, or the record in a table.bin.
pub fn load(path: &Path) -> Result<Admitted> {
    if path.extension().is_none_or(|extension| extension != "bin") {
        return Ok(TableFile::load(path)?.1);
    }
    let bytes = std::fs::read(path).with_context(|| format!("{}: cannot be read", path.display()))?;
    Table::parse(&bytes).with_context(|| format!("{}: is refused", path.display()))
}

/// The checksum of a record as it names a table for people.
pub fn checksum(record: &[u8]) -> String {
    format!("{:08x}", record::checksum(record).unwrap_or(0))
}

/// Says when frames came damaged, which a sound line does not do.
pub fn note_damage(client: &Client) {
    if client.damaged() > 0 {
        eprintln!("piezo: {} frames came damaged: check the cable and its ground", client.damaged());
    }
}

/// Refuses the table in a file where it does not fit a board.
pub fn fits(board: &Board, table: &Admitted, file: &Path) -> Result<()> {
    table.fits(board).map_err(|misfit| anyhow!("{}", remedy::board(&misfit, file)))
}
