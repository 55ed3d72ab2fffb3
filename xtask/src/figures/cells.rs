//! From what a command prints, as JSON, to the cells of a document's table.

use anyhow::{Context, Result};
use serde_json::Value;

use super::document::{Content, Table};

/// A table of rows, of whose cells so many name a row.
pub fn table(keys: usize, columns: &[&str], rows: impl Iterator<Item = Result<Vec<String>>>) -> Result<Content> {
    let columns = columns.iter().map(|&column| column.to_owned()).collect();
    Ok(Content::Table(Table { keys, columns, rows: rows.collect::<Result<_>>()? }))
}

/// The array at a place of what a command prints.
pub fn array<'v>(value: &'v Value, pointer: &str) -> Result<&'v Vec<Value>> {
    value.pointer(pointer).and_then(Value::as_array).with_context(|| format!("no array at {pointer:?} of the JSON"))
}

/// The number at a place of what a command prints.
pub fn number(value: &Value, pointer: &str) -> Result<f64> {
    value.pointer(pointer).and_then(Value::as_f64).with_context(|| format!("no number at {pointer} of the JSON"))
}

/// The whole number at a place of what a command prints.
pub fn whole(value: &Value, pointer: &str) -> Result<u64> {
    value.pointer(pointer).and_then(Value::as_u64).with_context(|| format!("no whole number at {pointer} of the JSON"))
}

/// With so many digits behind the point.
pub fn fixed(number: f64, digits: usize) -> String {
    format!("{number:.digits$}")
}

/// With commas between thousands.
pub fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let groups = digits.as_bytes().rchunks(3).rev().map(|group| group.iter().map(|&digit| char::from(digit)).collect());
    groups.collect::<Vec<String>>().join(",")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_are_set_apart() {
        assert_eq!([0, 352, 1000, 85_000, 1_234_567].map(thousands), ["0", "352", "1,000", "85,000", "1,234,567"]);
    }
}
