//! Numbers in words.

/// A count and what is counted, in the plural but for one.
pub fn counted(count: u32, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// A number of four significant digits.
pub fn short(x: f64) -> String {
    let text = format!("{x:.3e}");
    match text.parse::<f64>() {
        Ok(x) if x == 0.0 || (1e-4..1e6).contains(&x.abs()) => format!("{x}"),
        _ => text,
    }
}
