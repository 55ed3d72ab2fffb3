//! From a measured log to a proven parameter table: everything behind the `piezo` binary.

pub mod calibration;
pub mod command;
pub mod compare;
pub mod cost;
pub mod device;
pub mod drive;
pub mod feedforward;
pub mod identify;
pub mod least_squares;
pub mod log;
pub mod optimise;
pub mod output;
pub mod prepare;
pub mod report;
pub mod reproduce;
pub mod rig;
pub mod session;
pub mod table_file;
pub mod tabulation;
pub mod validate;
