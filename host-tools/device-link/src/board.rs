//! What a device asks of a table.

use estimator_core::record::VERSION;
use estimator_core::table::Interface;
use protocol::Identity;

/// The firmware reads another format of records than this program writes.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error(
    "the firmware reads tables of format {found}, this program writes format {VERSION}: build both from the same sources"
)]
pub struct OtherFormat {
    /// The version that the firmware has.
    pub found: u16,
}

/// The tick and the converters that a table for this device must have.
///
/// # Errors
/// The device reads another format of records.
pub fn of(identity: &Identity) -> Result<Interface, OtherFormat> {
    match identity.record_version {
        VERSION => Ok(identity.board_interface()),
        found => Err(OtherFormat { found }),
    }
}
