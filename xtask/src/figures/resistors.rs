//! The tables of resistors around the board, as `piezo divider` chooses them.

use anyhow::{Context, Result};
use serde_json::Value;

use super::{
    cells::{array, fixed, number, table},
    document::Content,
};

/// The ends of each amplifier's monitor and input that the documents show, V.
pub const ENDS: [&str; 3] = ["-10:10", "-5:5", "0:10"];

/// Dividers before the board's inputs, and the voltages of the source that the codes' ends stand for.
pub fn dividers(printed: &Value) -> Result<Content> {
    rows(&printed["monitor"], ["r1", "r2", "r3"], "/codes_v", &["R1", "R2", "R3", "codes 0 … 65,520 are"])
}

/// Stages behind the board's output, and the voltages of the amplifier's input that the pin's ends stand for.
pub fn stages(printed: &Value) -> Result<Content> {
    rows(&printed["input"], ["rf", "rg", "ro"], "/output_v", &["RF", "RG", "RO", "A2 at 0 … 3.3 V is, at the input"])
}

fn rows(printed: &Value, names: [&str; 3], span: &str, columns: &[&str]) -> Result<Content> {
    // As the text around writes it.
    let signed = |text: String| text.replace('-', "−");
    let row = |found: &Value| -> Result<Vec<String>> {
        let ends = found["ends"].as_str().context("a row names no ends")?.replace(':', " … ");
        let resistors = found.pointer("/found/resistors_ohm").context("a row has no resistors")?;
        let ohms = names.map(|name| match resistors[name].as_f64() {
            Some(ohms) => format!("{} kΩ", ohms / 1e3),
            None => "–".to_owned(),
        });
        let end = |end: u8| number(&found["found"], &format!("{span}/{end}")).map(|volts| fixed(volts, 2));
        let (ends, span) = (signed(format!("{ends} V")), signed(format!("{} … {} V", end(0)?, end(1)?)));
        Ok([vec![ends], ohms.to_vec(), vec![span]].concat())
    };
    table(1, columns, array(printed, "")?.iter().map(row))
}
