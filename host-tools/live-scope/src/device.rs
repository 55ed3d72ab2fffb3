//! A device with what must be known of it to show what it streams.

use crate::feed::Feed;
use device_link::Client;
use device_link::recording::RecordingRequest;
use device_link::sensor::Sensor;
use device_link::window::Window;
use estimator_core::Admitted;
use protocol::Identity;

/// A device that estimates.
pub struct Device {
    /// The link to it.
    pub client: Client,
    /// What the device says of itself: board, firmware, tick.
    pub identity: Identity,
    /// The table that it runs.
    pub table: Admitted,
    /// The sensor on its second channel, where it is known what its ends stand for.
    pub sensor: Option<Sensor>,
}

impl Device {
    /// Ticks in so many microseconds, at least one.
    pub fn ticks_in(&self, us: u32) -> u32 {
        (us / self.identity.tick_us.max(1)).max(1)
    }

    /// Its last second, empty as yet.
    pub fn window(&self) -> Window {
        Window::new(self.table.adc, self.ticks_in(1_000_000) as usize)
    }

    /// Its ticks, from the first frame on.
    pub fn feed(&self) -> Feed {
        Feed::new(self.table.adc, self.sensor, self.identity.tick_us)
    }

    /// A recording of it, with its sensor, that lasts until somebody has enough and ends where samples are lost.
    pub fn recording(&self) -> RecordingRequest {
        let &Self { sensor, identity: Identity { tick_us, .. }, .. } = self;
        RecordingRequest { calibration: self.table.adc, sensor, tick_us, ticks: None, allow_gaps: false }
    }
}
