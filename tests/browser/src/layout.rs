//! The measured page, and what is required of it.

use serde::Deserialize;

use crate::viewport::Viewport;

/// Rounding of the browser's layout, CSS px.
const TOLERANCE: f64 = 1.0;

/// What `layout.js` found. Lengths in CSS px.
#[derive(Debug, Deserialize)]
pub(crate) struct Layout {
    title: String,
    width: f64,
    scroll_width: f64,
    plots: Vec<Plot>,
    texts: Vec<Text>,
}

#[derive(Debug, Deserialize)]
struct Plot {
    #[serde(rename = "box")]
    extent: Extent,
    /// Curves that leave a trace; of a canvas its coloured pixels.
    marks: usize,
}

#[derive(Debug, Deserialize)]
struct Text {
    text: String,
    size: f64,
    #[serde(rename = "box")]
    extent: Extent,
    /// The drawing it is part of.
    plot: Option<Extent>,
}

#[derive(Debug, Clone, Copy, Deserialize)]
struct Extent {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Extent {
    fn is_within(&self, outer: &Self) -> bool {
        self.left >= outer.left - TOLERANCE
            && self.right <= outer.right + TOLERANCE
            && self.top >= outer.top - TOLERANCE
            && self.bottom <= outer.bottom + TOLERANCE
    }
}

impl Layout {
    /// What is wrong with the page on this screen, that shows so many plots.
    pub(crate) fn faults(&self, viewport: Viewport, plots: usize) -> Vec<String> {
        let mut faults = Vec::new();
        if self.title.trim().is_empty() {
            faults.push("no title".to_owned());
        }
        if self.width != f64::from(viewport.width) {
            faults.push(format!(
                "laid out {} px wide on a screen of {}: <meta name=\"viewport\" content=\"width=device-width\"> is missing",
                self.width, viewport.width
            ));
        }
        if self.scroll_width > self.width {
            faults.push(format!("scrolls sideways: {} px wide on a screen of {}", self.scroll_width, self.width));
        }
        if self.plots.len() != plots {
            faults.push(format!("{} plots instead of {plots}", self.plots.len()));
        }
        for (number, plot) in (1..).zip(&self.plots) {
            faults.extend(plot.faults(self.width).into_iter().map(|fault| format!("plot {number} {fault}")));
        }
        for text in &self.texts {
            faults.extend(text.faults(viewport).into_iter().map(|fault| format!("text {:?} {fault}", text.text)));
        }
        faults
    }
}

impl Plot {
    fn faults(&self, width: f64) -> Vec<String> {
        let Extent { left, right, top, bottom } = self.extent;
        let mut faults = Vec::new();
        if right <= left || bottom <= top {
            faults.push(format!("has no size: {} px by {}", right - left, bottom - top));
        }
        if left < -TOLERANCE || right > width + TOLERANCE {
            faults.push(format!("reaches from {left} to {right} px, beyond the screen's {width}"));
        }
        if self.marks == 0 {
            faults.push("has no curve".to_owned());
        }
        faults
    }
}

impl Text {
    fn faults(&self, viewport: Viewport) -> Vec<String> {
        let mut faults = Vec::new();
        if self.size < viewport.least_text {
            faults.push(format!("is {:.1} px high, less than {}", self.size, viewport.least_text));
        }
        if self.plot.is_some_and(|plot| !self.extent.is_within(&plot)) {
            faults.push("is cut off by the edge of its plot".to_owned());
        }
        faults
    }
}
