//! What the converters of an emulated device are connected to.

use estimator_core::{AdcCalibration, AdcCode, DacCode, DriveCalibration};
use firmware::Conversion;
use firmware::rate::TICK_HZ;

/// What is behind the converters: an amplifier with a load, a recorded log, a signal generator.
pub trait Plant: Send + 'static {
    /// What the converters read at a tick, where the DAC has put `dac` out since the tick before.
    fn sample(&mut self, dac: DacCode) -> Conversion;
}

impl<P: FnMut(DacCode) -> Conversion + Send + 'static> Plant for P {
    fn sample(&mut self, dac: DacCode) -> Conversion {
        self(dac)
    }
}

/// A triangle of 1 Hz over most of a 16-bit ADC's range (codes 3,000 to 62,000), whatever the DAC does; it starts at
/// the lower end.
pub fn triangle() -> impl Plant {
    let mut phase = 0;
    move |_| {
        let height = phase.min(TICK_HZ - phase);
        phase = (phase + 1) % TICK_HZ;
        // At most 62,000.
        AdcCode((3_000 + 118_000 * height / TICK_HZ) as u16).into()
    }
}

/// An amplifier without delay: the ADC reads the voltage that the DAC's code stands for, and one code more at every
/// second tick, as a converter's noise would have it.
pub fn amplifier(drive: DriveCalibration, adc: AdcCalibration) -> impl Plant {
    let mut noise = 0;
    move |dac| {
        noise = 1 - noise;
        let AdcCode(code) = adc.code(drive.voltage::<f32>(dac));
        AdcCode(code.saturating_add(noise).min(adc.full_scale)).into()
    }
}
