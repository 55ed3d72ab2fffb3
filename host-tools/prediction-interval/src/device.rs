//! A simulated device, driven by the user's own voltages.

use estimator_core::Range;
use identification::Problem;
use log_survey::noise_of;
use plants::{Density, Kind, Plant, STEP_S};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use recordings::session::Session;

/// Relays of random density, which no model of the catalogue is made of, and for every third device another class: so
/// twelve devices are each density twice and each of the others once.
const RELAYS: [Kind; 4] = [
    Kind::Relays(Density::Gaussian),
    Kind::Relays(Density::Lorentzian),
    Kind::Relays(Density::TwoHumped),
    Kind::Relays(Density::Gamma),
];
const OTHERS: [Kind; 4] = [Kind::RateDependent, Kind::BoucWen, Kind::JilesAtherton, Kind::BoucWenSharp];
/// Creep a decade, of the strain.
const CREEP: Range<f64> = Range { min: 0.004, max: 0.03 };
/// Part of the device's full voltage that the user's range is.
const USED: Range<f64> = Range { min: 0.5, max: 1.0 };
/// A device comes to where a recording starts in this time, and has then rested for that long, s.
const COMES_S: f64 = 0.3;
const RESTS_S: f64 = 3.0;
/// Of each log no more than this is simulated, s.
const LONGEST_S: f64 = 60.0;

/// An actuator that no model of the catalogue is made of, driven over the user's voltages.
pub struct Device {
    plant: Plant,
    /// The user's voltages, V.
    voltages: Range<f64>,
    /// V of the plant at their ends.
    full_v: f64,
    /// µm of the user's device for one of the plant's.
    scale: f64,
    /// Steps of the plant in a tick.
    steps: usize,
    tick_s: f64,
    /// Deviation of the user's sensor, µm.
    noise_um: f64,
    /// Displacements at the instants of the training sessions, µm.
    trained: Vec<Vec<f64>>,
}

impl Device {
    /// The device of a number, driven over the same voltages as a problem's and as far, and late by something in `late`
    /// (s), drawn evenly in its logarithm.
    pub fn drawn(number: u32, seed: u32, problem: &Problem, late: Range<f64>) -> Self {
        let mut draw = ChaCha8Rng::seed_from_u64((u64::from(seed) << 32) + u64::from(number));
        let mut between = |range: Range<f64>| draw.random_range(range.min..range.max);
        let (group, other) = (number as usize / 3, number % 3 == 2);
        let kind = if other { OTHERS[group % 4] } else { RELAYS[(number as usize - group) % 4] };
        let plant = Plant {
            creep: between(CREEP),
            lag_s: libm::exp(between(Range { min: libm::log(late.min), max: libm::log(late.max) })),
            ..Plant::drawn(kind, (u64::from(seed) << 16) + u64::from(number))
        };
        let tick_s = problem.extent().tick;
        let used = between(USED);
        let device = Self {
            plant,
            voltages: problem.training_voltages(),
            full_v: used * plant.full_v,
            scale: 1.0,
            steps: (tick_s / STEP_S).round().max(1.0) as usize,
            tick_s,
            noise_um: noise(problem),
            trained: Vec::new(),
        };
        let unscaled: Vec<Vec<f64>> = problem.training().map(|session| device.positions(session)).collect();
        let scale = problem.stroke().span() / Range::of_values(unscaled.iter().flatten().copied()).span();
        let scaled = |positions: Vec<f64>| positions.into_iter().map(|position| scale * position).collect();
        Self { scale, trained: unscaled.into_iter().map(scaled).collect(), ..device }
    }

    /// What it lags behind the voltage, s.
    pub fn lag_s(&self) -> f64 {
        self.plant.lag_s
    }

    /// Displacements (µm) as a sensor reads them that is as noisy as the user's; another noise for another seed.
    pub fn read(&self, displacement: &[f64], seed: u64) -> Vec<f64> {
        let mut draw = ChaCha8Rng::seed_from_u64(seed);
        let noise = |position: &f64| {
            let normal: f64 = StandardNormal.sample(&mut draw);
            position + self.noise_um * normal
        };
        displacement.iter().map(noise).collect()
    }

    /// The displacements (µm) at ticks with these voltages (V), after others that it went to, each for so many s.
    pub fn respond(&self, past: &[(f64, f64)], voltage: &[f64]) -> Vec<f64> {
        let mut command = vec![0.0];
        for &(to, rests_s) in past {
            let (from, to) = (command[command.len() - 1], self.command(to));
            let (moving, resting) = ((COMES_S / STEP_S) as usize, (rests_s / STEP_S) as usize);
            command.extend((1..=moving).map(|k| from + (to - from) * k as f64 / moving as f64));
            command.extend(std::iter::repeat_n(to, resting));
        }
        let before = command.len();
        for pair in voltage.windows(2) {
            let (from, to) = (self.command(pair[0]), self.command(pair[1]));
            command.extend((0..self.steps).map(|k| from + (to - from) * k as f64 / self.steps as f64));
        }
        command.extend(voltage.last().map(|&last| self.command(last)));
        let response = self.plant.respond(&command);
        response.iter().skip(before).step_by(self.steps).map(|position| self.scale * position).collect()
    }

    /// A session of the user's, the one of this number with the training's counted first, as this device would
    /// have given it.
    pub fn session(&self, number: usize, session: &Session) -> Session {
        let positions = self.trained.get(number).cloned().unwrap_or_else(|| self.positions(session));
        let count = positions.len();
        Session {
            voltage: session.voltage[..self.ticks(session)].to_vec(),
            instants: session.instants[..count].to_vec(),
            displacement: self.read(&positions, number as u64),
            lead_in: session.lead_in.min(count.saturating_sub(1)),
            ..session.clone()
        }
    }

    /// Displacements at the instants of a session, µm.
    fn positions(&self, session: &Session) -> Vec<f64> {
        let voltage = &session.voltage[..self.ticks(session)];
        let rest = session.rested_v.or(voltage.first().copied()).unwrap_or(0.0);
        let response = self.respond(&[(rest, RESTS_S)], voltage);
        session.instants.iter().map_while(|&instant| response.get(instant as usize).copied()).collect()
    }

    /// Ticks of a session that are simulated.
    fn ticks(&self, session: &Session) -> usize {
        session.voltage.len().min((LONGEST_S / self.tick_s) as usize)
    }

    /// The plant's voltage for one of the user's, V.
    fn command(&self, voltage: f64) -> f64 {
        (voltage - self.voltages.middle()) / (0.5 * self.voltages.span()) * self.full_v
    }
}

/// Deviation of the noise of the problem's sensor, µm: that of its quietest training log, since in fast ones some of
/// the course remains.
fn noise(problem: &Problem) -> f64 {
    problem.training().filter_map(|session| noise_of(&session.displacement)).reduce(f64::min).unwrap_or(0.0)
}
