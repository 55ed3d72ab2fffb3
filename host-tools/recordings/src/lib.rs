//! Measured logs: read and checked ([`log`]), brought to the tick ([`prepare`], [`session`]), or made by a synthetic
//! actuator whose parameters are known ([`rig`]).

pub mod file;
pub mod log;
pub mod prepare;
pub mod rig;
pub mod session;
