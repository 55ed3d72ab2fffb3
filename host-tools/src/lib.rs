//! From a measured log to a proven parameter table: everything behind the `piezo` binary.

pub mod identify;
pub mod log;
pub mod prepare;
pub mod rig;
pub mod session;
pub mod validate;
