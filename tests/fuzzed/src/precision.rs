//! A table of every model, any codes: an `f32` says what an `f64` says, nearly as
//! `estimator-core/tests/library/precision.rs` has it of its own sequences.

use estimator_core::{AdcCalibration, AdcCode, Admitted, Estimator, Model, Range, Status, Table};
use std::path::Path;
use std::sync::OnceLock;
use table_files::TableFile;

/// The most that they differ by, of the span of the displacement limits: twice what those sequences may come to, since
/// the fuzzer has found 2.01e-6 with an enhanced table.
const STATED: f64 = 4e-6;
/// The same of NARX: what is rounded lasts for some 1/(1 − ρ) ticks, and ρ is 0.993 of the table here.
const STATED_OF_NARX: f64 = 2e-5;
/// Ticks for which that is stated.
const TICKS: usize = 1_500;

/// The tables that `identify` has made of a measured log, one of each model.
pub fn tables() -> &'static [Table] {
    static TABLES: OnceLock<Vec<Table>> = OnceLock::new();
    TABLES.get_or_init(|| {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data/table/models");
        let files = std::fs::read_dir(folder).expect("the repository has a table of every model");
        let mut paths: Vec<_> = files.map(|file| file.expect("it can be listed").path()).collect();
        paths.sort();
        paths.iter().map(|path| *TableFile::load(path).expect("it is admitted").1).collect()
    })
}

/// Four bytes choose a table, its converter and its deadband; two each make a code.
///
/// # Panics
/// The two precisions part, or one says of a tick what the other does not.
pub fn check(bytes: &[u8]) {
    let Some((&[model, converter, gain, offset], codes)) = bytes.split_first_chunk() else { return };
    let Some(table) = table(model, converter, gain, offset) else { return };
    let full_scale = table.adc.full_scale;
    let stated = if table.model() == Model::Narx { STATED_OF_NARX } else { STATED };
    let span = f64::from(table.displacement_limits_um.span());
    let (mut single, mut double) = (Estimator::<f32>::new(&table), Estimator::<f64>::new(&table));
    let mut code = full_scale / 2;
    for &[low, high] in codes.as_chunks().0.iter().take(TICKS) {
        let word = u16::from_le_bytes([low, high]);
        // A step of a few codes from the last one, or any code: deadbands decide by the former.
        code = if low % 2 == 1 {
            code.saturating_add_signed(i16::from(high as i8)).min(full_scale)
        } else if full_scale == 4095 {
            word >> 4
        } else {
            word.min(full_scale)
        };
        let (one, other) = (single.tick(AdcCode(code)), double.tick(AdcCode(code)));
        // Where the DAC's last code begins, and whether a resonance swings to the limits, is the rounding's.
        let said = |status: Status| status.difference(Status::DAC_SATURATED | Status::CLAMPED);
        assert_eq!(said(one.status), said(other.status), "{}", table.model());
        assert!(table.rings().is_some() || !one.status.contains(Status::CLAMPED), "{}: clamped", table.model());
        let apart = (f64::from(one.displacement) - other.displacement).abs() / span;
        assert!(apart <= stated, "{}: {apart} of the span apart", table.model());
    }
}

/// A table, its ADC over a little more than its range and its deadband just a whole number of codes.
fn table(model: u8, converter: u8, gain: u8, offset: u8) -> Option<Admitted> {
    let base = tables()[usize::from(model) % tables().len()];
    let Range { min, max } = base.voltage_range_v;
    let (min, max) = (min + base.voltage_zero_v, max + base.voltage_zero_v);
    let full_scale = if converter & 1 == 0 { 4095 } else { 65_520 };
    let part = |byte: u8| f32::from(byte) / 255.0;
    let gain_v_per_code = (max - min) * (1.01 + 0.3 * part(gain)) / f32::from(full_scale);
    let aside = 0.01 * part(offset) * (max - min);
    let invert = converter & 2 != 0;
    let offset_v = if invert { max + aside } else { min - aside };
    let adc = AdcCalibration { gain_v_per_code, offset_v, invert, full_scale };
    let deadband_v = if converter & 4 == 0 { base.deadband_v } else { gain_v_per_code * f32::from(converter >> 5) };
    Table { adc, deadband_v, drive: None, ..base }.admit().ok()
}
