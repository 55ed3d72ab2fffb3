//! What the verbs that talk to a device have in common.

use anyhow::{Context, Result, anyhow, bail, ensure};
use device_link::table::to_record;
use device_link::{Address, Client};
use estimator_core::table::Board;
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

/// Says a table's doubts before it goes to a board, and on a terminal asks whether it is to; where nobody can be asked, it goes only if
/// that was said. Returns why it would not, where it does not go in any case.
pub fn doubted(file: &Path, doubts: &[String], may: bool, dry_run: bool) -> Result<Option<String>> {
    doubts.iter().for_each(|doubt| eprintln!("piezo: careful: {}: {doubt}", file.display()));
    if doubts.is_empty() || may {
        return Ok(None);
    }
    let terminal = stdin().is_terminal() && stderr().is_terminal();
    let refusal = format!(
        "{}: has doubts, which stand above, and nobody can be asked: mend what they name, or write it all the same with --doubted",
        file.display()
    );
    if dry_run {
        return Ok(Some(refusal).filter(|_| !terminal));
    }
    ensure!(terminal, refusal);
    eprint!("Does it go to the board all the same? [y/N] ");
    let mut answer = String::new();
    stdin().read_line(&mut answer).context("standard input")?;
    let yes = ["y", "yes"].contains(&answer.trim().to_lowercase().as_str());
    ensure!(yes, "{}: nothing was written", file.display());
    Ok(None)
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
    format!("{} fits {}{but}; nothing was written", called(name, table), identity.board)
}

/// A table as a sentence names it: by its file, its model, and its checksum.
pub fn called(name: &Path, table: &Admitted) -> String {
    let own = checksum(&to_record(table));
    let from = bench::made_from(name).map(|record| checksum(&record)).filter(|from| *from != own);
    let from = from.map_or(String::new(), |from| format!(" as calibrated for this board; made from {from}"));
    let (name, title, checksum) = (name.display(), bench::title(table), own + &from);
    match bench::is_line(table) {
        true => format!("{name} (checksum {checksum})"),
        false => format!("{name} ({title}, checksum {checksum})"),
    }
}

/// Says when frames came damaged, which a sound line does not do.
pub fn note_damage(client: &Client) {
    if client.damaged() > 0 {
        eprintln!("piezo: {} frames came damaged: check the cable and its ground", client.damaged());
    }
}

/// Refuses the table in a file where it does not fit a board.
pub fn fits(board: &Board, table: &Admitted, file: &Path) -> Result<()> {
    table.fits(board).map_err(|misfit| anyhow!("{}", remedy::board(&misfit, table, file)))
}
