//! What a converter's ends stand for.

/// What code 0 and what the full-scale code stand for.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Span {
    /// At code 0.
    pub zero: f64,
    /// At full scale.
    pub full: f64,
}
