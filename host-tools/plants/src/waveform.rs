//! Commanded voltages. All start at 0 V; an offset is moved to in the first 0.2 s.

use super::draw::Draw;
use super::hysteresis::STEP_S;
use std::f64::consts::{PI, TAU};

/// Time in which an offset, or a multisine, comes up, s.
const RISE_S: f64 = 0.2;

/// A commanded voltage over time. Voltages in V, frequencies in Hz, times in s.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Waveform {
    /// A sine about an offset.
    Sine {
        /// Largest distance from the offset, or from 0 V where there is none, V.
        amplitude: f64,
        /// Periods a second, Hz.
        hertz: f64,
        /// Voltage about which it goes, V.
        offset: f64,
    },
    /// A triangle about an offset.
    Triangle {
        /// Largest distance from the offset, or from 0 V where there is none, V.
        amplitude: f64,
        /// Periods a second, Hz.
        hertz: f64,
        /// Voltage about which it goes, V.
        offset: f64,
    },
    /// A sine whose amplitude swells between 10 and 100 % by another.
    AmplitudeModulated {
        /// Amplitude where it has swollen most, V.
        amplitude: f64,
        /// Frequency of the carrier, Hz.
        hertz: f64,
        /// Frequency at which the amplitude swells, Hz.
        swell_hz: f64,
    },
    /// Steps from 0 up to the amplitude, down to its negative and back, each held.
    Staircase {
        /// Largest distance from the offset, or from 0 V where there is none, V.
        amplitude: f64,
        /// Steps to the amplitude.
        steps: u32,
        /// How long each is held.
        hold_s: f64,
    },
    /// Tones evenly apart in the logarithm of the frequency, each with a phase of the seed, together of this amplitude.
    Multisine {
        /// Largest voltage either way, V.
        amplitude: f64,
        /// Frequency of the lowest tone, Hz.
        from_hz: f64,
        /// Frequency of the highest tone, Hz.
        to_hz: f64,
        /// Number of tones.
        tones: u32,
    },
    /// A sine that dies away.
    Decaying {
        /// Amplitude at first.
        amplitude: f64,
        /// Periods a second, Hz.
        hertz: f64,
        /// Time in which the amplitude falls to 1/e, s.
        tau_s: f64,
    },
    /// Moves between drawn voltages, each followed by a rest.
    MoveAndRest {
        /// Largest voltage either way, V.
        amplitude: f64,
        /// How long a move takes.
        move_s: f64,
        /// How long a rest.
        rest_s: f64,
    },
    /// A jump from 0 V to a voltage, which then stands.
    Step {
        /// The voltage that it jumps to, V.
        amplitude: f64,
        /// Time of the jump, s.
        at_s: f64,
    },
}

impl Waveform {
    /// The command (V) at steps of [`STEP_S`] for so many s. The seed draws phases and targets.
    pub fn command(&self, duration_s: f64, seed: u64) -> Vec<f64> {
        let count = (duration_s / STEP_S).round() as usize;
        let every = |at: &dyn Fn(f64) -> f64| (0..count).map(|k| at(k as f64 * STEP_S)).collect::<Vec<f64>>();
        let sine = |hertz: f64, t: f64| libm::sin(TAU * (hertz * t).fract());
        match *self {
            Self::Sine { amplitude, hertz, offset } => every(&|t| offset * rising(t) + amplitude * sine(hertz, t)),
            Self::Triangle { amplitude, hertz, offset } => {
                every(&|t| offset * rising(t) + amplitude * triangle((hertz * t).fract()))
            }
            Self::AmplitudeModulated { amplitude, hertz, swell_hz } => {
                every(&|t| amplitude * (0.55 - 0.45 * libm::cos(TAU * swell_hz * t)) * sine(hertz, t))
            }
            Self::Staircase { amplitude, steps, hold_s } => every(&|t| {
                let (step, round) = ((t / hold_s) as u32, 4 * steps.max(1));
                let phase = f64::from(step % round) / f64::from(round);
                amplitude * triangle(phase)
            }),
            Self::Multisine { amplitude, from_hz, to_hz, tones } => {
                let mut draw = Draw::new(seed ^ 0x6d75_6c74_6973_696e);
                let tones: Vec<(f64, f64)> = (0..tones)
                    .map(|k| {
                        let at = f64::from(k) / f64::from((tones - 1).max(1));
                        (from_hz * libm::pow(to_hz / from_hz, at), TAU * draw.normal())
                    })
                    .collect();
                let sum = every(&|t| {
                    rising(t) * tones.iter().map(|(hertz, phase)| libm::sin(TAU * hertz * t + phase)).sum::<f64>()
                });
                let most = sum.iter().fold(f64::MIN_POSITIVE, |most, volts| most.max(volts.abs()));
                sum.into_iter().map(|volts| amplitude * volts / most).collect()
            }
            Self::Decaying { amplitude, hertz, tau_s } => {
                every(&|t| amplitude * libm::exp(-t / tau_s) * sine(hertz, t))
            }
            Self::MoveAndRest { amplitude, move_s, rest_s } => {
                let mut draw = Draw::new(seed ^ 0x6d6f_7665);
                let cycles = (duration_s / (move_s + rest_s)).ceil() as usize + 1;
                let targets: Vec<f64> = std::iter::once(0.0)
                    .chain((0..cycles).map(|_| amplitude * (0.7 * draw.normal()).clamp(-1.0, 1.0)))
                    .collect();
                every(&|t| {
                    let cycle = (t / (move_s + rest_s)) as usize;
                    let part = ((t - cycle as f64 * (move_s + rest_s)) / move_s).min(1.0);
                    let (from, to) = (targets[cycle], targets[cycle + 1]);
                    from + (to - from) * 0.5 * (1.0 - libm::cos(PI * part))
                })
            }
            Self::Step { amplitude, at_s } => every(&|t| if t < at_s { 0.0 } else { amplitude }),
        }
    }
}

/// From 0 to 1 in the first 0.2 s.
fn rising(t: f64) -> f64 {
    0.5 * (1.0 - libm::cos(PI * (t / RISE_S).min(1.0)))
}

/// A triangle of amplitude 1 that starts at 0, rising, by its phase from 0 to 1.
fn triangle(phase: f64) -> f64 {
    match phase {
        phase if phase < 0.25 => 4.0 * phase,
        phase if phase < 0.75 => 2.0 - 4.0 * phase,
        phase => 4.0 * phase - 4.0,
    }
}
