//! From reset to 170 MHz: 24 MHz / 6 · 85 / 2, by the way that ST's manual prescribes and its HAL goes (RM0440,
//! "Dynamic voltage scaling management"): boost on, wait states, the system clock switched with the core at half of it,
//! and all of it a microsecond later.
//!
//! embassy-stm32 0.6 goes another: it asks for boost with bit 0 of PWR_CR5, where the manual and ST's headers have bit
//! 8, so that there is none, and it switches from 16 to 170 MHz in one step. It is told half the core's clock here, and
//! this module does the rest behind it. What it then takes the clocks to be stays true for all but the core itself:
//! when the core goes to twice, the buses' dividers do, too, so that the timers keep their 85 MHz; ADC and LPUART run
//! on the system clock, which is 170 MHz throughout.
//!
//! A crystal that does not start leaves the chip at the same speed by its own oscillator, 16 MHz / 4 · 85 / 2, so that
//! the link is there to say so; one that stops later is the clock security system's: the hardware goes on at 16 MHz,
//! and its NMI ([`super::failure`]) ends the run.

use embassy_stm32::pac::{self, flash::vals::Latency};
use embassy_stm32::rcc::{
    self, AHBPrescaler, APBPrescaler, Hse, HseMode, Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk,
    mux::{Adcsel, Uartsel},
};
use embassy_stm32::time::Hertz;
use embassy_stm32::{Config, Peripherals};

/// The core's clock.
pub const CORE_HZ: u32 = 170_000_000;
/// PWR_CR5's R1MODE: range 1 without boost.
const R1MODE: u32 = 1 << 8;

/// The chip's own oscillator, to within 2 %.
const OWN_HZ: u32 = 16_000_000;
/// How long a crystal may take to start, ms: fifty times what is usual, and a fifth of what the watchdog waits.
const STARTS_WITHIN_MS: u32 = 100;

/// Brings the chip to 170 MHz, and says whether by the crystal.
pub fn start() -> (Peripherals, bool) {
    let mut config = Config::default();
    // The cycle counter must go on while the core sleeps, or lost ticks would not be seen.
    config.enable_debug_during_sleep = true;
    // At 16 MHz: this resets PWR, so that boost cannot be switched on before.
    let mut p = embassy_stm32::init(config);
    pac::PWR.cr5().modify(|w| w.0 &= !R1MODE);
    let crystal = crystal_starts();
    rcc::reinit(half_speed(crystal), &mut p.RCC);
    full_speed();
    (p, crystal)
}

/// Switches the crystal on, and has it watched from its start on. The driver would wait for ever for one that
/// does not start.
fn crystal_starts() -> bool {
    const POLLS_A_MS: u32 = 100;
    pac::RCC.cr().modify(|w| w.set_hseon(true));
    for _ in 0..STARTS_WITHIN_MS * POLLS_A_MS {
        if pac::RCC.cr().read().hserdy() {
            pac::RCC.cr().modify(|w| w.set_csson(true));
            return true;
        }
        cortex_m::asm::delay(OWN_HZ / 1_000 / POLLS_A_MS);
    }
    pac::RCC.cr().modify(|w| w.set_hseon(false));
    false
}

/// The core's clock as it is: that of [`start`], or the own oscillator's where the crystal has stopped.
pub fn core_hz() -> u32 {
    if pac::RCC.cfgr().read().sws() == Sysclk::PLL1_R { CORE_HZ } else { OWN_HZ }
}

/// Whether the crystal has stopped; not any more after this.
pub fn crystal_stopped() -> bool {
    let stopped = pac::RCC.cifr().read().cssf();
    if stopped {
        pac::RCC.cicr().write(|w| w.set_cssc(true));
    }
    stopped
}

/// The system clock at 170 MHz, the core at 85, the timers at 85.
fn half_speed(crystal: bool) -> rcc::Config {
    let mut config = rcc::Config::new();
    config.hse = crystal.then_some(Hse { freq: Hertz(24_000_000), mode: HseMode::Oscillator });
    let (source, prediv) = if crystal { (PllSource::HSE, PllPreDiv::DIV6) } else { (PllSource::HSI, PllPreDiv::DIV4) };
    config.pll = Some(Pll { source, prediv, mul: PllMul::MUL85, divp: None, divq: None, divr: Some(PllRDiv::DIV2) });
    config.sys = Sysclk::PLL1_R;
    config.boost = true;
    config.ahb_pre = AHBPrescaler::DIV2;
    // Timers run at twice a divided bus's clock.
    config.apb1_pre = APBPrescaler::DIV2;
    config.apb2_pre = APBPrescaler::DIV2;
    config.mux.adc12sel = Adcsel::SYS;
    config.mux.lpuart1sel = Uartsel::SYS;
    config
}

/// The core at 170 MHz, the buses and the timers as before.
fn full_speed() {
    pac::FLASH.acr().modify(|w| w.set_latency(Latency::WS4));
    while pac::FLASH.acr().read().latency() != Latency::WS4 {}
    // A microsecond at 170 MHz, two at half of it.
    cortex_m::asm::delay(CORE_HZ / 1_000_000);
    pac::RCC.cfgr().modify(|w| {
        w.set_hpre(AHBPrescaler::DIV1);
        w.set_ppre1(APBPrescaler::DIV4);
        w.set_ppre2(APBPrescaler::DIV4);
    });
}

/// Tells the DAC, which is on the core's bus, that its clock is above 160 MHz: its driver takes it for half. Its
/// channel puts nothing on a pin yet.
pub fn tell_dac() {
    pac::DAC1.mcr().modify(|w| w.set_hfsel(0b10));
}
