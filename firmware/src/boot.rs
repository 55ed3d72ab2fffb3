//! Which table the estimator runs: the newest stored one, else the compiled one, else none; and why.

use crate::peripherals::{Converters, TICK_HZ};
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::{Admitted, Table};
use parameter_store::ParameterStore;
use protocol::{TableSource, Text, text};

/// Tick, µs.
pub const TICK_US: u32 = 1_000_000 / TICK_HZ;

/// The table to run.
pub struct Chosen {
    /// The table, if any could be used.
    pub table: Option<Admitted>,
    /// Where it comes from, and why.
    pub source: TableSource,
    /// Something was stored that could not be used.
    pub fallback: bool,
}

/// Looks for a table, best first.
pub async fn choose<F: NorFlash>(store: &mut ParameterStore<F>, compiled: Table, converters: Converters) -> Chosen {
    let (reason, fallback) = match store.load().await {
        Ok(Some(record)) => match parse(record, converters) {
            Ok(table) => return Chosen { table: Some(table), source: TableSource::Stored, fallback: false },
            Err(reason) => (text(format_args!("the stored table is refused: {reason}")), true),
        },
        Ok(None) => (text("no table is stored"), false),
        Err(error) => (text(error), true),
    };
    match compiled.admit().map_err(text).and_then(|table| fits(table, converters)) {
        Ok(table) => Chosen { table: Some(table), source: TableSource::Compiled { reason }, fallback },
        Err(compiled) => Chosen { table: None, source: TableSource::None { stored: reason, compiled }, fallback },
    }
}

/// Reads a record and checks that this board can run it.
pub fn parse(record: &[u8], converters: Converters) -> Result<Admitted, Text<120>> {
    fits(Table::parse(record).map_err(text)?, converters)
}

/// A table made for other converters or another tick would give a number, and a wrong one.
fn fits(table: Admitted, converters: Converters) -> Result<Admitted, Text<120>> {
    let Converters { adc_full_scale, dac_full_scale } = converters;
    if table.sample_period_us != TICK_US {
        Err(text(format_args!("it is for a tick of {} us, this board's is {TICK_US}", table.sample_period_us)))
    } else if table.adc.full_scale != adc_full_scale {
        let theirs = table.adc.full_scale;
        Err(text(format_args!("it is for an ADC up to {theirs}: `piezo emit --adc-full-scale {adc_full_scale}`")))
    } else if table.dac.full_scale != dac_full_scale {
        let theirs = table.dac.full_scale;
        Err(text(format_args!("it is for a DAC up to {theirs}: `piezo emit --dac-full-scale {dac_full_scale}`")))
    } else {
        Ok(table)
    }
}
