//! What a training session leaves: its logs and their description, of one that was killed, too.

use crate::board_file::BoardFacts;
use crate::error::BenchError;
use result_files::is_held;
use serde::Deserialize;
use std::fmt::{self, Display, Formatter};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What was done, beside the logs.
pub const SESSION: &str = "session.toml";
/// A log that was begun and has fewer rows shows nothing.
const FEWEST: u64 = 100;

/// Refuses a folder in which another session's logs would be mixed with those of this one.
///
/// # Errors
/// It holds a session's description or numbered logs; or it cannot be read.
pub fn unoccupied(folder: &Path) -> Result<(), BenchError> {
    let failed = |source| BenchError::Log { path: folder.to_owned(), source };
    if !folder.exists() {
        return Ok(());
    }
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name();
        let numbered = matches!(name.as_encoded_bytes(), [b'0'..=b'9', b'0'..=b'9', b'-', .., b'.', b'c', b's', b'v']);
        if name == SESSION || numbered {
            return Err(BenchError::Occupied { path: entry.path() });
        }
    }
    Ok(())
}

/// Logs that a session wrote, as its description names them.
#[derive(Debug)]
pub struct Session {
    /// It did not end before its time.
    pub complete: bool,
    /// What its voltages were drawn with.
    pub seed: u64,
    /// The board's tick, µs.
    pub tick_us: u32,
    /// Logs to learn from.
    pub logs: Vec<PathBuf>,
    /// Logs to prove a table with.
    pub held_out: Vec<PathBuf>,
    /// What was known of the board, by which codes became volts and µm.
    pub board: Option<BoardFacts>,
    /// A program still writes it.
    pub recorded: bool,
    /// What is missing of it.
    pub unfinished: Option<Unfinished>,
}

/// A session of which not all is there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Unfinished {
    /// A program still writes into its folder.
    pub under_way: bool,
    /// It had come to its end, and lost something since.
    pub ended: bool,
    /// Logs that were begun.
    pub there: usize,
    /// Names of those that have fewer rows than they were to have.
    pub cut_short: Vec<String>,
    /// Logs of its plan, where it says so: sessions of before do not.
    pub planned: Option<usize>,
    /// One to prove with is among those that are there.
    pub held_out: bool,
}

impl Unfinished {
    fn of(logs: &[Described], planned: Option<usize>, under_way: bool, ended: bool) -> Option<Self> {
        let there = logs.len();
        let cut_short: Vec<String> = logs.iter().filter(|log| !log.complete).map(Described::name).collect();
        let held_out = logs.iter().any(|log| log.held_out);
        (!cut_short.is_empty() || planned.is_some_and(|planned| there < planned)).then_some(Self {
            under_way,
            ended,
            there,
            cut_short,
            planned,
            held_out,
        })
    }
}

impl Display for Unfinished {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let of = self.planned.map_or(String::new(), |planned| format!(" of {planned}"));
        let cut = match &self.cut_short[..] {
            [] => String::new(),
            names => format!(", {} cut short", names.join(", ")),
        };
        let proof = if self.held_out { "" } else { ", none to prove with among them" };
        let (begun, so_far) = match (self.under_way, self.ended) {
            (true, _) => ("the session is still being recorded", " so far"),
            (false, true) => ("the session has lost rows since it was recorded", ""),
            (false, false) => ("the session ended before its time", ""),
        };
        let there = self.there;
        write!(f, "{begun}: {there}{of} logs are there{so_far}{cut}{proof}; what is missing is not learnt")
    }
}

/// A log as the description has it.
#[derive(Deserialize)]
struct Described {
    log: PathBuf,
    held_out: bool,
    /// A description that was written by hand need not say it.
    #[serde(default = "whole")]
    complete: bool,
    /// Its rows; while the session is under way, those that it is to have.
    rows: Option<u64>,
}

impl Described {
    /// The log beside its description, wherever that was moved to.
    fn beside(&self, folder: &Path) -> PathBuf {
        folder.join(self.log.file_name().unwrap_or_default())
    }

    fn name(&self) -> String {
        self.log.file_name().unwrap_or_default().display().to_string()
    }

    /// As it stands there: of a session that did not come to say so, where it is `under_way`, or of one that has.
    fn found(self, folder: &Path, under_way: bool) -> Self {
        let Ok(text) = std::fs::read(self.beside(folder)) else {
            // What was never begun has no rows; of what was, reading it says what hinders that.
            return Self { rows: if under_way { Some(0) } else { self.rows }, ..self };
        };
        // The last line need not have an end.
        let lines = text.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()).count();
        let rows = (lines as u64).saturating_sub(1);
        let whole = self.rows.map_or(!under_way, |said| rows >= said);
        Self { complete: whole && (under_way || self.complete), rows: Some(rows), ..self }
    }

    /// Whether there is anything of it.
    fn begun(&self) -> bool {
        self.complete || self.rows.is_none_or(|rows| rows >= FEWEST)
    }
}

fn whole() -> bool {
    true
}

/// The tick of a board at 2 kHz, µs.
fn of_2_khz() -> u32 {
    500
}

/// Reads a session's description.
///
/// # Errors
/// There is none, or it is none.
pub fn session(folder: &Path) -> Result<Session, BenchError> {
    #[derive(Deserialize)]
    struct Description {
        complete: bool,
        seed: u64,
        /// Sessions of before had but one.
        #[serde(default = "of_2_khz")]
        tick_us: u32,
        planned: Option<usize>,
        /// It has not ended, or was killed: the logs are those that were planned.
        #[serde(default)]
        under_way: bool,
        board: Option<BoardFacts>,
        logs: Vec<Described>,
    }
    let path = folder.join(SESSION);
    let failed = |source| BenchError::Log { path: path.clone(), source };
    let text = std::fs::read_to_string(&path).map_err(failed)?;
    let Description { complete, seed, tick_us, planned, under_way, board, logs } =
        toml::from_str(&text).map_err(|error| failed(std::io::Error::new(ErrorKind::InvalidData, error)))?;
    let recorded = under_way && is_held(folder);
    let found = |log: Described| log.found(folder, under_way);
    // Of one that had ended, a log that has hardly anything left is missed all the same.
    let logs: Vec<Described> = logs.into_iter().map(found).filter(|log| complete || log.begun()).collect();
    let unfinished = Unfinished::of(&logs, planned, recorded, complete);
    let (held_out, learnt): (Vec<Described>, Vec<Described>) = logs.into_iter().partition(|log| log.held_out);
    let paths = |logs: Vec<Described>| logs.iter().map(|of| of.beside(folder)).collect();
    let (logs, held_out) = (paths(learnt), paths(held_out));
    Ok(Session { complete, seed, tick_us, logs, held_out, board, recorded, unfinished })
}

/// Whether logs are a training session's, whose volts are by what was known of the board.
pub fn of_session(logs: &[PathBuf]) -> bool {
    !logs.is_empty() && logs.iter().all(|log| log.with_file_name(SESSION).is_file())
}

/// Where `logs` is one folder that a training session wrote, puts the session's logs in its place, those to prove with
/// into `held_out`, unless something else is held out, and the board's tick into `tick_us`, µs, unless one is stated.
/// Anything else stays what it is. Returns what is missing of the session.
///
/// # Errors
/// The session's description is none, or the session has no log to learn from; its codes became volts and µm otherwise
/// than the `board`'s file has it, or that cannot be read.
pub fn open_session(
    logs: &mut Vec<PathBuf>,
    held_out: &mut Vec<PathBuf>,
    else_held_out: bool,
    tick_us: &mut Option<u32>,
    board: Option<&Path>,
) -> Result<Option<Unfinished>, BenchError> {
    let [folder] = &logs[..] else { return Ok(None) };
    if !folder.join(SESSION).is_file() {
        return Ok(None);
    }
    let described = session(folder)?;
    if described.logs.is_empty() {
        let said = match described.recorded {
            true => "the session is still being recorded and has no log to learn from yet: wait until it has ended",
            false => "the session ended before it had a log to learn from: train again",
        };
        let source = std::io::Error::new(ErrorKind::InvalidData, said);
        return Err(BenchError::Log { path: folder.join(SESSION), source });
    }
    if let (Some(before), Some(board)) = (&described.board, board) {
        let now = BoardFacts::read(board)?;
        let spans = [("adc_span", before.adc_span, now.adc_span), ("sensor_span", before.sensor_span, now.sensor_span)];
        let mut known = spans.into_iter().filter_map(|(what, then, now)| Some((what, then?, now?)));
        if let Some((what, then, now)) = known.find(|(_, then, now)| then != now) {
            let (session, board) = (folder.join(SESSION), board.to_owned());
            return Err(BenchError::Recalibrated { session, board, what, then, now });
        }
    }
    if held_out.is_empty() && !else_held_out {
        *held_out = described.held_out;
    }
    tick_us.get_or_insert(described.tick_us);
    *logs = described.logs;
    Ok(described.unfinished)
}

#[cfg(test)]
mod tests;
