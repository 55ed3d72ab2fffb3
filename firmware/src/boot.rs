//! Which table the estimator runs: the newest stored one, else the compiled one, else none; and why. A device that has
//! failed again and again leaves the store alone, and so does one whose flash cannot hold it.
//!
//! The released image's table is the demonstration's: that of another actuator than the board's, unless the board is
//! emulated. It is for trials, and its use is a fault ([`Faults::DEMONSTRATION`]).

use crate::compiled::is_demonstration;
use crate::facts::Facts;
use crate::restarts::Restarts;
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::record::MAX_LENGTH;
use estimator_core::table::Interface;
use estimator_core::{Admitted, Table};
use parameter_store::{MAX_RECORD, ParameterStore};
use protocol::{Faults, Reason, TableSource, text};

// What is admitted can be stored.
const _: () = assert!(MAX_LENGTH <= MAX_RECORD);

/// The table to run.
pub struct Chosen {
    /// The table, if any could be used.
    pub table: Option<Admitted>,
    /// Where it comes from, and why.
    pub source: TableSource,
    /// Why it may be another actuator's than the one that the board is wired to: [`Faults::TABLE_FALLBACK`], where
    /// something was stored that could not be used, or nobody has looked; [`Faults::DEMONSTRATION`], where nothing was.
    pub doubts: Faults,
}

/// Looks for a table, best first.
pub async fn choose<F: NorFlash>(store: &mut ParameterStore<F>, compiled: Table, facts: &Facts) -> Chosen {
    let (board, restarts) = (&facts.interface, facts.restarts);
    let (reason, fallback) = if restarts.too_many() {
        let Restarts { count, .. } = restarts;
        (text(format_args!("it failed {count} times in a row, so that the store is not read before a reset")), true)
    } else if let Some(reason) = facts.no_store {
        (text(reason), true)
    } else {
        match store.load().await {
            Ok(Some(record)) => match parse(record, board) {
                Ok(table) => {
                    return Chosen { table: Some(table), source: TableSource::Stored, doubts: Faults::empty() };
                }
                Err(reason) => (text(format_args!("the stored table is refused: {reason}")), true),
            },
            Ok(None) => (text("no table is stored"), false),
            Err(error) => (text(error), true),
        }
    };
    let doubts = match fallback {
        true => Faults::TABLE_FALLBACK,
        false if is_demonstration(&compiled) && !facts.emulated => Faults::DEMONSTRATION,
        false => Faults::empty(),
    };
    match compiled.admit().map_err(text).and_then(|table| fits(table, board)) {
        Ok(table) => Chosen { table: Some(table), source: TableSource::Compiled { reason }, doubts },
        Err(compiled) => {
            let source = TableSource::None { stored: reason, compiled };
            Chosen { table: None, source, doubts: doubts & Faults::TABLE_FALLBACK }
        }
    }
}

/// Reads a record and checks that this board can run it; the reason is the end of a sentence that
/// starts with "refused".
pub fn parse(record: &[u8], board: &Interface) -> Result<Admitted, Reason> {
    fits(Table::parse(record).map_err(text)?, board)
}

fn fits(table: Admitted, board: &Interface) -> Result<Admitted, Reason> {
    table.fits(board).map_err(text)?;
    Ok(table)
}
