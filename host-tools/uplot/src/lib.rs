//! [uPlot](https://github.com/leeoniya/uPlot) 1.6.32, MIT, by Leon Sorokin: what a page that loads nothing has in
//! itself of it.

/// For a `style` element.
pub const STYLE: &str = include_str!("../uPlot.min.css");

/// A comment with its licence, and the script that defines `uPlot`; for a body.
pub const SCRIPT: &str = concat!(
    "<!--\nThe plots are uPlot's, https://github.com/leeoniya/uPlot\n\n",
    include_str!("../LICENSE"),
    "-->\n<script>\n",
    include_str!("../uPlot.iife.min.js"),
    "\n</script>\n",
);
