//! What draws a whole log to zoom into, of the numbers that stand in its link ([`super::whole`]): [`uplot`], and a
//! script of ours.

use std::sync::LazyLock;

/// For the end of a page that has `templates/zoom.html`.
pub static SCRIPT: LazyLock<String> =
    LazyLock::new(|| [uplot::SCRIPT, "<script>\n", include_str!("../templates/zoom.js"), "</script>\n"].concat());
