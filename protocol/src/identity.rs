//! Who the device is.

use crate::text::{Reason, Text};
use crate::uid::Uid;
use estimator_core::table::Interface;
use serde::{Deserialize, Serialize};

/// Where the table in use comes from.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub enum TableSource {
    /// The newest record of the parameter store, which a host pushed.
    Stored,
    /// The firmware image, because the store had none that could be used.
    Compiled {
        /// Why the stored table is not used.
        reason: Reason,
    },
    /// Neither had one that could be used.
    None {
        /// Why the stored table is not used.
        stored: Reason,
        /// Why the image's table is not used either.
        compiled: Reason,
    },
}

/// What does not change while a device runs: board, image, converters, and which table it took at its start.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Identity {
    /// Name of the board that the image is built for, such as `nucleo-g474re`.
    pub board: Text<24>,
    /// Which of these boards, where its chip says so.
    pub uid: Option<Uid>,
    /// Version of the firmware's crate, `major.minor.patch`.
    pub firmware: Text<16>,
    /// The commit it was built from; with a mark when the sources had been changed.
    pub git: Text<24>,
    /// The table record's format version that it reads ([`estimator_core::record::VERSION`]).
    pub record_version: u16,
    /// From one tick to the next, µs.
    pub tick_us: u32,
    /// The ADC's largest code, oversampling included; a table must be made for it.
    pub adc_full_scale: u16,
    /// The DAC's largest code; a table must be made for it.
    pub dac_full_scale: u16,
    /// Where the table in use comes from.
    pub source: TableSource,
    /// The model of the table in use, as it prints itself; empty without one.
    pub model: Text<32>,
    /// The checksum of the table's record ([`estimator_core::record::checksum`]); 0 without one.
    pub table_crc: u32,
}

impl Identity {
    /// What the device asks of a table.
    pub fn board_interface(&self) -> Interface {
        let &Self { tick_us, adc_full_scale, dac_full_scale, .. } = self;
        Interface { tick_us, adc_full_scale, dac_full_scale }
    }
}
