//! What the board's image does, from reset to reset. One program, so that its tests run side by side.

mod boot;
mod common;
mod cycles;
mod excite;
mod failures;
mod faults;
mod flood;
mod follow;
mod learn;
mod leases;
mod line;
mod linearise;
mod log;
mod power_cut;
mod ramps;
mod rate;
mod resets;
mod resolution;
mod sensor;
mod store;
mod supply;
mod timing;
mod valid;
mod waveform;
