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
        let lines = text.iter().filter(|byte| **byte == b'\n').count();
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
    let logs: Vec<Described> = logs.into_iter().map(found).filter(Described::begun).collect();
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
mod tests {
    use super::*;
    use result_files::Held;

    #[test]
    fn what_is_missing_of_a_session_is_counted() {
        let folder = tempfile::tempdir().unwrap();
        let of = |planned: &str, logs: &[(&str, bool)]| {
            let log = |(name, complete): &(&str, bool)| {
                let held_out = *name == "held-out";
                format!("[[logs]]\nlog = \"{name}.csv\"\nheld_out = {held_out}\ncomplete = {complete}\n")
            };
            let logs: String = logs.iter().map(log).collect();
            std::fs::write(folder.path().join(SESSION), format!("complete = false\nseed = 1\n{planned}{logs}"))
                .unwrap();
            session(folder.path()).unwrap().unfinished.map(|unfinished| unfinished.to_string())
        };
        let all = [("01-rest", true), ("held-out", true)];
        assert_eq!(of("planned = 2\n", &all), None, "it did not come home, and all of it is there");
        assert_eq!(of("", &all), None, "one of before");
        let said = of("planned = 8\n", &[("01-rest", true), ("02-loops", false)]).unwrap();
        assert!(
            said.contains("2 of 8 logs are there, 02-loops.csv cut short, none to prove with among them"),
            "{said}"
        );
        let said = of("planned = 2\n", &[("01-rest", true), ("held-out", false)]).unwrap();
        let whole = "2 of 2 logs are there, held-out.csv cut short; what is missing is not learnt";
        assert!(said.ends_with(whole), "{said}");
        let said = of("", &[("01-rest", true), ("held-out", false)]).unwrap();
        assert!(said.contains("2 logs are there, held-out.csv cut short;"), "{said}");
    }

    #[test]
    fn what_a_killed_session_left_is_counted_in_its_logs() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let names = ["01-rest", "02-loops", "03-stairs", "held-out"];
        let log = |name: &&str| {
            format!(
                "[[logs]]\nlog = \"{name}.csv\"\nheld_out = {}\ncomplete = false\nrows = 500\n",
                *name == "held-out"
            )
        };
        let logs: String = names.iter().map(log).collect();
        std::fs::write(
            folder.join(SESSION),
            format!("complete = false\nseed = 1\nplanned = 4\nunder_way = true\n{logs}"),
        )
        .unwrap();
        let left = |rows: &[usize]| {
            for (name, rows) in names.iter().zip(rows) {
                std::fs::write(folder.join(name).with_extension("csv"), "0,0,0\n".repeat(rows + 1)).unwrap();
            }
            let Session { complete, logs, held_out, unfinished, .. } = session(folder).unwrap();
            assert!(!complete);
            (logs.len(), held_out.len(), unfinished.map(|of| of.to_string()).unwrap_or_default())
        };
        let (logs, held_out, said) = left(&[502, 400]);
        assert!(
            (logs, held_out) == (2, 0) && said.contains("2 of 4 logs are there, 02-loops.csv cut short, none to"),
            "{said}"
        );
        // While a program holds the folder, it is under way.
        let held = Held::of(folder).unwrap();
        let (logs, _, said) = left(&[502, 400]);
        let begun =
            "the session is still being recorded: 2 of 4 logs are there so far, 02-loops.csv cut short, none to";
        assert!(logs == 2 && said.starts_with(begun), "{said}");
        let mut logs = vec![folder.to_owned()];
        left(&[3, 3]);
        let none = open_session(&mut logs, &mut Vec::new(), false, &mut None, None).unwrap_err();
        assert!(std::error::Error::source(&none).unwrap().to_string().contains("no log to learn from yet: wait"));
        drop(held);
        // One that had hardly begun is none.
        let (logs, _, said) = left(&[502, 500, 99]);
        assert!(logs == 2 && said.contains("2 of 4 logs are there, none to"), "{said}");
        assert_eq!(left(&[502, 500, 500, 501]), (3, 1, String::new()), "killed once all of it was there");
    }

    #[test]
    fn rows_that_a_whole_session_has_lost_are_missed() {
        let folder = tempfile::tempdir().unwrap();
        let log = "[[logs]]\nlog = \"01-rest.csv\"\nheld_out = true\ncomplete = true\nrows = 300\n";
        std::fs::write(folder.path().join(SESSION), format!("complete = true\nseed = 1\nplanned = 1\n{log}")).unwrap();
        let with = |rows: usize| {
            std::fs::write(folder.path().join("01-rest.csv"), "0,0,0\n".repeat(rows + 1)).unwrap();
            session(folder.path()).unwrap().unfinished.map(|of| of.to_string())
        };
        assert_eq!(with(300), None);
        let said = with(299).unwrap();
        assert!(said.contains("has lost rows since it was recorded: 1 of 1 logs are there, 01-rest.csv cut"), "{said}");
    }

    #[test]
    fn a_session_s_folder_stands_for_its_logs() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let opened = |held_out: &[PathBuf], else_held_out: bool, tick_us: Option<u32>| {
            let (mut logs, mut held_out, mut tick_us) = (vec![folder.to_owned()], held_out.to_vec(), tick_us);
            open_session(&mut logs, &mut held_out, else_held_out, &mut tick_us, None).map(|_| (logs, held_out, tick_us))
        };
        let as_it_is = (vec![folder.to_owned()], Vec::new(), None);
        assert_eq!(opened(&[], false, None).unwrap(), as_it_is, "no session's");
        let logs = "[[logs]]\nlog = \"a/01-rest.csv\"\nheld_out = false\n[[logs]]\nlog = \"a/held-out.csv\"\nheld_out = true\n";
        std::fs::write(folder.join(SESSION), format!("complete = true\nseed = 1\ntick_us = 250\n{logs}")).unwrap();
        let learnt = vec![folder.join("01-rest.csv")];
        let proves = vec![folder.join("held-out.csv")];
        let other = vec![PathBuf::from("other.csv")];
        assert_eq!(opened(&[], false, None).unwrap(), (learnt.clone(), proves, Some(250)));
        // What is stated counts, the usual tick, too.
        assert_eq!(opened(&[], true, Some(500)).unwrap(), (learnt.clone(), Vec::new(), Some(500)));
        assert_eq!(opened(&other, false, None).unwrap(), (learnt, other, Some(250)));
        let by = |adc: &str, sensor: &str| format!("[board]\nadc_span = {adc}\nsensor_span = {sensor}\n{logs}");
        let recorded = format!("complete = true\nseed = 1\n{}", by("[-35.0, 135.0]", "[-5.0, 25.0]"));
        std::fs::write(folder.join(SESSION), recorded).unwrap();
        let board = folder.join("board.toml");
        let by_board = |text: &str| {
            std::fs::write(&board, text).unwrap();
            open_session(&mut vec![folder.to_owned()], &mut Vec::new(), false, &mut None, Some(&board)).map(|_| ())
        };
        by_board("adc_span = [-35.0, 135.0]").unwrap();
        let calibrated = by_board("adc_span = [-35.0, 135.0]\nsensor_span = [-5.1, 25.0]").unwrap_err().to_string();
        assert!(calibrated.contains("recorded with sensor_span = [-5, 25], and "), "{calibrated}");
        assert!(matches!(
            by_board("adc_span = [-36.0, 135.0]"),
            Err(BenchError::Recalibrated { what: "adc_span", .. })
        ));
        std::fs::write(folder.join(SESSION), "nothing").unwrap();
        assert!(matches!(opened(&[], false, None), Err(BenchError::Log { .. })));
    }
}
