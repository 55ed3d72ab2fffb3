//! A parameter table as it goes over the link, and the one that a device runs.

use crate::client::Client;
use crate::error::LinkError;
use estimator_core::record::MAX_LENGTH;
use estimator_core::{Admitted, Table, TableError};
use protocol::{Record, Refusal};

/// The device runs no table that can be read here.
#[derive(Debug, thiserror::Error)]
pub enum RunningTableError {
    /// The link fails.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The device has no table to run.
    #[error("the device has no table to estimate with")]
    None,
    /// Its table is of another format, or damaged.
    #[error("the device's table is refused here")]
    Refused(#[from] TableError),
}

/// The record of a table as it goes over the link.
pub fn to_record(table: &Admitted) -> Record {
    let mut buffer = [0; MAX_LENGTH];
    // Cannot fail: the buffer and `Record` are as long as the longest record.
    let length = table.encode(&mut buffer).expect("MAX_LENGTH suffices for every table");
    Record::from_slice(&buffer[..length]).expect("both ends have the same longest record")
}

/// The record of the table in use; `None` where there is none.
///
/// # Errors
/// The link fails.
pub fn in_use(client: &mut Client) -> Result<Option<Record>, LinkError> {
    match client.pull() {
        Ok(record) => Ok(Some(record)),
        Err(LinkError::Refused { refusal, .. }) if *refusal == Refusal::NoTable => Ok(None),
        Err(error) => Err(error),
    }
}

/// The table in use.
///
/// # Errors
/// The link fails, there is no table, or it cannot be read.
pub fn running(client: &mut Client) -> Result<Admitted, RunningTableError> {
    let record = in_use(client)?.ok_or(RunningTableError::None)?;
    Ok(Table::parse(&record)?)
}
