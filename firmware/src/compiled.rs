//! The table of the image at the image's rate.

use crate::rate::TICK_US;
use estimator_core::Table;

/// The table that is used where none is stored.
pub const TABLE: Table = match crate::table::TABLE.at_tick(TICK_US) {
    Ok(table) => table,
    Err(_) => {
        panic!("the model of firmware/src/table.rs is bound to another tick: have it identified at that of TICK_HZ")
    }
};
