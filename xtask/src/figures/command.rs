//! The commands that print the figures. Each runs at most once, whatever number of figures it has.

use std::{
    cell::RefCell,
    collections::BTreeMap,
    fs,
    panic::resume_unwind,
    path::{Path, PathBuf},
    rc::Rc,
    thread,
    time::Instant,
};

use anyhow::{Context, Result};
use serde_json::{Value, json};
use tempfile::TempDir;
use xshell::{Cmd, Shell, cmd};

use super::resistors::ENDS;
use crate::{
    artifact, cycles,
    packages::HOST,
    size::{self, LOG},
};

/// Another session of the actuator whose log is identified from.
const OTHER_DAY: &str = "tests/data/picma-p885-session2.csv";

/// A command that prints JSON.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Command {
    /// `piezo identify` on the measured log.
    Identify,
    /// `piezo identify --as-judged` of the measured log.
    AsJudged,
    /// `piezo validate` of that table on the half of the same log that it was not learnt from.
    Validate,
    /// The same, zeroed as the held-out half begins.
    SameDay,
    /// `piezo validate` of the delivered table on another session of the same actuator, zeroed in a rest.
    OtherDay,
    /// The same, told the first reading and never zeroed.
    OtherDayUnzeroed,
    /// The firmware's tick with its table and faults of the signal.
    SignalFaults,
    /// `piezo divider` of monitors and of inputs.
    Resistors,
    /// `piezo reproduce errors tracking`, which identifies each model once for both.
    Reproduce,
    /// `cargo xtask size`.
    Size,
    /// `cargo xtask size --models`.
    SizeModels,
    /// `cargo xtask cycles`.
    Cycles,
}

/// Every command, in rows that run side by side: what computes, and what an emulator does, which is one thread. A row
/// has one emulator at a time, since two could choose the same port.
const ROWS: [&[Command]; 2] = [
    &[
        Command::Identify,
        Command::AsJudged,
        Command::Validate,
        Command::SameDay,
        Command::OtherDay,
        Command::OtherDayUnzeroed,
        Command::SignalFaults,
        Command::Resistors,
        Command::Reproduce,
    ],
    &[Command::Size, Command::SizeModels, Command::Cycles],
];

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

    /// Runs all commands, which takes less time than one after the other.
    ///
    /// # Errors
    /// One fails.
    pub fn all(&self) -> Result<()> {
        let (root, piezo, demo) = (&self.sh.current_dir(), &self.piezo, &self.demo());
        let row = |commands: &'static [Command]| -> Result<Vec<Value>> {
            // A shell is one thread's.
            let sh = Shell::new()?;
            sh.change_dir(root);
            commands.iter().map(|&command| run(&sh, piezo, demo, command)).collect()
        };
        let printed = thread::scope(|scope| {
            let rows = ROWS.map(|commands| scope.spawn(move || row(commands)));
            rows.map(|row| row.join().unwrap_or_else(|panic| resume_unwind(panic)))
        });
        for (commands, printed) in ROWS.iter().zip(printed) {
            self.values.borrow_mut().extend(commands.iter().copied().zip(printed?.into_iter().map(Rc::new)));
        }
        Ok(())
    }

    /// What a command prints.
    ///
    /// # Errors
    /// It fails.
    pub fn by(&self, command: Command) -> Result<Rc<Value>> {
        if let Some(value) = self.values.borrow().get(&command) {
            return Ok(Rc::clone(value));
        }
        let table = match command {
            Command::Validate | Command::SameDay => Some(Command::AsJudged),
            Command::OtherDay | Command::OtherDayUnzeroed | Command::SignalFaults => Some(Command::Identify),
            _ => None,
        };
        table.map(|table| self.by(table)).transpose()?;
        let value = Rc::new(run(self.sh, &self.piezo, &self.demo(), command)?);
        self.values.borrow_mut().insert(command, Rc::clone(&value));
        Ok(value)
    }

    /// The folder of what `piezo identify --as-judged` writes.
    ///
    /// # Errors
    /// It fails.
    pub fn as_judged(&self) -> Result<PathBuf> {
        self.by(Command::AsJudged)?;
        Ok(half(&self.demo()))
    }

    fn demo(&self) -> PathBuf {
        self.folder.path().join("demo")
    }
}

/// What a command prints; `demo` is the folder of what `piezo identify` writes.
fn run(sh: &Shell, piezo: &Path, demo: &Path, command: Command) -> Result<Value> {
    let start = Instant::now();
    let printed = match command {
        Command::Identify => json(cmd!(sh, "{piezo} identify {LOG} --out {demo}")),
        Command::AsJudged => json(cmd!(sh, "{piezo} identify {LOG} --as-judged --out").arg(half(demo))),
        Command::Validate => validated(sh, piezo, &half(demo), LOG, &["--from", "20.1"]),
        Command::SameDay => validated(sh, piezo, &half(demo), LOG, &["--zero-at", "20.1"]),
        Command::OtherDay => validated(sh, piezo, demo, OTHER_DAY, &["--zero-at", "24"]),
        Command::OtherDayUnzeroed => validated(sh, piezo, demo, OTHER_DAY, &[]),
        Command::SignalFaults => signal_faults(sh, piezo, demo),
        Command::Resistors => resistors(sh, piezo),
        Command::Reproduce => json(cmd!(sh, "{piezo} reproduce errors tracking")),
        Command::Size => size::figures(sh, piezo),
        Command::SizeModels => size::models(sh, piezo),
        Command::Cycles => cycles::measure(sh),
    };
    println!("{command:?}: {:.1} s", start.elapsed().as_secs_f64());
    printed.with_context(|| format!("{command:?}"))
}

/// The folder of a table that was learnt from the log's first half alone, beside the demonstration's.
fn half(demo: &Path) -> PathBuf {
    demo.with_file_name("half")
}

/// What `piezo validate` prints of the identified table and a log.
fn validated(sh: &Shell, piezo: &Path, demo: &Path, log: &str, scope: &[&str]) -> Result<Value> {
    json(cmd!(sh, "{piezo} validate").arg(demo.join("table.toml")).arg(log).args(scope))
}

/// What the firmware makes of faults of the signal, with the identified table on the board's converters.
fn signal_faults(sh: &Shell, piezo: &Path, demo: &Path) -> Result<Value> {
    let program = artifact::build(cmd!(sh, "cargo build {HOST...} --example signal_faults"), "signal_faults")?;
    let (table, folder) = (demo.join("table.toml"), TempDir::new()?);
    let board = folder.path();
    let converters = ["--adc-full-scale", "65520", "--amplifier-slew", "250"];
    cmd!(sh, "{piezo} emit {table} {converters...} --out {board}").ignore_stderr().read()?;
    let record = board.join("table.bin");
    Ok(serde_json::from_str(&cmd!(sh, "{program} {record}").read()?)?)
}

/// What `piezo divider` chooses for the ends that the documents show.
fn resistors(sh: &Shell, piezo: &Path) -> Result<Value> {
    let of = |option: &str| -> Result<Value> {
        let found = ENDS
            .iter()
            .map(|ends| Ok(json!({ "ends": ends, "found": json(cmd!(sh, "{piezo} divider {option} {ends}"))? })));
        found.collect()
    };
    Ok(json!({ "monitor": of("--monitor")?, "input": of("--input")? }))
}

fn json(command: Cmd<'_>) -> Result<Value> {
    Ok(serde_json::from_str(&command.arg("--json").ignore_stderr().read()?)?)
}

/// A file's bytes.
///
/// # Errors
/// It cannot be read.
pub fn bytes(path: &Path) -> Result<Vec<u8>> {
    fs::read(path).with_context(|| path.display().to_string())
}
