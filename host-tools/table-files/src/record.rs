//! The binary face of a table.

use estimator_core::Admitted;
use estimator_core::record::MAX_LENGTH;

/// The binary record of a table.
pub fn record(table: &Admitted) -> Vec<u8> {
    let mut buffer = [0; MAX_LENGTH];
    let length = table.encode(&mut buffer).expect("MAX_LENGTH suffices for every table");
    buffer[..length].to_vec()
}
