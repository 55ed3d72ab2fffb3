//! A board beside a displacement sensor.
//!
//! ```text
//! board.toml ─► BoardFacts ─► Wiring ─► a straight line's table, with which a board can be driven that knows no model yet
//!      ▲                         │
//!      calibrate                 └──► train   segments of voltages out, logs in; the table of before is in use again
//!                                     install a table, in use on the board, and bit for bit the host's
//!                                     prove   a random drive: the board's own estimate beside the sensor
//! ```
//!
//! However a session ends, the voltage goes to rest at the drive's slew rate, never with a jump.

mod board_edit;
mod board_file;
pub mod calibrate;
mod calibration_error;
mod described;
mod driven;
mod emulated;
mod error;
pub mod followed;
mod foreseen;
mod install;
mod loan;
mod log;
mod other_range;
mod output;
mod prove;
mod session;
mod set_out;
mod taught;
mod train;
mod verdict;
mod watch;
pub mod waveform;
mod wiring;

#[cfg(test)]
mod tests;

pub use board_edit::{Edited, Measured};
pub use board_file::{AnotherBoard, BoardFacts, BoardFileError};
pub use calibration_error::CalibrationError;
pub use described::{beyond_training, called, caveats, describe, held, time, title, wire_not_found};
pub use driven::Driven;
pub use emulated::{EMULATED, emulated};
pub use error::BenchError;
pub use foreseen::{Foreseen, Reached};
pub use install::{converters_fit, for_board, install, refusals, rehearsal};
pub use loan::{FORMER, rest};
pub use other_range::OtherRange;
pub use output::{Jump, Output};
pub use prove::{Proof, Proven, foresee, prove};
pub use session::{Session, Unfinished, of_session, open_session, session, unoccupied};
pub use set_out::set_out;
pub use taught::taught;
pub use train::{Ended, Trained, Training, Written, train};
pub use verdict::{MOST_PERCENT, STATED_PERCENT, Shares, Verdict};
pub use watch::Complaint;
pub use wiring::{NO_MODEL, NoModel, Wiring, WiringError, is_line, require_model};
