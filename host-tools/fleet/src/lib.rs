//! A fleet: many units of a kind, each identified from its own recordings by a run of its own, which whatever schedules
//! programs may start, on one machine or on many.
//!
//! What came of a run stands in its folder as `unit.json` ([`Unit`]), whether it found a table or not; [`Run`] writes
//! it, and knows whether it is still what the same logs, options and program would make ([`Asked`]). [`Fleet`] reads
//! many and says which are missing, which failed, and which are unlike the rest.

mod asked;
mod error;
mod fleet;
mod member;
mod outlier;
mod row;
mod run;
mod said;
mod unit;

pub use asked::Asked;
pub use error::UnitError;
pub use fleet::{Alike, Fleet};
pub use member::Member;
pub use outlier::{ENOUGH, Outlier, Quantity};
pub use row::{CSV, Row, State, csv};
pub use run::{Changed, Run, digests};
pub use said::said;
pub use unit::{Ended, Errors, Found, Identified, Reservation, UNIT, Unit, UnitName};
