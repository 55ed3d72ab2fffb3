//! The commands that print the figures. Each runs at most once, whatever number of figures it has.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    rc::Rc,
};

use anyhow::{Context, Result};
use serde_json::{Value, json};
use tempfile::TempDir;
use xshell::{Cmd, Shell, cmd};

use crate::{
    embedded::{self, Board},
    size::{self, LOG},
    stopwatch::Stopwatch,
};

/// A command that prints JSON.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Command {
    /// `piezo identify` on the measured log.
    Identify,
    /// `piezo validate` of its table on the same log.
    Validate,
    /// `piezo reproduce errors tracking`, which identifies each model once for both.
    Reproduce,
    /// `cargo xtask size`.
    Size,
    /// `cargo xtask size --models`.
    SizeModels,
    /// The drive's test on the emulated board: instructions of the tick's interrupt, by model.
    Drive,
}

/// What the commands have printed so far.
pub struct Printed<'sh> {
    sh: &'sh Shell,
    piezo: PathBuf,
    folder: TempDir,
    values: RefCell<BTreeMap<Command, Rc<Value>>>,
}

impl<'sh> Printed<'sh> {
    /// Nothing yet; `piezo` is the host tool.
    ///
    /// # Errors
    /// There is no room for temporary files.
    pub fn new(sh: &'sh Shell, piezo: PathBuf) -> Result<Self> {
        Ok(Self { sh, piezo, folder: TempDir::new()?, values: RefCell::default() })
    }

    /// What a command prints.
    ///
    /// # Errors
    /// It fails.
    pub fn by(&self, command: Command) -> Result<Rc<Value>> {
        if let Some(value) = self.values.borrow().get(&command) {
            return Ok(Rc::clone(value));
        }
        if command == Command::Validate {
            // Its table.
            self.by(Command::Identify)?;
        }
        let stopwatch = Stopwatch::start();
        let value = Rc::new(self.run(command).with_context(|| format!("{command:?}"))?);
        println!("{command:?}: {}", stopwatch.read());
        self.values.borrow_mut().insert(command, Rc::clone(&value));
        Ok(value)
    }

    /// The folder of what `piezo identify` writes.
    ///
    /// # Errors
    /// It fails.
    pub fn identified(&self) -> Result<PathBuf> {
        self.by(Command::Identify)?;
        Ok(self.demo())
    }

    fn demo(&self) -> PathBuf {
        self.folder.path().join("demo")
    }

    fn run(&self, command: Command) -> Result<Value> {
        let (sh, piezo) = (self.sh, &self.piezo);
        match command {
            Command::Identify => json(cmd!(sh, "{piezo} identify {LOG}").arg("--out").arg(self.demo())),
            Command::Validate => json(cmd!(sh, "{piezo} validate").arg(self.demo().join("table.toml")).arg(LOG)),
            Command::Reproduce => json(cmd!(sh, "{piezo} reproduce errors tracking")),
            Command::Size => size::figures(sh, piezo),
            Command::SizeModels => size::models(sh, piezo),
            Command::Drive => drive(sh),
        }
    }
}

fn json(command: Cmd<'_>) -> Result<Value> {
    Ok(serde_json::from_str(&command.arg("--json").ignore_stderr().read()?)?)
}

/// Reads what the test prints of each model: `NAME: … N instructions … on average, N at most`.
fn drive(sh: &Shell) -> Result<Value> {
    let image = embedded::image(sh, Board::NucleoG474re)?;
    let printed = cmd!(sh, "cargo test --quiet --package board-emulator-test --test image follow:: -- --nocapture")
        .env("FIRMWARE_IMAGE", image)
        .read()?;
    let counts = printed.lines().filter_map(|line| {
        let (name, what) = line.split_once(": ")?;
        let words: Vec<&str> = what.split_whitespace().collect();
        let before = |word: &str| words.windows(2).find(|pair| pair[1] == word)?[0].parse::<u64>().ok();
        Some((name.to_owned(), json!({ "mean": before("instructions")?, "max": before("at")? })))
    });
    Ok(Value::Object(counts.collect()))
}

/// A file's bytes.
///
/// # Errors
/// It cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| path.display().to_string())
}
