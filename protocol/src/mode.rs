//! What the tick can be told to do.

use serde::{Deserialize, Serialize};

/// What the tick does. A mode other than [`Mode::Estimate`], [`Mode::Linearise`] and [`Mode::Waveform`] lasts while
/// sound frames come: five seconds after the last one the device estimates again, but in [`Mode::Follow`] while it
/// holds a displacement that is to be held.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Mode {
    /// Estimates from the ADC; the DAC follows.
    #[default]
    Estimate,
    /// Estimates from codes fed over the link (processor in the loop), one a tick, none where there is none; the
    /// DAC is safe.
    Pil,
    /// Estimates nothing; the DAC is safe.
    Pause,
    /// Estimates from the ADC, while the DAC drives the amplifier to where the references want the displacement, one a
    /// tick, the last one where there is none; at rest before the first. A fault, or a second without references, sends
    /// it back to rest, and there it stays until the mode is set again.
    Follow,
    /// As [`Mode::Follow`], but the references are voltages of the amplifier: the DAC drives it to what they say,
    /// within the drive's range and slew rate, and the sensor's channel is read beside the estimate. So an actuator is
    /// measured that no table knows yet.
    Excite,
    /// As [`Mode::Follow`], but each tick's reference is what the set-point's channel of the ADC says by the table's
    /// calibration, and no host is needed: the mode lasts. It goes to rest and waits there until everything has been
    /// sound for a second. A fault while it drives, the set-point's own among them, sends it back to rest, and there it
    /// stays until the mode is set again.
    Linearise,
    /// As [`Mode::Follow`], but the references are a waveform's from the device's memory
    /// ([`Request::Play`](crate::Request::Play) enters the mode), and no host is needed: the mode lasts. After the last
    /// line, and by a fault, the voltage goes back to rest, and there it stays until a mode is set.
    Waveform,
}

impl Mode {
    /// Whether it estimates from what the ADC reads. From one such mode to another the estimate goes on, with its
    /// memory and its bias; any other change begins it anew, and so does the end of a fault that it suffers from (of
    /// the set-point, or of a main loop that stood still, it does not).
    pub const fn measures(self) -> bool {
        !matches!(self, Self::Pil | Self::Pause)
    }

    /// Whether the DAC drives the amplifier in this mode.
    pub const fn drives(self) -> bool {
        matches!(self, Self::Linearise | Self::Waveform) || self.takes_references()
    }

    /// Whether it does so by references that the host sends.
    pub const fn takes_references(self) -> bool {
        matches!(self, Self::Follow | Self::Excite)
    }

    /// Whether it lasts without a word from the host.
    pub const fn lasts(self) -> bool {
        matches!(self, Self::Estimate | Self::Linearise | Self::Waveform)
    }

    /// The mode whose number (`mode as u8`) this is; `None` where it is none's.
    pub fn from_number(number: u8) -> Option<Self> {
        [Self::Estimate, Self::Pil, Self::Pause, Self::Follow, Self::Excite, Self::Linearise, Self::Waveform]
            .into_iter()
            .find(|&mode| mode as u8 == number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_found_by_its_number_and_nothing_else_is_one() {
        let modes: Vec<Mode> = (0..=u8::MAX).filter_map(Mode::from_number).collect();
        let all = [Mode::Estimate, Mode::Pil, Mode::Pause, Mode::Follow, Mode::Excite, Mode::Linearise, Mode::Waveform];
        assert_eq!(modes, all);
        assert!(modes.iter().all(|&mode| Mode::from_number(mode as u8) == Some(mode)));
    }
}
