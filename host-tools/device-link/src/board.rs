//! Whether a table fits a board.

use estimator_core::Admitted;
use estimator_core::record::VERSION;
use protocol::Identity;

/// What a board needs of a table.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Board {
    /// Tick, µs.
    pub tick_us: u32,
    /// The ADC's largest code.
    pub adc_full_scale: u16,
    /// The DAC's largest code.
    pub dac_full_scale: u16,
}

/// Why a table does not fit a board: it would give a number, and a wrong one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum BoardError {
    /// The firmware reads another format of records.
    #[error(
        "the firmware reads tables of format {found}, this program writes format {VERSION}: build both from the same \
         sources"
    )]
    Format {
        /// The firmware's.
        found: u16,
    },
    /// The table is for another tick.
    #[error("is for a tick of {table_us} µs, the board's is {board_us} µs")]
    Tick {
        /// The table's tick, µs.
        table_us: u32,
        /// The board's tick, µs.
        board_us: u32,
    },
    /// The table is for other converters.
    #[error("is for {}", differ(*.adc, *.dac))]
    Converters {
        /// Largest ADC codes where they differ.
        adc: Option<FullScales>,
        /// Largest DAC codes where they differ.
        dac: Option<FullScales>,
    },
}

/// The largest code of a converter.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FullScales {
    /// By the table.
    pub table: u16,
    /// On the board.
    pub board: u16,
}

fn differ(adc: Option<FullScales>, dac: Option<FullScales>) -> String {
    let converters = [("an ADC", adc), ("a DAC", dac)].into_iter();
    let wrong = converters.filter_map(|(converter, scales)| scales.map(|scales| (converter, scales)));
    let words = wrong.map(|(converter, FullScales { table, board })| format!("{converter} up to {table}, not {board}"));
    words.collect::<Vec<_>>().join(" and ")
}

impl Board {
    /// What the device needs.
    ///
    /// # Errors
    /// It reads another format of records.
    pub fn of(identity: &Identity) -> Result<Self, BoardError> {
        let &Identity { tick_us, adc_full_scale, dac_full_scale, record_version: found, .. } = identity;
        if found != VERSION {
            return Err(BoardError::Format { found });
        }
        Ok(Self { tick_us, adc_full_scale, dac_full_scale })
    }

    /// Refuses a table made for other converters or another tick.
    ///
    /// # Errors
    /// What does not fit.
    pub fn check(&self, table: &Admitted) -> Result<(), BoardError> {
        if table.sample_period_us != self.tick_us {
            return Err(BoardError::Tick { table_us: table.sample_period_us, board_us: self.tick_us });
        }
        let differ = |table: u16, board: u16| (table != board).then_some(FullScales { table, board });
        let adc = differ(table.adc.full_scale, self.adc_full_scale);
        let dac = differ(table.dac.full_scale, self.dac_full_scale);
        if adc.is_some() || dac.is_some() { Err(BoardError::Converters { adc, dac }) } else { Ok(()) }
    }
}
