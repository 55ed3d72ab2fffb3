//! The analogue supply, which is the converters' reference, by the chip's own reference (RM0440,
//! "Internal voltage reference").

use core::ptr::addr_of;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::adc::{Adc, SampleTime};
use embassy_stm32::pac;
use embassy_stm32::peripherals::ADC1;

use super::clocks::CORE_HZ;
use super::sampling::OVERSAMPLED;

/// Supply at which the factory calibrated, mV.
const CALIBRATED_MV: f32 = 3000.0;

/// Whether a conversion was seen to begin.
static BEGUN: AtomicBool = AtomicBool::new(false);

unsafe extern "C" {
    /// A symbol of memory.x: its address is meant.
    static __vrefint_calibration: u16;
}

/// Measures it before the injected conversions go on, mV.
pub fn at_start(adc: &mut Adc<'static, ADC1>) -> f32 {
    let mut reference = adc.enable_vrefint();
    // Its buffer needs 12 µs.
    cortex_m::asm::delay(CORE_HZ / 50_000);
    in_mv(adc.blocking_read(&mut reference, SampleTime::CYCLES247_5))
}

/// Measures it while they go on, which come first, mV: of the conversion that the call before has begun; `None` where
/// that has not ended, or never began, since what the register then has is of an earlier one. The reference is still
/// the one regular channel.
///
/// The hardware takes ADSTART back at the end of a conversion that software has started. (The flag EOC would not do:
/// the tick takes that back, with its own.)
pub fn measure() -> Option<f32> {
    let ended = BEGUN.load(Relaxed) && !pac::ADC1.cr().read().adstart();
    let mv = ended.then(|| in_mv(pac::ADC1.dr().read().rdata()));
    let begun = critical_section::with(|_| {
        pac::ADC1.cr().modify(|w| w.set_adstart(true));
        // No tick lies between, and so no end.
        pac::ADC1.cr().read().adstart()
    });
    BEGUN.store(begun, Relaxed);
    mv
}

/// The supply at which the reference gives this code, mV.
fn in_mv(code: u16) -> f32 {
    // SAFETY: the factory's calibration word, in read-only memory.
    let calibration = unsafe { addr_of!(__vrefint_calibration).read_volatile() };
    // The code is a sum of conversions; the factory's is of one.
    CALIBRATED_MV * OVERSAMPLED as f32 * f32::from(calibration) / f32::from(code.max(1))
}
