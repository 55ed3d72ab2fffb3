//! Checks that run beside others, in a process of their own: each of the two uses one core for most of its time, and
//! what both print is not mixed.

use std::{
    env,
    fs::{self, File},
    io,
    path::Path,
    process::{Child, Command, Stdio},
};

use anyhow::{Context, Result};
use tempfile::TempDir;

use crate::{outcome::Outcome, step::Step, stopwatch::Stopwatch};

/// Where the other process leaves what it prints, and how its checks went.
const PRINTED: &str = "printed";
const OUTCOMES: &str = "outcomes.json";

/// Checks that are running.
pub struct Beside<'s> {
    steps: Vec<&'s Step>,
    process: Child,
    folder: TempDir,
    stopwatch: Stopwatch,
}

impl<'s> Beside<'s> {
    /// Starts them, one after the other.
    ///
    /// # Errors
    /// There is no room for what they print, or this program cannot be started again.
    pub fn start(steps: Vec<&'s Step>, keep_going: bool) -> Result<Self> {
        let folder = TempDir::new()?;
        let printed = File::create(folder.path().join(PRINTED))?;
        let process = Command::new(env::current_exe()?)
            .arg("test")
            .args(steps.iter().map(|step| step.name))
            .args(keep_going.then_some("--keep-going"))
            .arg("--outcomes")
            .arg(folder.path().join(OUTCOMES))
            .stdin(Stdio::null())
            .stderr(printed.try_clone()?)
            .stdout(printed)
            .spawn()?;
        Ok(Self { steps, process, folder, stopwatch: Stopwatch::start() })
    }

    /// Waits for them, prints what they have printed, and says how each went.
    ///
    /// # Errors
    /// What they have printed cannot be read.
    pub fn finish(mut self) -> Result<Vec<(&'s Step, Outcome)>> {
        let ended = self.process.wait()?;
        let spent = self.stopwatch.read();
        io::copy(&mut File::open(self.folder.path().join(PRINTED))?, &mut io::stdout().lock())?;
        let outcomes = read(&self.folder.path().join(OUTCOMES)).unwrap_or_else(|error| {
            println!("the checks beside ended with {ended} and told nothing of themselves: {error:#}");
            Vec::new()
        });
        // One of which nothing is known has not passed.
        let unknown = std::iter::repeat(Outcome::Failed(spent));
        Ok(self.steps.iter().copied().zip(outcomes.into_iter().chain(unknown)).collect())
    }
}

/// Where the checks that others run beside cannot go on, neither can these.
impl Drop for Beside<'_> {
    fn drop(&mut self) {
        // It has ended already, or ends now: there is nothing else to be done.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Leaves how checks went to the process that started this one.
///
/// # Errors
/// The file cannot be written.
pub fn leave(path: &Path, outcomes: &[Outcome]) -> Result<()> {
    Ok(fs::write(path, serde_json::to_vec(outcomes)?)?)
}

fn read(path: &Path) -> Result<Vec<Outcome>> {
    let bytes = fs::read(path).with_context(|| path.display().to_string())?;
    Ok(serde_json::from_slice(&bytes)?)
}
