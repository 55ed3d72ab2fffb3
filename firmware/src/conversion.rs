//! What a board's converter gives at a tick.

use estimator_core::AdcCode;

/// The codes of one tick, all read after the same trigger.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Conversion {
    /// The amplifier's monitor, from which the displacement is estimated.
    pub monitor: AdcCode,
    /// A displacement sensor beside it, which is streamed and decides nothing; `None` where the board has
    /// no such channel.
    pub sensor: Option<AdcCode>,
    /// The displacement that a controller wants ([`crate::setpoint`]); `None` where the board has no such channel.
    pub setpoint: Option<AdcCode>,
}

/// Of a board, or a feed, with the monitor alone.
impl From<AdcCode> for Conversion {
    fn from(monitor: AdcCode) -> Self {
        Self { monitor, sensor: None, setpoint: None }
    }
}
