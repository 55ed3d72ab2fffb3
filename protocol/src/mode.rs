//! What the tick can be told to do.

use serde::{Deserialize, Serialize};

/// What the tick does. A mode other than [`Mode::Estimate`] lasts while sound frames come: five seconds after the last one the
/// device estimates again, but for a [`Mode::Follow`] that holds a reference which is to be held for ever.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
pub enum Mode {
    /// Estimates from the ADC; the DAC follows.
    #[default]
    Estimate,
    /// Estimates from codes fed over the link (processor in the loop), one a tick, none where there is none; the DAC is safe.
    Pil,
    /// Estimates nothing; the DAC is safe.
    Pause,
    /// Estimates from the ADC, while the DAC drives the amplifier to where the references want the displacement, one a tick, the
    /// last one where there is none; at rest before the first. A fault, or a second without references, sends it back to rest,
    /// and there it stays until the mode is set again.
    Follow,
}

impl Mode {
    /// The mode whose number (`mode as u8`) this is; `None` where it is none's.
    pub fn from_number(number: u8) -> Option<Self> {
        [Self::Estimate, Self::Pil, Self::Pause, Self::Follow].into_iter().find(|&mode| mode as u8 == number)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_is_found_by_its_number_and_nothing_else_is_one() {
        let modes: Vec<Mode> = (0..=u8::MAX).filter_map(Mode::from_number).collect();
        assert_eq!(modes, [Mode::Estimate, Mode::Pil, Mode::Pause, Mode::Follow]);
        assert!(modes.iter().all(|&mode| Mode::from_number(mode as u8) == Some(mode)));
    }
}
