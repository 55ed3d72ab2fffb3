//! A span of two ends, as options have it.

use identification::span::*;

#[test]
fn nonsense_is_refused() {
    for text in ["", "1", "1:1", "1:x", "nan:1", "1:inf"] {
        assert!(text.parse::<Span>().is_err(), "{text}");
    }
}
