//! What the page is told of the device: who it is, and its figures.

use crate::device::Device;
use crate::feed::Tick;
use crate::message::{Facts, State};
use device_link::window::{self, Window};
use remedy::sentence;

/// Who is shown, in columns of so many ticks.
pub fn facts(device: &Device, length: u32) -> Facts {
    let Device { identity, table, sensor, .. } = device;
    Facts {
        board: format!("{}, firmware {} ({})", identity.board, identity.firmware, identity.git),
        table: bench::describe(table).into_iter().next().unwrap_or_default(),
        column_s: f64::from(length * identity.tick_us) * 1e-6,
        sensor: sensor.is_some(),
        interval: table.interval.is_some(),
        no_zero: bench::require_model(table).err().map(|error| sentence(&error)),
    }
}

/// The figures of the last second, and of its last tick: a sample's displacement is that of the next tick, whose sensor
/// and voltage are not known yet.
pub fn figures(window: &Window, last: Option<&Tick>) -> State {
    let Some(last) = last else { return State::default() };
    let of = |extent: window::Extent, last: f32| [last, extent.min.min(last), extent.max.max(last)];
    State {
        displacement_um: window.displacement().map(|extent| of(extent, last.displacement_um)),
        half_width_um: last.half_width_um,
        voltage_v: window.voltage().map(|extent| of(extent, last.voltage_v)),
        sensor_um: last.sensor_um,
        error_um: last.sensor_um.map(|sensor| last.displacement_um - sensor),
        ..State::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feed::Feed;
    use device_link::sensor::Sensor;
    use emulator::TABLE;
    use protocol::{Sample, Samples};
    use std::num::NonZeroU8;

    #[test]
    fn estimate_and_sensor_of_a_ramp_are_of_the_same_tick() {
        let sensor = Sensor { zero_um: 0.0, full_um: 1000.0, full_scale: 1000 };
        let mut feed = Feed::new(TABLE.adc, Some(sensor), 500);
        let mut window = Window::new(TABLE.adc, 2000);
        // 10 µm a tick; a sample's displacement is the next tick's.
        let sample = |tick: u16| Sample {
            code: 100,
            sensor: Some(10 * tick),
            displacement: 10.0 * f32::from(tick + 1),
            half_width: Some(f32::from(tick + 1)),
            dac: 0,
            status: Default::default(),
            faults: Default::default(),
        };
        let samples = Samples { first: 0, every: NonZeroU8::MIN, samples: (0..9).map(sample).collect() };
        window.take(&samples);
        let mut last = None;
        feed.take(&samples, |tick| last = Some(*tick));
        let state = figures(&window, last.as_ref());
        assert_eq!((state.displacement_um, state.half_width_um), (Some([80.0, 10.0, 90.0]), Some(8.0)));
        assert_eq!((state.sensor_um, state.error_um), (Some(80.0), Some(0.0)));
        assert!(figures(&window, None).voltage_v.is_none());
    }
}
