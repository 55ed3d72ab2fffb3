//! What an HTML page must hold to in a browser: drawn, legible, sound, and complete in one file.
//!
//! [`inspect`] opens a page at a given width and lists what is wrong with it, in sentences. The page needs no help: it
//! is any URL, so that the checks themselves can be tested on pages made to fail them.

mod chromium;
mod layout;
mod page;
mod viewport;

use anyhow::Result;

pub use chromium::{Browser, launch};
pub use page::Page;
pub use viewport::Viewport;

/// Opens `url` at `viewport` and returns the page, that shows so many plots, and everything found wrong with it.
///
/// # Errors
/// The browser failed, not the page.
pub fn inspect<'b>(
    browser: &'b mut Browser,
    url: &str,
    viewport: Viewport,
    plots: usize,
) -> Result<(Page<'b>, Vec<String>)> {
    let mut page = Page::open(browser, url, viewport)?;
    let faults = page.faults(viewport, plots)?;
    Ok((page, faults))
}
