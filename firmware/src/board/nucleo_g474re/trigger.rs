//! Timers whose update is another peripheral's trigger.

use embassy_stm32::Peri;
use embassy_stm32::pac::timer::vals::Mms;
use embassy_stm32::timer::BasicInstance;
use embassy_stm32::timer::low_level::Timer;

/// A timer, not started, with its trigger output at exactly so many hertz.
pub fn at_rate<T: BasicInstance>(timer: Peri<'static, T>, hz: u32) -> Timer<'static, T> {
    let timer = Timer::new(timer);
    let registers = timer.regs_basic();
    // The smallest prescaler with which 16 bits count a period to the very clock.
    let clocks = timer.get_clock_frequency().0 / hz;
    let prescaler = (1..=16).find(|by| clocks.is_multiple_of(*by) && clocks / by <= 1 << 16).unwrap_or(1);
    registers.psc().write_value((prescaler - 1) as u16);
    registers.arr().write(|w| w.set_arr((clocks / prescaler - 1) as u16));
    // Loads the prescaler; without it the first period is too short.
    timer.generate_update_event();
    registers.cr2().modify(|w| w.set_mms(Mms::UPDATE));
    // Of the registers, because `get_frequency` of embassy-stm32 0.6 divides by one count too few.
    let counts = (u32::from(registers.psc().read()) + 1) * (u32::from(registers.arr().read().arr()) + 1);
    assert!(counts * hz == timer.get_clock_frequency().0, "a timer does not reach {hz} Hz: {counts} counts");
    timer
}
