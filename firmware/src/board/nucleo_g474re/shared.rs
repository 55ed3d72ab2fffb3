//! What the tick, the main loop and a panic share.

use firmware::Telemetry;
use firmware::waveform::Points;

/// What the tick leaves for others to read.
pub static TELEMETRY: Telemetry = Telemetry::new();
/// The points of a waveform.
// SAFETY: a section of its own, which nothing initialises: any bits are points, and none is read before it is written.
#[unsafe(link_section = ".waveform")]
pub static POINTS: Points = Points::new();
