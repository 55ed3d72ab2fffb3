//! The synthetic rig: a piezo actuator with hysteresis, creep, asymmetry, amplifier lag and sensor noise, whose
//! displacement is known. It writes the six logs of the thesis (±20 V sine and triangle at 1, 10 and 100 Hz, 2 s each).
//!
//! ```text
//! amplifier   s ← a·s + (1−a)·V,  a = exp(−2π·75 Hz/10 kHz), from V(0)
//! hysteresis  ten play operators on s, half-widths 0, 2, …, 18 V from 0, weights 0.15 µm/V for the first,
//!             then 0.012·(1.2 falling linearly to 0.6) µm/V
//! creep       three first-order states on s, τ = 0.05, 0.5, 5 s, gains 0.002, 0.002, 0.003 µm/V, explicit Euler
//! asymmetry   y = w·(1 + 0.03·w) of their sum w in µm
//! sensor      Gaussian noise, 7 nm rms, seeded a log at a time
//! ```
//!
//! The recorded voltage is the commanded one, unless voltage noise or quantisation is asked for.

use crate::log::Log;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// What can be changed of the rig. The defaults are the reference.
#[derive(Clone, Debug)]
pub struct Rig {
    /// Voltage amplitude, V.
    pub amplitude: f64,
    /// Length of a log, s.
    pub duration: f64,
    /// Samples a second, Hz.
    pub fs: f64,
    /// Cut-off frequency of the amplifier, Hz.
    pub cutoff: f64,
    /// Factor on the hysteresis (the plays wider than 0).
    pub hysteresis: f64,
    /// Factor on the creep.
    pub creep: f64,
    /// Asymmetry of the hysteresis, 1/µm.
    pub asymmetry: f64,
    /// Sensor noise, nm rms.
    pub noise_nm: f64,
    /// Noise of the recorded voltage, V rms.
    pub voltage_noise: f64,
    /// Record the voltage as a converter of this many bits over ±110 % of the amplitude would.
    pub adc_bits: Option<u8>,
    /// Seed of the noise.
    pub seed: u64,
}

impl Rig {
    /// The reference rig of the tests and figures.
    pub const DEFAULT: Self = Self {
        amplitude: 20.0,
        duration: 2.0,
        fs: 10_000.0,
        cutoff: 75.0,
        hysteresis: 1.0,
        creep: 1.0,
        asymmetry: 0.03,
        noise_nm: 7.0,
        voltage_noise: 0.0,
        adc_bits: None,
        seed: 1,
    };
}

impl Default for Rig {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// Shape of the commanded voltage.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Waveform {
    /// Starts at 0, rising.
    Sine,
    /// Starts at 0, rising.
    Triangle,
}

/// One of the thesis's logs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Excitation {
    /// Name of the log, as the thesis names its files.
    pub name: &'static str,
    /// Shape of the voltage.
    pub waveform: Waveform,
    /// Frequency of the voltage, Hz.
    pub hertz: u32,
}

/// The six logs. The 10 Hz triangle, `tr10`, is the validation log.
pub const EXCITATIONS: [Excitation; 6] = [
    Excitation { name: "sin1", waveform: Waveform::Sine, hertz: 1 },
    Excitation { name: "sin10", waveform: Waveform::Sine, hertz: 10 },
    Excitation { name: "sin100", waveform: Waveform::Sine, hertz: 100 },
    Excitation { name: "tr1", waveform: Waveform::Triangle, hertz: 1 },
    Excitation { name: "tr10", waveform: Waveform::Triangle, hertz: 10 },
    Excitation { name: "tr100", waveform: Waveform::Triangle, hertz: 100 },
];

/// Name of the log that the thesis holds out.
pub const VALIDATION: &str = "tr10";

/// What was recorded.
#[derive(Clone, PartialEq, Debug)]
pub struct Recording {
    /// Recorded voltage, V.
    pub voltage: Vec<f64>,
    /// Measured displacement, µm.
    pub displacement: Vec<f64>,
}

const PLAYS: usize = 10;
const CREEP: [(f64, f64); 3] = [(0.05, 0.002), (0.5, 0.002), (5.0, 0.003)];

/// Amplifier and actuator, a sample at a time.
struct Actuator<'r> {
    rig: &'r Rig,
    step: f64,
    keep: f64,
    amplifier: f64,
    plays: [f64; PLAYS],
    creep: [f64; CREEP.len()],
}

impl Actuator<'_> {
    /// Takes a voltage (V), returns the true displacement (µm).
    fn step(&mut self, voltage: f64) -> f64 {
        let half_width = |i: usize| 2.0 * i as f64;
        let weight = |i: usize| match i {
            0 => 0.15,
            _ => self.rig.hysteresis * 0.012 * (1.2 - 0.6 * (i - 1) as f64 / (PLAYS - 2) as f64),
        };
        self.amplifier = self.keep * self.amplifier + (1.0 - self.keep) * voltage;
        let amplifier = self.amplifier;
        let mut w = 0.0;
        for (i, play) in self.plays.iter_mut().enumerate() {
            *play = play.clamp(amplifier - half_width(i), amplifier + half_width(i));
            w += weight(i) * *play;
        }
        for (state, (tau, gain)) in self.creep.iter_mut().zip(CREEP) {
            *state += self.step / tau * (self.rig.creep * gain * amplifier - *state);
            w += *state;
        }
        w * (1.0 + self.rig.asymmetry * w)
    }
}

impl Rig {
    /// Records one log.
    pub fn record(&self, excitation: Excitation) -> Recording {
        let count = (self.duration * self.fs).round() as usize;
        let step = 1.0 / self.fs;
        let mut noise = self.noise(excitation);
        let mut actuator = self.actuator(self.command(excitation, 0.0));
        let mut recording = Recording { voltage: Vec::with_capacity(count), displacement: Vec::with_capacity(count) };
        for k in 0..count {
            let voltage = self.command(excitation, k as f64 * step);
            let displacement = actuator.step(voltage);
            let (sensor, reading) = noise();
            recording.displacement.push(displacement + 1e-3 * self.noise_nm * sensor);
            recording.voltage.push(self.quantised(voltage + self.voltage_noise * reading));
        }
        recording
    }

    /// True displacements (µm) at ticks of so many samples, where each voltage (V) stands for a tick, from rest at 0 V.
    pub fn respond(&self, voltages: &[f64], samples: usize) -> Vec<f64> {
        let mut actuator = self.actuator(0.0);
        let mut tick = |&voltage: &f64| {
            let first = actuator.step(voltage);
            (1..samples).for_each(|_| {
                actuator.step(voltage);
            });
            first
        };
        voltages.iter().map(&mut tick).collect()
    }

    /// The actuator behind an amplifier that stands at a voltage (V).
    fn actuator(&self, amplifier: f64) -> Actuator<'_> {
        let step = 1.0 / self.fs;
        let keep = libm::exp(-TAU * self.cutoff * step);
        Actuator { rig: self, step, keep, amplifier, plays: [0.0; PLAYS], creep: [0.0; CREEP.len()] }
    }

    /// The recording as a log.
    pub fn log(&self, excitation: Excitation) -> Log {
        let Recording { voltage, displacement } = self.record(excitation);
        Log {
            name: excitation.name.to_owned(),
            path: excitation.name.into(),
            // In place of the bytes of a file, by which one log is told from another.
            sha256: format!("rig {} {}", self.seed, excitation.name),
            start_s: 0.0,
            sample_period: 1.0 / self.fs,
            voltage,
            displacement: Some(displacement),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    /// The commanded voltage at a time in s.
    fn command(&self, excitation: Excitation, seconds: f64) -> f64 {
        let phase = (seconds * f64::from(excitation.hertz)).fract();
        self.amplitude
            * match excitation.waveform {
                Waveform::Sine => libm::sin(TAU * phase),
                Waveform::Triangle if phase < 0.25 => 4.0 * phase,
                Waveform::Triangle if phase < 0.75 => 2.0 - 4.0 * phase,
                Waveform::Triangle => 4.0 * phase - 4.0,
            }
    }

    fn quantised(&self, voltage: f64) -> f64 {
        let Some(bits) = self.adc_bits else { return voltage };
        let half = 1.1 * self.amplitude;
        let step = 2.0 * half / ((1u32 << bits) - 1) as f64;
        ((voltage + half) / step).round().clamp(0.0, 2.0 * half / step) * step - half
    }

    /// Pairs of standard normal numbers: sensor and voltage noise.
    fn noise(&self, excitation: Excitation) -> impl FnMut() -> (f64, f64) + use<> {
        let index = EXCITATIONS.iter().position(|e| *e == excitation).unwrap_or(EXCITATIONS.len());
        let seed = self.seed.wrapping_mul(EXCITATIONS.len() as u64 + 1).wrapping_add(index as u64);
        let (mut sensor, mut reading) = (ChaCha8Rng::seed_from_u64(seed), ChaCha8Rng::seed_from_u64(!seed));
        move || (StandardNormal.sample(&mut sensor), StandardNormal.sample(&mut reading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stroke(recording: &Recording) -> f64 {
        let y = &recording.displacement;
        y.iter().copied().fold(f64::MIN, f64::max) - y.iter().copied().fold(f64::MAX, f64::min)
    }

    #[test]
    fn strokes_are_those_of_the_reference() {
        let strokes = EXCITATIONS.map(|e| (e.name, stroke(&Rig::default().record(e))));
        for (name, expected) in [("sin1", 8.3), ("sin10", 8.1), ("sin100", 4.8), ("tr100", 3.8)] {
            let (_, found) = strokes.iter().find(|(n, _)| *n == name).unwrap();
            assert!((found - expected).abs() < 0.1, "{name}: {found}");
        }
    }

    #[test]
    fn the_seed_decides_the_noise_and_nothing_else() {
        let record = |seed| Rig { seed, ..Rig::default() }.record(EXCITATIONS[1]);
        assert_eq!(record(3), record(3));
        assert_eq!(record(3).voltage, record(4).voltage);
        let differences: Vec<f64> =
            record(3).displacement.iter().zip(record(4).displacement).map(|(a, b)| a - b).collect();
        let rms = (differences.iter().map(|d| d * d).sum::<f64>() / differences.len() as f64).sqrt();
        assert!((rms - 7e-3 * 2f64.sqrt()).abs() < 2e-4, "{rms}");
    }

    #[test]
    fn a_converter_of_n_bits_gives_at_most_2_to_the_n_voltages() {
        let mut seen = Rig { adc_bits: Some(8), voltage_noise: 0.05, ..Rig::default() }.record(EXCITATIONS[0]).voltage;
        seen.sort_by(f64::total_cmp);
        seen.dedup();
        assert!((200..=256).contains(&seen.len()), "{}", seen.len());
        assert!(seen.first().unwrap() >= &-22.0 && seen.last().unwrap() <= &22.0);
    }
}
