//! The screen a page is shown on.

/// The screen a page is shown on.
#[derive(Debug, Clone, Copy)]
pub struct Viewport {
    /// Width, CSS px.
    pub width: u32,
    /// Height, CSS px.
    pub height: u32,
    /// Device pixels in a CSS px.
    pub scale: f64,
    /// Whether the page is laid out as on a telephone, where it must ask for the screen's own width.
    pub mobile: bool,
    /// The least legible size of text on it, CSS px.
    pub least_text: f64,
}
