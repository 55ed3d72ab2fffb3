//! How the device is, and what became of it.

use crate::faults::Faults;
use crate::mode::Mode;
use crate::text::LastWords;
use serde::{Deserialize, Serialize};

bitflags::bitflags! {
    /// The causes of the last start; several may be set. All but [`Self::ASKED`] are those of the chip's reset
    /// register.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
    pub struct ResetCause: u8 {
        /// Power came, or sagged below the brown-out threshold and came back.
        const BROWN_OUT = 1 << 0;
        /// The reset pin, or a debug probe.
        const PIN = 1 << 1;
        /// The firmware itself, as it was asked or after a panic; or a debug probe.
        const SOFTWARE = 1 << 2;
        /// The independent watchdog: ticks had stopped, or the main loop had.
        const WATCHDOG = 1 << 3;
        /// Anything else (option bytes, window watchdog, illegal low-power entry).
        const OTHER = 1 << 4;
        /// Beside [`Self::SOFTWARE`]: asked over the link.
        const ASKED = 1 << 5;
    }
}

/// Everything that is counted or kept.
#[derive(Clone, PartialEq, Debug, Serialize, Deserialize)]
pub struct Health {
    /// What the tick does with each conversion.
    pub mode: Mode,
    /// Ticks since start, of any mode, modulo 2³²: 24.9 days at 2 kHz, after which it counts from 0 again.
    pub ticks: u32,
    /// What lasts of what went wrong, or did until less than a second ago.
    pub faults: Faults,
    /// What has been wrong since start or the last [`crate::Request::Forget`]; where the DAC stood is not among it.
    pub faults_seen: Faults,
    /// Causes of the last start.
    pub reset: ResetCause,
    /// What the firmware said before a panic or hard fault made it start again.
    pub last_words: Option<LastWords>,
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
    /// Ticks with the wanted displacement, or voltage, out of reach.
    pub out_of_reach: u32,
    /// Samples that the link could not carry away.
    pub samples_dropped: u32,
    /// Frames refused by the device.
    pub frames_refused: u32,
    /// Errors of the serial line (overrun, framing, noise, and what could not be sent).
    pub line_errors: u32,
    /// Flash words that could not be corrected, as a power cut during a write leaves them.
    pub flash_errors: u32,
    /// What is added to the model's displacement, µm; 0 where nothing was told.
    pub bias_um: f32,
    /// Ticks since the bias was told, at most [`Self::OLDEST_BIAS_TICKS`]; `None` where it was not since
    /// the estimate began.
    pub bias_age_ticks: Option<u32>,
    /// Analogue supply when it was measured last, mV; `None` where the board cannot tell.
    pub supply_mv: Option<u16>,
    /// The level of the brown-out reset by the chip's option bytes, BOR_LEV: 0 to 4 for about 1.7, 2.0, 2.2, 2.5 and
    /// 2.8 V; `None` where the board has none.
    pub brown_out_level: Option<u8>,
    /// What the converter last read at the set-point ([`estimator_core::AdcCode`]), corrected for the supply where the
    /// board measures it and the table has a set-point; `None` where the board has no such channel.
    pub setpoint: Option<u16>,
    /// Lines begun of the waveform that was played last.
    pub lines: u32,
    /// Edges at the trigger input that began no line of it: on the way to the first point, or during a line.
    pub triggers_ignored: u32,
}

impl Health {
    /// The age at which a bias grows no older: it may have been told longer ago.
    pub const OLDEST_BIAS_TICKS: u32 = u32::MAX - 1;
}
