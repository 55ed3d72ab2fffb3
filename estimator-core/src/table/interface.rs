//! Whether a table is for a board: a table made for other converters or another tick gives a number, and a wrong one.

use super::{ALLOWED_PERCENT, Cycles, Table};
use core::fmt;

/// What a board asks of a table: its tick and the scales of its converters, which a table is made for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Interface {
    /// From one tick to the next, µs.
    pub tick_us: u32,
    /// The ADC's largest code, oversampling included.
    pub adc_full_scale: u16,
    /// The DAC's largest code, 4095 for 12 bits.
    pub dac_full_scale: u16,
}

/// Why a table is not for a board.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum Misfit {
    /// The table is made for another tick: every coefficient in it would be off.
    #[error("made for a tick of {table_us} µs, not {board_us} µs")]
    Tick {
        /// Tick that the table is made for, µs.
        table_us: u32,
        /// Tick of the board's image, µs.
        board_us: u32,
    },
    /// The ADC's largest codes differ, or the DAC's, or both.
    #[error(fmt = converters)]
    Converters {
        /// What the table is made for.
        table: Interface,
        /// Largest codes that the board's converters have.
        board: Interface,
    },
    /// The tick takes too much of its time.
    #[error(fmt = too_long)]
    Cycles {
        /// What it takes, and has.
        cycles: Cycles,
        /// It drives the amplifier, and so searches a voltage.
        drives: bool,
    },
}

impl Table {
    /// Whether this table is for that board.
    ///
    /// # Errors
    /// It is made for another tick or other converters, or its tick takes too long.
    pub fn fits(&self, board: &Interface) -> Result<(), Misfit> {
        let table = Interface {
            tick_us: self.sample_period_us,
            adc_full_scale: self.adc.full_scale,
            dac_full_scale: self.dac.full_scale,
        };
        if table.tick_us != board.tick_us {
            Err(Misfit::Tick { table_us: table.tick_us, board_us: board.tick_us })
        } else if table != *board {
            Err(Misfit::Converters { table, board: *board })
        } else {
            self.in_time()
        }
    }

    /// Whether its tick is done in time.
    ///
    /// # Errors
    /// It takes more than [`ALLOWED_PERCENT`] of its time.
    pub fn in_time(&self) -> Result<(), Misfit> {
        let cycles = self.cycles();
        if cycles.in_time() { Ok(()) } else { Err(Misfit::Cycles { cycles, drives: self.drive.is_some() }) }
    }
}

/// How long it takes. It ends a sentence that begins with the table, and a device's message has to hold it.
fn too_long(cycles: &Cycles, drives: &bool, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (what, percent) = (if *drives { "driving" } else { "estimating" }, cycles.percent());
    write!(
        f,
        "{what} takes up to {} cycles a tick, {percent:.0} % of its time, not {ALLOWED_PERCENT} % at most",
        cycles.most
    )
}

/// Which converters differ, and how.
fn converters(table: &Interface, board: &Interface, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (adc, dac) = (table.adc_full_scale, table.dac_full_scale);
    let (adc_differs, dac_differs) = (adc != board.adc_full_scale, dac != board.dac_full_scale);
    write!(f, "made for ")?;
    if adc_differs {
        write!(f, "an ADC up to {adc}, not {}", board.adc_full_scale)?;
    }
    if adc_differs && dac_differs {
        write!(f, ", and ")?;
    }
    if dac_differs {
        write!(f, "a DAC up to {dac}, not {}", board.dac_full_scale)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_board_that_a_table_is_made_for_is_fitted_and_the_rest_is_named() {
        let record = include_bytes!("../../../tests/data/table/table.bin");
        let table = Table::parse(record).unwrap();
        let board = Interface { tick_us: 500, adc_full_scale: 4095, dac_full_scale: 4095 };
        assert_eq!(table.fits(&board), Ok(()));
        let said = |board: Interface| table.fits(&board).unwrap_err().to_string();
        assert_eq!(said(Interface { tick_us: 100, ..board }), "made for a tick of 500 µs, not 100 µs");
        assert_eq!(said(Interface { adc_full_scale: 65_520, ..board }), "made for an ADC up to 4095, not 65520");
        assert_eq!(said(Interface { dac_full_scale: 1023, ..board }), "made for a DAC up to 4095, not 1023");
        assert_eq!(
            said(Interface { adc_full_scale: 65_520, dac_full_scale: 1023, ..board }),
            "made for an ADC up to 4095, not 65520, and a DAC up to 4095, not 1023"
        );
        let hurried = Table { sample_period_us: 10, ..*table };
        let cycles = hurried.cycles();
        assert_eq!(hurried.in_time(), Err(Misfit::Cycles { cycles, drives: false }));
        // What differs first in the order of remedies is what is said.
        assert!(matches!(
            table.fits(&Interface { tick_us: 100, adc_full_scale: 1, ..board }),
            Err(Misfit::Tick { .. })
        ));
    }
}
