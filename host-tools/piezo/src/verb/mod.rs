//! The verbs of `piezo`, one a file. Each takes its parsed arguments, prints a summary for people (or JSON), and
//! returns whether it succeeded.

pub mod calibrate;
pub mod collect;
pub mod compare;
pub mod divider;
pub mod emit;
pub mod emulate;
pub mod erase;
pub mod estimate;
pub mod feedforward;
pub mod flash;
pub mod follow;
pub mod identify;
pub mod info;
pub mod install;
pub mod learn;
pub mod linearise;
pub mod look;
pub mod manual;
pub mod monitor;
pub mod pil;
pub mod prove;
pub mod pull;
pub mod push;
pub mod record;
pub mod reproduce;
pub mod reset;
pub mod simulate;
pub mod train;
pub mod validate;
pub mod waveform;
pub mod zero;

mod device;
mod print;
