//! Measured logs: read and checked ([`log`]), brought to the tick ([`prepare`], [`session`]), or made by a synthetic
//! actuator whose parameters are known ([`rig`]).

mod content;
pub mod log;
mod log_use;
pub mod prepare;
pub mod rig;
mod rounding;
pub mod session;

pub use content::Content;
pub use log_use::{LogUse, Role};
