//! What the training logs can teach: how many reversals they have, at how many frequencies and amplitudes.

use crate::session::Session;
use estimator_core::Tracker;

/// What was found in the training logs' voltage.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Character {
    /// Reversals, all logs together.
    pub reversals: usize,
    /// Shortest and longest half cycle, s; `None` with fewer than two reversals in every log.
    pub half_cycle_s: Option<(f64, f64)>,
    /// Smallest and largest swing between two reversals, V; `None` as above.
    pub swing_v: Option<(f64, f64)>,
}

/// Reversals smaller than this fraction of the whole span are noise here.
const SMALLEST_SWING: f64 = 0.02;
/// Half cycles (or swings) whose extremes differ by less than this factor count as one frequency (or amplitude).
const ONE: f64 = 1.25;

impl Character {
    /// Looks at the voltages of some sessions.
    pub fn of<'a>(sessions: impl Iterator<Item = &'a Session> + Clone) -> Self {
        let voltages = || sessions.clone().flat_map(|session| &session.voltage);
        let span = voltages().fold(f64::MIN, |a, &b| a.max(b)) - voltages().fold(f64::MAX, |a, &b| a.min(b));
        let mut character = Self { reversals: 0, half_cycle_s: None, swing_v: None };
        for session in sessions {
            // The tracker records the displacement at the extreme; here that is the time.
            let mut tracker = Tracker::new(SMALLEST_SWING * span);
            let mut previous: Option<(f64, f64)> = None;
            for (tick, &voltage) in session.voltage.iter().enumerate() {
                if !tracker.update(voltage, tick as f64 * session.tick_s) {
                    continue;
                }
                character.reversals += 1;
                let (at, volts) = (tracker.last().displacement, tracker.last().voltage);
                if let Some((before, from)) = previous {
                    widen(&mut character.half_cycle_s, at - before);
                    widen(&mut character.swing_v, (volts - from).abs());
                }
                previous = Some((at, volts));
            }
        }
        character
    }

    /// Whether all half cycles last about the same. A hold makes a half cycle longer, and so another frequency.
    pub fn single_frequency(&self) -> bool {
        self.half_cycle_s.is_none_or(|(min, max)| max < ONE * min)
    }

    /// Whether all swings are about as large.
    pub fn single_amplitude(&self) -> bool {
        self.swing_v.is_none_or(|(min, max)| max < ONE * min)
    }
}

fn widen(range: &mut Option<(f64, f64)>, value: f64) {
    let (min, max) = range.unwrap_or((value, value));
    *range = Some((min.min(value), max.max(value)));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn session(voltage: Vec<f64>) -> Session {
        let count = voltage.len() as u32;
        Session::new("x".into(), voltage, (0..count).collect(), vec![0.0; count as usize], 1e-3)
    }

    fn sine(amplitude: f64, hertz: f64) -> Session {
        session((0..2000).map(|k| amplitude * (std::f64::consts::TAU * hertz * 1e-3 * f64::from(k)).sin()).collect())
    }

    #[test]
    fn one_sine_is_one_frequency_and_one_amplitude() {
        let sessions = [sine(20.0, 5.0)];
        let character = Character::of(sessions.iter());
        assert_eq!(character.reversals, 20);
        assert!(character.single_amplitude() && character.single_frequency());
    }

    #[test]
    fn two_frequencies_and_two_amplitudes_are_seen() {
        let frequencies = [sine(20.0, 5.0), sine(20.0, 50.0)];
        let character = Character::of(frequencies.iter());
        assert!(character.single_amplitude() && !character.single_frequency());
        let amplitudes = [sine(20.0, 5.0), sine(10.0, 5.0)];
        let character = Character::of(amplitudes.iter());
        assert!(!character.single_amplitude() && character.single_frequency());
    }

    #[test]
    fn a_ramp_teaches_no_reversal() {
        let ramp = [session((0..100).map(f64::from).collect())];
        assert_eq!(Character::of(ramp.iter()), Character { reversals: 0, half_cycle_s: None, swing_v: None });
    }
}
