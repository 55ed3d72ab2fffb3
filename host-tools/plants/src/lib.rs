//! Actuators that no model of the catalogue is made of: other hysteresis, creep in the logarithm of time, and a device
//! that is warmer, loaded or older than when it was learnt. Stepped at 10 kHz, recorded at 2 kHz, from rest at 0 V with
//! a virgin memory; a seed draws the device, another its recordings.
//!
//! ```text
//! command → slew limit → first-order lag → u = V/V_full → hysteresis h(u)        (one of [`Kind`])
//! strain    = h + g·Σ_τ c_τ,   ċ_τ = (h − c_τ)/τ,  τ = 0.01, 0.1, 1, 10, 100 s    creep in log time
//! position  = scale·strain, through a resonance where there is one; then what has [changed](Change)
//! sensor    = position + 10 nm noise + drift;   recorded voltage = 12 bit of the command
//! ```

mod bouc_wen;
mod catalogue;
mod change;
mod converter;
mod creep;
mod draw;
mod drive;
mod hysteresis;
mod instruments;
mod jiles_atherton;
mod rate_dependent;
mod relays;
mod waveform;

#[cfg(test)]
mod tests;

pub use catalogue::{CATALOGUE, Kind};
pub use change::Change;
pub use converter::{ADC_INL_CODES, Converter, DAC_INL_CODES};
pub use drive::Resonance;
pub use hysteresis::STEP_S;
pub use instruments::Instruments;
pub use relays::Density;
pub use waveform::Waveform;

use creep::Creep;
use draw::Draw;
use drive::Drive;
use hysteresis::Hysteresis;
use recordings::log::Log;

/// Steps between two recorded samples.
const EVERY: usize = 5;

/// An actuator with its amplifier and the instruments that record it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Plant {
    /// What its hysteresis is.
    pub kind: Kind,
    /// Draws the numbers of its hysteresis, each within some ten to twenty per cent.
    pub device: u64,
    /// Voltage that counts as full, V.
    pub full_v: f64,
    /// Displacement from −`full_v` to `full_v` and back without creep and lag, peak to peak, µm.
    pub stroke_um: f64,
    /// Creep a decade of time, as a fraction of the strain.
    pub creep: f64,
    /// Time constant of the amplifier, s.
    pub lag_s: f64,
    /// Fastest change of the amplifier's voltage, V/s.
    pub slew_v_per_s: Option<f64>,
    /// Resonance of the mechanics, where there is one.
    pub resonance: Option<Resonance>,
    /// Voltage reading and sensor.
    pub instruments: Instruments,
    /// Against how it was learnt.
    pub change: Change,
}

impl Plant {
    /// A device of a kind: ±20 V, a stroke of 8 to 12 µm, an amplifier lag of some 0.3 ms.
    pub fn drawn(kind: Kind, device: u64) -> Self {
        let mut draw = Draw::new(device.wrapping_mul(2).wrapping_add(1));
        Self {
            kind,
            device,
            full_v: 20.0,
            stroke_um: 10.0 * draw.about(1.0, 0.08),
            creep: draw.about(0.012, 0.25),
            lag_s: draw.about(3e-4, 0.1),
            slew_v_per_s: None,
            resonance: None,
            instruments: Instruments::default(),
            change: Change::NONE,
        }
    }

    /// The same device, changed.
    #[must_use]
    pub fn after(self, change: Change) -> Self {
        Self { change, ..self }
    }

    /// Records a waveform: 2 kHz, from rest at 0 V. The seed draws noise, drift and what the waveform leaves open.
    pub fn log(&self, name: &str, waveform: &Waveform, duration_s: f64, seed: u64) -> Log {
        let command = waveform.command(duration_s, seed);
        let position = self.respond(&command);
        let recorded = |samples: &[f64]| samples.iter().step_by(EVERY).copied().collect::<Vec<f64>>();
        let (voltage, mut displacement) = (recorded(&command), recorded(&position));
        let period = EVERY as f64 * STEP_S;
        self.instruments.read(&mut displacement, period, seed);
        Log {
            name: name.to_owned(),
            path: name.into(),
            // In place of the bytes of a file.
            sha256: format!("{self:?} {waveform:?} {duration_s} {seed}"),
            start_s: 0.0,
            sample_period: period,
            voltage: voltage.into_iter().map(|volts| self.instruments.quantised(volts, self.full_v)).collect(),
            displacement: Some(displacement),
            displacement_estimated: false,
            holes: Vec::new(),
        }
    }

    /// True positions (µm) at each step of a command (V), from rest at 0 V.
    pub fn respond(&self, command: &[f64]) -> Vec<f64> {
        let mut running = self.running();
        command.iter().map(|&volts| running.step(volts)).collect()
    }

    /// The device at rest at 0 V, to be stepped.
    pub fn running(&self) -> Running {
        Running {
            full_v: self.full_v,
            scale: self.scale(),
            drive: Drive::new(self.slew_v_per_s, self.lag_s),
            hysteresis: self.kind.hysteresis(self.device),
            creep: Creep::new(self.creep),
            mechanics: self.resonance.map(drive::Mechanics::new),
            change: self.change,
            steps: 0,
        }
    }

    /// Strain to µm: a slow cycle to the full voltage has the stroke.
    fn scale(&self) -> f64 {
        let mut hysteresis = self.kind.hysteresis(self.device);
        let turns = [0.0, 1.0, -1.0, 1.0];
        let mut reached = (f64::INFINITY, f64::NEG_INFINITY);
        for turn in turns.windows(2) {
            for k in 1..=CYCLE {
                let u = turn[0] + (turn[1] - turn[0]) * f64::from(k) / f64::from(CYCLE);
                let strain = hysteresis.step(u, 1.0 / f64::from(CYCLE));
                reached = (reached.0.min(strain), reached.1.max(strain));
            }
        }
        self.stroke_um / (reached.1 - reached.0)
    }
}

/// A [`Plant`] while it runs: one step of [`STEP_S`] after the other.
pub struct Running {
    full_v: f64,
    scale: f64,
    drive: Drive,
    hysteresis: Box<dyn Hysteresis>,
    creep: Creep,
    mechanics: Option<drive::Mechanics>,
    change: Change,
    steps: u64,
}

impl Running {
    /// The true position (µm) after a step to a commanded voltage (V).
    pub fn step(&mut self, command: f64) -> f64 {
        let coercive = self.change.coercive;
        // Wider thresholds at the same slopes.
        let u = self.drive.step(command) / self.full_v / coercive;
        let strain = self.creep.step(coercive * self.hysteresis.step(u, STEP_S));
        let position = self.scale * strain;
        let position = self.mechanics.as_mut().map_or(position, |mechanics| mechanics.step(position));
        let seconds = self.steps as f64 * STEP_S;
        self.steps += 1;
        self.change.of(position, seconds)
    }

    /// The voltage at the ceramic (V), behind the amplifier's slew limit and lag.
    pub fn voltage(&self) -> f64 {
        self.drive.voltage()
    }
}

/// Steps of half a slow cycle.
const CYCLE: u32 = 400;
