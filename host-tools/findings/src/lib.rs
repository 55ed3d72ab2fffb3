//! What stands around an identification, for whoever starts one, the program or a script in Python: what is meant where
//! a request leaves something unsaid, what was found in the words that the user reads, and the file that is made of it.
//!
//! The words name the program's options, as those of `remedy` do, which hands them on.

mod compared;
mod compared_lines;
mod determination;
mod doubt;
mod estimated;
pub mod figures;
mod flaw;
mod interval;
mod left_out;
mod log_use;
mod micrometres;
mod proven;
mod raised;
mod reason;
mod recipe;
mod search;
mod short;
mod surveyed;
mod table_file;
mod unsaid;
mod validated;
pub mod validated_log;

pub use compared::{compared_tables, table_name, written_to};
pub use compared_lines::{COMPARED, compared_how, compared_lines};
pub use determination::{DETERMINED, TAUGHT, determination, taught};
pub use doubt::{calibrated, doubt, doubt_interval, doubt_json, doubt_session, implausible, runs_ahead};
pub use estimated::{estimated, estimated_json};
pub use flaw::{flaw, flaw_found, flaws};
pub use interval::interval;
pub use left_out::left_out;
pub use log_use::{log_use, used};
pub use micrometres::Micrometres;
pub use proven::proven;
pub use reason::reason;
pub use recipe::{ends_left_out, monitor_asked, zeros};
pub use search::{search, searches};
pub use short::counted;
pub use surveyed::{doubtful, remarked, surveyed};
pub use table_file::{bring_to, table_file};
pub use unsaid::{hold_out, model};
pub use validated::{explained, failed};
