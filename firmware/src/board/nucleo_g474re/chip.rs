//! What the chip does for the main loop, and counts.

use embassy_stm32::pac;
use firmware::Chip;

use super::{failure, line, supply};

/// The STM32G474RE, its watchdog running.
pub struct Stm32G4;

impl Chip for Stm32G4 {
    fn feed_watchdog(&self) {
        pac::IWDG.kr().write(|w| w.set_key(pac::iwdg::vals::Key::RESET));
    }

    fn measure_supply(&self) -> Option<f32> {
        supply::measure()
    }

    fn flash_errors(&self) -> u32 {
        failure::flash_errors()
    }

    fn line_errors(&self) -> u32 {
        line::errors()
    }
}
