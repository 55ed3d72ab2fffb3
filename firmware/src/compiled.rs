//! The table of the image at the image's rate: the one of firmware/src/table.rs, which is the demonstration's until its
//! user puts another there (`piezo emit --face rust`).

use crate::rate::TICK_US;
use estimator_core::{Digest, Table};

/// The logs that the demonstration's table is made from: of one actuator, which is nobody else's.
const DEMONSTRATION: Digest = Digest([0x63, 0xf1, 0x5b, 0x78, 0xb7, 0xa0, 0x97, 0xe3]);

/// The table that is used where none is stored.
pub const TABLE: Table = match crate::table::TABLE.at_tick(TICK_US) {
    Ok(table) => table,
    Err(_) => {
        panic!("the model of firmware/src/table.rs is bound to another tick: have it identified at that of TICK_HZ")
    }
};

/// Whether a table is the demonstration's, whatever its calibration.
pub fn is_demonstration(table: &Table) -> bool {
    table.provenance.logs == DEMONSTRATION
}
