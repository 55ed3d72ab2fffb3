//! A parameter table as it goes over the link.

use estimator_core::Admitted;
use estimator_core::record::MAX_LENGTH;
use protocol::Record;

/// The record of a table as it goes over the link.
pub fn to_record(table: &Admitted) -> Record {
    let mut buffer = [0; MAX_LENGTH];
    // Cannot fail: the buffer and `Record` are as long as the longest record.
    let length = table.encode(&mut buffer).expect("MAX_LENGTH suffices for every table");
    Record::from_slice(&buffer[..length]).expect("both ends have the same longest record")
}
