//! What is known of the board, as a file that every verb takes.

use super::link::PortOption;
use anyhow::{Context, Result};
use bench::{BoardFacts, Wiring};
use clap::Args;
use device_link::Client;
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
    /// What the file says.
    pub fn facts(&self) -> Result<BoardFacts> {
        Ok(BoardFacts::read(&self.board)?)
    }

    /// Everything that a session must know of a board of this tick, µs.
    pub fn wiring(&self, facts: &BoardFacts, tick_us: u32) -> Result<Wiring> {
        Wiring::new(facts, tick_us).with_context(|| self.board.display().to_string())
    }

    /// The board at a port, which must be the one that the file was measured on unless another is said to be right, and
    /// what the file says.
    pub fn connect(&self, port: &PortOption) -> Result<(Client, Identity, BoardFacts)> {
        let facts = self.facts()?;
        let (client, identity) = port.connect()?;
        if !self.another_board {
            facts.of_board(&identity).with_context(|| self.board.display().to_string())?;
        }
        Ok((client, identity, facts))
    }
}
