//! The analogue supply, which is the converters' reference, by the chip's own reference (RM0440, "Internal voltage reference").

use core::ptr::addr_of;

use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::pac;
use embassy_stm32::peripherals::ADC1;

use super::CORE_HZ;

/// What converters, divider and calibration are made for, mV, and how far off it may be: 5 %.
const MADE_FOR_MV: u16 = 3300;
const TOLERANCE_MV: u16 = 165;
/// Supply at which the factory calibrated, mV.
const CALIBRATED_MV: u32 = 3000;

unsafe extern "C" {
    /// A symbol of memory.x: its address is meant.
    static __vrefint_calibration: u16;
}

/// Whether so many mV are within tolerance.
pub fn good(mv: u16) -> bool {
    mv.abs_diff(MADE_FOR_MV) <= TOLERANCE_MV
}

/// Measures it before the injected conversions go on, mV.
pub fn at_start(adc: &mut Adc<'static, ADC1>) -> u16 {
    let mut reference = adc.enable_vrefint();
    // Its buffer needs 12 µs.
    cortex_m::asm::delay(CORE_HZ / 50_000);
    in_mv(adc.blocking_read(&mut reference, SampleTime::CYCLES247_5))
}

/// Measures it while they go on, which come first, mV: of the conversion that the call before has begun. The reference is still
/// the one regular channel.
pub fn measure() -> u16 {
    let code = pac::ADC1.dr().read().rdata();
    pac::ADC1.cr().modify(|w| w.set_adstart(true));
    in_mv(code)
}

/// The supply at which the reference gives this code, mV.
fn in_mv(code: u16) -> u16 {
    // SAFETY: the factory's calibration word, in read-only memory.
    let calibration = unsafe { addr_of!(__vrefint_calibration).read_volatile() };
    let mv = CALIBRATED_MV * u32::from(calibration) / u32::from(code.max(1));
    mv.min(u16::MAX.into()) as u16
}
