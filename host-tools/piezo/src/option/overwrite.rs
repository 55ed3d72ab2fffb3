//! Whether a file may be lost.

use clap::Args;

/// What becomes of a file that is in a result's place.
#[derive(Args, Clone, Copy, Debug)]
pub struct Overwrite {
    /// Write over a file that is no former result of this verb, or over a measurement.
    #[arg(long, help_heading = None::<&str>)]
    pub force: bool,
}
