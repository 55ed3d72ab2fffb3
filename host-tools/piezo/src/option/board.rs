//! What is known of the board, as a file that every verb takes.

use anyhow::{Context, Result};
use bench::{BoardFacts, Wiring};
use clap::Args;
use protocol::Identity;
use std::path::PathBuf;

/// The board, where it must be known.
#[derive(Args, Clone, Debug)]
pub struct BoardOption {
    /// What the board's converters and wires stand for: a board.toml, as `piezo emulate` writes one.
    #[arg(long, value_name = "FILE")]
    pub board: PathBuf,
    /// Take the file although it was measured on another board.
    #[arg(long)]
    pub another_board: bool,
}

impl BoardOption {
    /// Everything that a session must know of a board of this tick, µs.
    pub fn wiring(&self, tick_us: u32) -> Result<Wiring> {
        let facts = BoardFacts::read(&self.board)?;
        Wiring::new(&facts, tick_us).with_context(|| self.board.display().to_string())
    }

    /// The same of the board that is connected, which must be the one that the file was measured on.
    pub fn wiring_of(&self, identity: &Identity) -> Result<Wiring> {
        let wiring = self.wiring(identity.tick_us)?;
        self.of_board(&wiring.facts, identity)?;
        Ok(wiring)
    }

    /// Refuses a file that was measured on another board, unless that is said to be right.
    pub fn of_board(&self, facts: &BoardFacts, identity: &Identity) -> Result<()> {
        match self.another_board {
            true => Ok(()),
            false => Ok(facts.of_board(identity).with_context(|| self.board.display().to_string())?),
        }
    }
}
