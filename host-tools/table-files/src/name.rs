//! What a table is called.

use crate::record::record;
use estimator_core::{Admitted, record::checksum};

/// The checksum of a table's record, as it names the table for people.
pub fn name(table: &Admitted) -> String {
    format!("{:08x}", checksum(&record(table)).unwrap_or_default())
}
