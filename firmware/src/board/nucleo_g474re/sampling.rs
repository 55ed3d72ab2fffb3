//! What the ADC samples at every trigger of TIM6: three channels, oversampled, by injected conversions.

use embassy_stm32::Peri;
use embassy_stm32::adc::{Adc, AdcConfig, AnyAdcChannel, Exten, InjectedAdc, SampleTime};
use embassy_stm32::pac;
use embassy_stm32::peripherals::ADC1;
use embassy_stm32::triggers::TIM6_TRGO;
use estimator_core::AdcCode;
use firmware::rate::TICK_HZ;

/// The largest code: a sum of 16 conversions of 12 bits, or what stands for one.
pub const FULL_SCALE: u16 = SCALE * 4095;
/// From the trigger to the interrupt, cycles, and a little for its entry: for each of the channels so many times 60
/// clocks of the ADC, each four of the core's.
pub const CYCLES: u32 = CHANNELS as u32 * OVERSAMPLED as u32 * 60 * 4 + 100;
/// Conversions of 12 bits that the ADC adds up: so many that a tick of this rate has the time that tables are admitted
/// for, between the last channel's end and the DAC's need. All channels are read at every rate.
pub const OVERSAMPLED: u16 = match TICK_HZ {
    ..=2_000 => 16,
    2_001..=5_000 => 8,
    _ => 4,
};
/// `OVSR`: the ratio is 2 to this plus one.
const RATIO: u8 = OVERSAMPLED.ilog2() as u8 - 1;
/// A code is so many times one of 12 bits.
const SCALE: u16 = 16;
/// Monitor, sensor, set-point.
const CHANNELS: usize = 3;

/// The ADC, whose injected conversions run.
pub type Converter = InjectedAdc<'static, ADC1, CHANNELS>;

/// The ADC, oversampled, before anything is injected.
pub fn converter(adc1: Peri<'static, ADC1>) -> Adc<'static, ADC1> {
    let adc = Adc::new(adc1, AdcConfig { oversampling_ratio: Some(RATIO), ..AdcConfig::default() });
    // The regular conversions begin anew where the injected ones come between: so it is where both are oversampled.
    pac::ADC1.cfgr2().modify(|w| {
        w.set_rovse(true);
        w.set_jovse(true);
    });
    adc
}

/// Has the channels converted at every trigger; its interrupt is that of the sequence's end.
pub fn start(adc: Adc<'static, ADC1>, channels: [AnyAdcChannel<'static, ADC1>; CHANNELS]) -> Converter {
    let channels = channels.map(|channel| (channel, SampleTime::CYCLES47_5));
    adc.setup_injected_conversions(channels, TIM6_TRGO, Exten::RISING_EDGE, true)
}

/// The channels' codes, of the sequence that has ended.
pub fn codes(converter: &mut Converter) -> [AdcCode; CHANNELS] {
    converter.read_injected_samples().map(|sum| AdcCode(SCALE / OVERSAMPLED * sum))
}
