//! A training session: a designed drive out, the voltage and the sensor in, a log a segment.

use crate::error::BenchError;
use crate::loan::{self, Loan, beside};
use crate::log::LogFile;
use crate::session::SESSION;
use crate::watch::{Complaint, Watch};
use crate::wiring::Wiring;
use device_link::Client;
use device_link::interrupt::Interrupt;
use device_link::play::{Held, Play, PlayError, play};
use device_link::streamed::Streamed;
use estimator_core::AdcCode;
use excitation::{Drive, Segment};
use protocol::{Faults, Mode, stream_every};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Columns of a training log.
const HEADING: &str = "time_s,voltage_V,displacement_um";

/// What is to be done.
pub struct Training<'a> {
    /// What the board's converters and wires stand for.
    pub wiring: &'a Wiring,
    /// The voltages, a segment a log.
    pub drive: &'a Drive,
    /// Where logs, the table of before and what was done are kept.
    pub folder: &'a Path,
    /// The wish to end.
    pub interrupt: &'a Interrupt,
}

/// A log that was written.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Written {
    /// The log's file.
    pub log: PathBuf,
    /// What of the actuator it shows, for people.
    pub what: &'static str,
    /// Its rows, one a sample.
    pub rows: u64,
    /// All of the segment is there.
    pub complete: bool,
    /// To prove with, not to be learnt from.
    pub held_out: bool,
}

/// Why a session ended before its time.
#[derive(Debug)]
pub enum Ended {
    /// A fault sent the drive back to rest.
    Fault(Faults),
    /// There was nothing to be recorded.
    Complaint(Complaint),
    /// A log cannot be written.
    Log(BenchError),
    /// The link failed, or the user has had enough.
    Play(PlayError),
}

/// What came of a session.
#[derive(Debug)]
pub struct Trained {
    /// The logs that were begun, in the order of the drive.
    pub logs: Vec<Written>,
    /// Ticks that waited for the host and held the voltage: they stand in the logs as they were.
    pub starved: u32,
    /// What ended it before its time.
    pub ended: Option<Ended>,
    /// A table of before had been taken out of use; without one, the straight line's was in use, and is.
    pub lent: bool,
    /// Whether the voltage is at rest and the table of before in use again; else what hinders.
    pub home: Result<(), BenchError>,
}

impl Trained {
    /// Whether all was recorded, and the device is as it was before.
    pub fn complete(&self) -> bool {
        self.ended.is_none() && self.home.is_ok()
    }
}

/// Plays a drive and records it. Whatever happens, the voltage goes to rest, and the table of before is in use again
/// where the link allows; [`FORMER`](crate::FORMER) keeps it meanwhile. `progress` is told the segment and the ticks of
/// all that are done.
///
/// # Errors
/// Nothing was driven: the board is another one, its DAC is not known to drive or would jump, or the folder holds a
/// session or cannot be written. Or what was done cannot be written beside the logs.
pub fn train(
    client: &mut Client,
    training: &Training<'_>,
    progress: &mut dyn FnMut(&Segment, usize),
) -> Result<Trained, BenchError> {
    let Training { wiring, drive, folder, .. } = *training;
    // Whoever looks at the folder meanwhile sees by it that the session has not ended.
    let _held = result_files::Held::of(folder)?;
    let loan = Loan::take(client, wiring, folder)?;
    let mut recorder = Recorder {
        training,
        watch: Watch::new(wiring, drive.request().span_v()),
        logs: Vec::new(),
        starved: 0,
        done: 0,
        held: None,
    };
    // Written before anything moves: of a session that is killed, too, it is known what was recorded.
    let ended = match result_files::write(&folder.join(SESSION), planned(training)) {
        Ok(()) => drive.segments.iter().enumerate().find_map(|at| recorder.record(client, at, progress).err()),
        Err(error) => Some(Ended::Log(error.into())),
    };
    let Recorder { logs, starved, .. } = recorder;
    // A voltage that was not seen to come to rest is no reason to keep the device from its table: it rests by itself.
    let rested = loan::rest(client, wiring.adc(), wiring.drive().limits);
    let given_back = loan.give_back(client, folder);
    let home = match rested {
        Ok(()) => given_back,
        Err(error) => Err(beside(error, given_back)),
    };
    let trained = Trained { logs, starved, ended, lent: !matches!(loan, Loan::Nothing), home };
    result_files::write(&folder.join(SESSION), session(training, &trained))?;
    Ok(trained)
}

/// Plays segments and writes their logs.
struct Recorder<'a> {
    training: &'a Training<'a>,
    watch: Watch<'a>,
    logs: Vec<Written>,
    starved: u32,
    /// Ticks of the segments before.
    done: usize,
    /// Where the segment before holds.
    held: Option<Held>,
}

impl Recorder<'_> {
    /// Plays a segment, from rest to rest, and writes its log: a row a sample, those that waited for the
    /// host among them.
    fn record(
        &mut self,
        client: &mut Client,
        (index, segment): (usize, &Segment),
        progress: &mut dyn FnMut(&Segment, usize),
    ) -> Result<(), Ended> {
        let Training { wiring, folder, interrupt, .. } = *self.training;
        let tick_s = wiring.line().sample_period();
        let mut log = LogFile::create(&folder.join(name(index, segment)), HEADING, tick_s).map_err(Ended::Log)?;
        let (references, ticks) = (&segment.volts[..], segment.volts.len());
        // It ends at rest, where it is held until the next one goes on.
        let what = Play { mode: Mode::Excite, goes_on: self.held, references, hold: true, ticks };
        let mut ended = None;
        let watch = &mut self.watch;
        let done = self.done;
        let played = play(client, &what, interrupt, &mut |of| {
            let Streamed { tick, sample, .. } = of;
            let volts: f64 = wiring.adc().voltage(AdcCode(sample.code));
            let um = wiring.sensor.um(sample).unwrap_or(f64::NAN);
            ended = match watch.complaint(sample, volts) {
                Some(complaint) => Some(Ended::Complaint(complaint)),
                None => log.row(*tick, &[volts, um]).err().map(Ended::Log),
            };
            progress(segment, done + tick + 1);
            ended.is_none()
        });
        let fault = played.as_ref().ok().map(|played| played.stopped).filter(|stopped| !stopped.is_empty());
        self.starved += played.as_ref().map_or(0, |played| played.starved);
        self.held = played.as_ref().ok().map(|played| played.held);
        self.done += ticks;
        let ended = ended.or(fault.map(Ended::Fault)).or(played.err().map(Ended::Play));
        let (log, rows) = log.end();
        let (what, held_out) = (segment.what, segment.held_out);
        self.logs.push(Written { log, what, rows, complete: ended.is_none(), held_out });
        ended.map_or(Ok(()), Err)
    }
}

/// The name of a segment's log.
fn name(index: usize, segment: &Segment) -> String {
    match segment.held_out {
        true => format!("{}.csv", segment.name),
        false => format!("{:02}-{}.csv", index + 1, segment.name),
    }
}

/// What was done, as it is kept beside the logs.
#[derive(Serialize)]
struct Session<'a> {
    tool: String,
    complete: bool,
    /// The logs are those that are planned, with the rows that they are to have.
    under_way: bool,
    seed: u64,
    tick_us: u32,
    covers: Vec<String>,
    forbidden: Vec<String>,
    waited_ticks: u32,
    planned: usize,
    board: &'a crate::BoardFacts,
    logs: &'a [Written],
}

/// The description of a session that is about to begin.
fn planned(training: &Training<'_>) -> String {
    let every = usize::from(stream_every(1_000_000 / training.wiring.line().sample_period_us).get());
    let of = |(index, segment): (usize, &Segment)| Written {
        log: training.folder.join(name(index, segment)),
        what: segment.what,
        // Streamed are as many ticks, but the last ones may fall between two samples.
        rows: (segment.volts.len() / every).saturating_sub(1) as u64,
        complete: false,
        held_out: segment.held_out,
    };
    let logs: Vec<Written> = training.drive.segments.iter().enumerate().map(of).collect();
    described(Session { under_way: true, ..of_session(training, &logs) })
}

/// That of one that has ended.
fn session(training: &Training<'_>, trained: &Trained) -> String {
    let session = of_session(training, &trained.logs);
    described(Session { complete: trained.complete(), waited_ticks: trained.starved, ..session })
}

fn of_session<'a>(training: &'a Training<'_>, logs: &'a [Written]) -> Session<'a> {
    Session {
        tool: format!("piezo {}", env!("CARGO_PKG_VERSION")),
        complete: false,
        under_way: false,
        seed: training.drive.request().seed,
        tick_us: training.wiring.line().sample_period_us,
        covers: training.drive.covers(),
        forbidden: training.drive.forbidden(),
        waited_ticks: 0,
        planned: training.drive.segments.len(),
        board: &training.wiring.facts,
        logs,
    }
}

fn described(session: Session<'_>) -> String {
    // Cannot fail: strings and numbers, the tables last.
    toml::to_string(&session).expect("a session's description is plain")
}
