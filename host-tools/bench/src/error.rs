//! Why a session on the bench cannot begin, or cannot end as it should.

use crate::board_file::{AnotherBoard, BoardFileError};
use crate::calibration_error::CalibrationError;
use crate::output::Jump;
use crate::watch::Complaint;
use crate::wiring::{NoModel, WiringError};
use device_link::LinkError;
use device_link::board::OtherFormat;
use device_link::busy::Busy;
use device_link::pil::FeedError;
use device_link::play::PlayError;
use device_link::table::RunningTableError;
use device_link::told::ToldError;
use device_link::write::WriteError;
use estimator_core::Range;
use estimator_core::table::Misfit;
use excitation::ExcitationError;
use protocol::Faults;
use result_files::FileError;
use std::error::Error;
use std::path::PathBuf;
use table_files::TableFileError;

/// Why a session on the bench cannot begin, or cannot end as it should.
#[derive(Debug, thiserror::Error)]
pub enum BenchError {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The device's flash cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Something depends on what the device drives.
    #[error(transparent)]
    Busy(#[from] Busy),
    /// The device could not be driven to the end.
    #[error(transparent)]
    Play(#[from] PlayError),
    /// The device was not told its displacement.
    #[error(transparent)]
    Told(#[from] ToldError),
    /// Codes could not be fed to the device.
    #[error(transparent)]
    Feed(#[from] FeedError),
    /// The device's table cannot be read.
    #[error(transparent)]
    Running(#[from] RunningTableError),
    /// The device reads tables of another format.
    #[error(transparent)]
    Format(#[from] OtherFormat),
    /// A table's file cannot be used.
    #[error(transparent)]
    Table(#[from] TableFileError),
    /// A board's file cannot be used.
    #[error(transparent)]
    Board(#[from] BoardFileError),
    /// What is known is of another board.
    #[error(transparent)]
    Another(#[from] AnotherBoard),
    /// Two readings make no calibration.
    #[error(transparent)]
    Calibration(#[from] CalibrationError),
    /// The table in use, or the board's file, does not let it be driven so far.
    #[error("{volts} V are not within {of}, {} … {} V", range_v.min, range_v.max)]
    BeyondDrive {
        /// What was asked for, V.
        volts: f32,
        /// What is allowed, V.
        range_v: Range,
        /// What sets that range, for the message: the table, or the board's file.
        of: &'static str,
    },
    /// It would take too long to get there.
    #[error("at half of {slew_v_per_s} V/s, the fastest that is allowed, a ramp would take {seconds:.0} s")]
    SlowRamp {
        /// How long the ramp would take, s.
        seconds: f64,
        /// The smaller slew of the table in use and of the board's file, V/s.
        slew_v_per_s: f32,
    },
    /// What is known of the board does not suffice.
    #[error(transparent)]
    Wiring(#[from] WiringError),
    /// What is known of the board is another board's.
    #[error("what is said of the board is not this device's: a table by it is {0}")]
    Misfit(#[from] Misfit),
    /// There is no such drive.
    #[error(transparent)]
    Excitation(#[from] ExcitationError),
    /// The DAC shows the displacement, or there is no table: nobody knows that it is plugged into the amplifier.
    #[error("the device has no table by which its DAC drives the amplifier")]
    NotDriving,
    /// The table in use was made for other converters.
    #[error("the table in use has another {what} than is said of the board")]
    OtherConverters {
        /// Which calibration of the two differs.
        what: &'static str,
    },
    /// By the other table the DAC puts out something else at rest.
    #[error(transparent)]
    WouldJump(#[from] Jump),
    /// A session before was killed, and its folder keeps the table that was in use before it.
    #[error("{}: holds the only copy of the table that was in use before a session which did not end", path.display())]
    FormerKept {
        /// The file that keeps it.
        path: PathBuf,
    },
    /// There is something that must not be written over.
    #[error("{}: is there already, from a session before", path.display())]
    Occupied {
        /// The file or folder that is there.
        path: PathBuf,
    },
    /// The table in use is the straight line's, which is no model.
    #[error(transparent)]
    NoModel(#[from] NoModel),
    /// Nothing says what would be good enough.
    #[error("the table in use states no ±, so that nothing says what would be good enough")]
    NothingStated,
    /// There is nothing to compare with.
    #[error("{complaint}{}", log.as_ref().map_or(String::new(), |log| format!("; what was measured before is in {}", log.display())))]
    Sensor {
        /// What is wrong with the sensor.
        complaint: Complaint,
        /// Where what was measured before was written, where anything was.
        log: Option<PathBuf>,
    },
    /// Two things went wrong, one after the other.
    #[error("{0}; and then: {1}")]
    Both(Box<BenchError>, Box<BenchError>),
    /// A fault sent the drive to rest.
    #[error("a fault sent the drive back to rest after {ticks} ticks")]
    Stopped {
        /// Ticks that had been done.
        ticks: usize,
        /// The faults that the device reported.
        faults: Faults,
    },
    /// After its restart the device runs another table than was written.
    #[error("after its restart the device does not run the table that was written")]
    NotTaken,
    /// The voltage does not come back to its rest.
    #[error("the voltage is at {volts:.2} V and does not come to its rest at {rest_v} V")]
    NotAtRest {
        /// Where it stood last, V; NaN where nothing came.
        volts: f32,
        /// Where it belongs, V.
        rest_v: f32,
    },
    /// A file or folder cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A log, or what was done, cannot be read or written.
    #[error("{}: cannot be used", path.display())]
    Log {
        /// The log, or what was to be read or written in its place.
        path: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// A session's logs were recorded by another calibration of the board than its file has now.
    #[error(
        "{}: its logs were recorded with {what} = [{}, {}], and {} has [{}, {}] now: a table for this board needs logs by what it has",
        session.display(), then.0, then.1, board.display(), now.0, now.1
    )]
    Recalibrated {
        /// The session's description.
        session: PathBuf,
        /// The board's file.
        board: PathBuf,
        /// The value that differs, as the file has it.
        what: &'static str,
        /// What it was when the session was recorded.
        then: (f64, f64),
        /// What it is now.
        now: (f64, f64),
    },
    /// Next to nothing was measured.
    #[error("next to nothing was measured: {0} ticks")]
    Nothing(usize),
}

impl BenchError {
    /// The error of another part that this is, where it is one.
    pub fn of_another(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            Self::Link(error) => Some(error),
            Self::Write(error) => Some(error),
            Self::Busy(error) => Some(error),
            Self::Play(error) => Some(error),
            Self::Told(error) => Some(error),
            Self::Feed(error) => Some(error),
            Self::Running(error) => Some(error),
            Self::Table(error) => Some(error),
            Self::Board(error) => Some(error),
            Self::Another(error) => Some(error),
            Self::Calibration(error) => Some(error),
            Self::Wiring(error) => Some(error),
            Self::Excitation(error) => Some(error),
            Self::NoModel(error) => Some(error),
            _ => None,
        }
    }
}
