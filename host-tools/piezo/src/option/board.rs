//! What is known of the board, as a file that every verb takes.

use anyhow::{Context, Result};
use bench::{BoardFacts, Wiring};
use clap::Args;
use std::path::PathBuf;

/// The board, where it must be known.
#[derive(Args, Clone, Debug)]
pub struct BoardOption {
    /// What the board's converters and wires stand for: a board.toml, as `piezo emulate` writes one.
    #[arg(long, value_name = "FILE")]
    pub board: PathBuf,
}

impl BoardOption {
    /// Everything that a session must know of a board of this tick, µs.
    pub fn wiring(&self, tick_us: u32) -> Result<Wiring> {
        let facts = BoardFacts::read(&self.board)?;
        Wiring::new(&facts, tick_us).with_context(|| self.board.display().to_string())
    }
}
