//! How the device is, and what became of it.

use crate::Text;
use crate::message::Mode;
use serde::{Deserialize, Serialize};

bitflags::bitflags! {
    /// What is wrong on the device now. While [`Faults::SAFE_OUTPUT`] is among them, the DAC stands at its safe value.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
    pub struct Faults: u8 {
        /// The ADC has stood at an end of its range: a broken divider, a wrong offset, or an open input.
        const ADC_SATURATED = 1 << 0;
        /// The ADC has given one and the same code: a converter or an input that has stopped.
        const ADC_STUCK = 1 << 1;
        /// The voltage has been beyond what the table was identified on: the calibration is not that of this divider.
        const OUT_OF_CALIBRATION = 1 << 2;
        /// A tick came late or not at all, or was not done in time for its output.
        const MISSED_DEADLINE = 1 << 3;
        /// The analogue supply, which is the converters' reference, was out of tolerance at boot.
        const SUPPLY = 1 << 4;
        /// There is no admissible table, so nothing is estimated.
        const NO_TABLE = 1 << 5;
        /// A stored table could not be used, so another one is.
        const TABLE_FALLBACK = 1 << 6;
        /// The DAC stands at its safe value, or is on its way there: by a fault, or because nothing is put out in this mode.
        const SAFE_OUTPUT = 1 << 7;
    }
}

impl Faults {
    /// The faults that send the DAC to its safe value. With a table that is not the one stored nobody knows what the DAC is
    /// wired to.
    pub const UNSAFE: Self = Self::ADC_SATURATED
        .union(Self::ADC_STUCK)
        .union(Self::OUT_OF_CALIBRATION)
        .union(Self::SUPPLY)
        .union(Self::NO_TABLE)
        .union(Self::TABLE_FALLBACK);
}

bitflags::bitflags! {
    /// Why the device started.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
    pub struct ResetCause: u8 {
        /// Power came, or sagged below the brown-out threshold and came back.
        const BROWN_OUT = 1 << 0;
        /// The reset pin, or a debug probe.
        const PIN = 1 << 1;
        /// The firmware itself: asked over the link, or after a panic.
        const SOFTWARE = 1 << 2;
        /// The independent watchdog: ticks had stopped, or the main loop had.
        const WATCHDOG = 1 << 3;
        /// Anything else (option bytes, window watchdog, illegal low-power entry).
        const OTHER = 1 << 4;
    }
}

/// Everything that is counted or kept.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Health {
    /// What the tick does.
    pub mode: Mode,
    /// Ticks since start, of any mode.
    pub ticks: u32,
    /// What is wrong now.
    pub faults: Faults,
    /// What has been wrong since start or the last [`crate::Request::Forget`]; where the DAC stood is not among it.
    pub faults_seen: Faults,
    /// Why the device started.
    pub reset: ResetCause,
    /// What the firmware said before a panic or hard fault made it start again.
    pub last_words: Option<Text<160>>,
    /// Processor cycles that the last tick took.
    pub cycles_last: u32,
    /// The most that one took.
    pub cycles_max: u32,
    /// Processor cycles from tick to tick.
    pub cycles_period: u32,
    /// Ticks that came late or not at all, or were not done in time for their output.
    pub missed: u32,
    /// Ticks with the ADC at an end of its range.
    pub adc_saturated: u32,
    /// Ticks with the voltage beyond the table's range.
    pub voltage_out_of_range: u32,
    /// Ticks with the displacement clamped.
    pub clamped: u32,
    /// Ticks with the DAC at an end of its range.
    pub dac_saturated: u32,
    /// Ticks with the wanted displacement out of reach.
    pub out_of_reach: u32,
    /// Samples that the link could not carry away.
    pub samples_dropped: u32,
    /// Frames refused by the device.
    pub frames_refused: u32,
    /// Errors of the serial line (overrun, framing, noise).
    pub line_errors: u32,
    /// Flash words that could not be corrected, as a power cut during a write leaves them.
    pub flash_errors: u32,
    /// Analogue supply at boot, mV; `None` where the board cannot tell.
    pub supply_mv: Option<u16>,
}
