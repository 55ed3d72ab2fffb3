//! Makes HTML of the book: `cargo run --manifest-path book/html/Cargo.toml`, from the repository's root. It writes to
//! target/book, and ends with 1 where mdBook warns of anything.

use std::{
    io::{self, Write},
    path::Path,
    sync::{Arc, Mutex},
};

use anyhow::{Context, Result, ensure};
use mdbook_driver::{MDBook, book::BookItem};

/// What mdBook warns of, which would otherwise scroll by.
#[derive(Clone, Default)]
struct Warnings(Arc<Mutex<Vec<u8>>>);

impl Write for Warnings {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        self.0.lock().map_err(|_| io::Error::other("a writer panicked"))?.write(text)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn main() -> Result<()> {
    let (warnings, root) = (Warnings::default(), Path::new(env!("CARGO_MANIFEST_DIR")).parent().context("no book")?);
    let writer = warnings.clone();
    tracing_subscriber::fmt()
        .with_max_level(tracing_subscriber::filter::LevelFilter::WARN)
        .with_ansi(false)
        .without_time()
        .with_writer(move || writer.clone())
        .init();
    let book = MDBook::load(root)?;
    book.build()?;
    let warnings = warnings.0.lock().map(|text| String::from_utf8_lossy(&text).into_owned()).unwrap_or_default();
    ensure!(warnings.is_empty(), "mdBook warns:\n{warnings}");
    let pages = book.iter().filter(|item| matches!(item, BookItem::Chapter(chapter) if !chapter.is_draft_chapter()));
    println!("{} chapters: {}", pages.count(), book.build_dir_for("html").join("index.html").display());
    Ok(())
}
