//! What the verbs that talk to a device have in common.

use anyhow::{Context, Result, anyhow, bail, ensure};
use device_link::{Address, Client};
use estimator_core::table::Interface;
use estimator_core::{Admitted, record};
use protocol::{Health, Identity};
use std::io::{IsTerminal, stderr, stdin};
use std::path::Path;
use table_files::TableFile;

/// An error where the device estimates nothing from its ADC.
pub fn require_estimating(health: &Health, port: &Address) -> Result<()> {
    if let Some(why) = remedy::not_estimating(health.mode, port) {
        bail!(why);
    }
    Ok(())
}

/// What a table's doubts, once they are said, leave to be answered before it goes to a board.
#[derive(Debug)]
pub enum Doubts<'f> {
    /// Nothing: it has none, or may go with them.
    Settled,
    /// On a terminal, whether this file goes all the same.
    Asked(&'f Path),
    /// Why a dry run says that it would not go.
    Refused(String),
}

/// Says a table's doubts before it goes to a board. Where nobody can be asked, it goes only if that was said.
pub fn doubted<'f>(file: &'f Path, doubts: &[String], may: bool, dry_run: bool) -> Result<Doubts<'f>> {
    doubts.iter().for_each(|doubt| eprintln!("piezo: careful: {}: {doubt}", file.display()));
    if doubts.is_empty() || may {
        return Ok(Doubts::Settled);
    }
    if stdin().is_terminal() && stderr().is_terminal() {
        return Ok(if dry_run { Doubts::Settled } else { Doubts::Asked(file) });
    }
    let refusal = format!(
        "{}: has doubts, which stand above, and nobody can be asked: mend what they name, or write it all the same with --doubted",
        file.display()
    );
    ensure!(dry_run, refusal);
    eprintln!("piezo: careful: {refusal}");
    Ok(Doubts::Refused(refusal))
}

impl Doubts<'_> {
    /// Why a dry run says that the table would not go.
    pub fn refused(self) -> Option<String> {
        if let Self::Refused(why) = self { Some(why) } else { None }
    }

    /// Asks where that is open: after whatever else may hinder, which nobody is asked for nothing. Nothing listens for
    /// Ctrl-C by then, so that it ends the question.
    pub fn ask(&self, hindered: impl FnOnce() -> Result<()>) -> Result<()> {
        let Self::Asked(file) = self else { return Ok(()) };
        hindered()?;
        eprint!("Does it go to the board all the same? [y/N] ");
        let mut answer = String::new();
        stdin().read_line(&mut answer).context("standard input")?;
        let yes = ["y", "yes"].contains(&answer.trim().to_lowercase().as_str());
        ensure!(yes, "{}: nothing was written", file.display());
        Ok(())
    }
}

/// Reads a table that goes nowhere; says so where it lies beside a face of another table.
pub fn look_at(path: &Path) -> Result<(TableFile, Admitted)> {
    let (file, table) = TableFile::load(path)?;
    if let Err(other) = table_files::agree(path, &table) {
        eprintln!("piezo: careful: {}", remedy::sentence(&other));
    }
    Ok((file, table))
}

/// The checksum of a record as it names a table for people.
pub fn checksum(record: &[u8]) -> String {
    format!("{:08x}", record::checksum(record).unwrap_or(0))
}

/// What a dry run says of a table that fits a board, after what would be refused.
pub fn fits_unwritten(name: &Path, table: &Admitted, identity: &Identity, refused: &[String]) -> String {
    let but = if refused.is_empty() { "" } else { ", but would be refused" };
    format!("{} fits {}{but}; nothing was written", bench::called(name, table), identity.board)
}

/// Says when frames came damaged, which a sound line does not do.
pub fn note_damage(client: &Client) {
    if client.damaged() > 0 {
        eprintln!("piezo: {} frames came damaged: check the cable and its ground", client.damaged());
    }
}

/// Refuses the table in a file where it does not fit a board.
pub fn fits(board: &Interface, table: &Admitted, file: &Path) -> Result<()> {
    table.fits(board).map_err(|misfit| anyhow!("{}", remedy::board(&misfit, table, file)))
}
