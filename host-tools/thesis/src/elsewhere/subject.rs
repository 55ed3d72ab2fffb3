//! What is learnt from, and what it is judged on.

use crate::Bench;
use crate::error::ThesisError;
use ::calibration::CalibrationOptions;
use identification::validate::Scope;
use identification::{Job, SearchOptions};
use plants::{CATALOGUE, Change, Plant, Waveform};
use recordings::log::{Log, ReadOptions, read_bytes};
use recordings::prepare::{AutoOr, PrepareOptions};
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};
use std::path::Path;

/// As the tables call the measured stack.
pub const STACK: &str = "measured PICMA stack";
/// As they call the rig.
pub const THESIS_RIG: &str = "the thesis's rig";
/// As they call the plants.
pub const PLANTS: &str = "plants outside the models' class";
/// As they call the same plants where the training has more than one amplitude.
pub const SEVERAL_AMPLITUDES: &str = "the same, learnt at several amplitudes";
/// As they call a triangle of ±8 V where ±20 V were learnt.
pub const OTHER_AMPLITUDE: &str = "other amplitude, triangle of ±8 V at 10 Hz";

/// One device's recordings.
pub struct Subject {
    /// As the tables call what it belongs to.
    pub name: &'static str,
    /// What tells it from the others of that name: the devices of a table are compared device by device.
    pub device: String,
    /// What is learnt, and how.
    pub job: Job,
    /// What it is judged on.
    pub trials: Vec<Trial>,
}

/// A recording that is judged on.
pub struct Trial {
    /// As the tables call it.
    pub condition: &'static str,
    /// What was recorded of it.
    pub log: Log,
    /// Which part of it is scored.
    pub scope: Scope,
}

impl Trial {
    fn whole(condition: &'static str, log: Log) -> Self {
        Self { condition, log, scope: Scope::ALL }
    }
}

const SESSION_1: (&str, &[u8]) =
    ("picma-p885-1hz.csv", include_bytes!("../../../../tests/data/picma-p885-1hz.csv").as_slice());
const SESSION_2: (&str, &[u8]) =
    ("picma-p885-session2.csv", include_bytes!("../../../../tests/data/picma-p885-session2.csv").as_slice());
/// In the second session's rest at 1.83 V, from 18.9 to 24.9 s.
const REST_S: f64 = 22.0;

fn measured((name, bytes): (&str, &[u8])) -> Result<Log, ThesisError> {
    Ok(read_bytes(Path::new(name), bytes, &ReadOptions::default())?)
}

fn seeded(job: &Job, seed: u32) -> SearchOptions {
    SearchOptions { seed, ..job.search.clone() }
}

/// The measured stack, learnt from the first half of its first session. Only the search differs by the seed.
///
/// # Errors
/// A recording cannot be read.
pub fn sessions(job: &Job, seed: u32) -> Result<Subject, ThesisError> {
    let (first, second) = (measured(SESSION_1)?, measured(SESSION_2)?);
    let (training, rest) = first.split(0.5);
    let trial = |condition, log: &Log, scope| Trial { condition, log: log.clone(), scope };
    let trials = vec![
        trial("same session, second half, run on through the first", &first, Scope::since(rest.start_s)),
        trial("other session", &second, Scope::ALL),
        trial(
            "other session, zeroed once in its rest at 22 s",
            &second,
            Scope { zero_at_s: Some(REST_S), ..Scope::ALL },
        ),
    ];
    let prepare = PrepareOptions { voltage_zero: AutoOr::Auto, displacement_zero: AutoOr::Auto, ..job.prepare.clone() };
    Ok(Subject {
        name: STACK,
        device: String::new(),
        job: Job {
            training: vec![training],
            held_out: Vec::new(),
            hold_out: 0.0,
            as_judged: false,
            prepare,
            search: seeded(job, seed),
            calibration: CalibrationOptions::default(),
            ..job.clone()
        },
        trials,
    })
}

/// The rig of the thesis's tables, whose equations are near the generalised Prandtl–Ishlinskii model's.
pub fn thesis_rig(job: &Job, seed: u32) -> Subject {
    let rig = Rig { seed: u64::from(seed), ..Rig::default() };
    let (training, held_out) = Bench::logs_of(&rig);
    let triangle = EXCITATIONS.into_iter().find(|excitation| excitation.name == VALIDATION);
    let smaller = triangle.map(|triangle| Rig { amplitude: 8.0, ..rig.clone() }.log(triangle));
    let mut trials: Vec<Trial> =
        held_out.into_iter().map(|log| Trial::whole("same amplitude, triangle of ±20 V at 10 Hz", log)).collect();
    trials.extend(smaller.map(|log| Trial::whole(OTHER_AMPLITUDE, log)));
    Subject {
        name: THESIS_RIG,
        device: seed.to_string(),
        job: Job {
            training,
            held_out: Vec::new(),
            hold_out: 0.0,
            as_judged: false,
            prepare: Bench::zeroed(&job.prepare),
            search: seeded(job, seed),
            ..job.clone()
        },
        trials,
    }
}

/// A device of each kind, learnt at full voltage, and once more with smaller amplitudes besides.
pub fn plants(job: &Job, seed: u32) -> impl Iterator<Item = Subject> {
    CATALOGUE.into_iter().flat_map(move |kind| {
        let plant = Plant::drawn(kind, seed.into());
        let at_full: Vec<Log> = at_full(&plant, seed).collect();
        let of = |name, training: Vec<Log>, trials| Subject {
            name,
            device: format!("{} {seed}", kind.name()),
            job: Job {
                training,
                held_out: Vec::new(),
                hold_out: 0.0,
                as_judged: false,
                prepare: Bench::zeroed(&job.prepare),
                search: seeded(job, seed),
                ..job.clone()
            },
            trials,
        };
        let several = at_full.iter().cloned().chain(smaller(&plant, seed)).collect();
        let unchanged = || unchanged(&plant, seed).collect::<Vec<_>>();
        let all = unchanged().into_iter().chain(changed(&plant, seed)).collect();
        [of(PLANTS, at_full, all), of(SEVERAL_AMPLITUDES, several, unchanged())]
    })
}

/// The thesis's excitations at full voltage.
fn at_full(plant: &Plant, seed: u32) -> impl Iterator<Item = Log> {
    EXCITATIONS.into_iter().enumerate().map(move |(index, excitation)| {
        let (amplitude, hertz, offset) = (plant.full_v, f64::from(excitation.hertz), 0.0);
        let waveform = match excitation.waveform {
            recordings::rig::Waveform::Sine => Waveform::Sine { amplitude, hertz, offset },
            recordings::rig::Waveform::Triangle => Waveform::Triangle { amplitude, hertz, offset },
        };
        plant.log(excitation.name, &waveform, 2.0, recording(seed, index))
    })
}

/// Sines of 0.6 and 0.3 of the full voltage, and one that dies away.
fn smaller(plant: &Plant, seed: u32) -> impl Iterator<Item = Log> {
    let sine = |part: f64| Waveform::Sine { amplitude: part * plant.full_v, hertz: 5.0, offset: 0.0 };
    let decaying = Waveform::Decaying { amplitude: plant.full_v, hertz: 2.0, tau_s: 1.5 };
    let waveforms = [("sine of 0.6", sine(0.6), 2.0), ("sine of 0.3", sine(0.3), 2.0), ("decaying", decaying, 4.0)];
    waveforms.into_iter().enumerate().map(move |(index, (name, waveform, duration_s))| {
        plant.log(name, &waveform, duration_s, recording(seed, 200 + index))
    })
}

/// What a plant is judged on as it was learnt.
fn unchanged(plant: &Plant, seed: u32) -> impl Iterator<Item = Trial> {
    let full = plant.full_v;
    let sine = |hertz| Waveform::Sine { amplitude: full, hertz, offset: 0.0 };
    let staircase = Waveform::Staircase { amplitude: 0.8 * full, steps: 6, hold_s: 0.1 };
    let multisine = Waveform::Multisine { amplitude: 0.8 * full, from_hz: 1.0, to_hz: 40.0, tones: 12 };
    let recordings = [
        (OTHER_AMPLITUDE, Waveform::Triangle { amplitude: 0.4 * full, hertz: 10.0, offset: 0.0 }, 2.0),
        ("other frequency, sine of ±20 V at 3 Hz", sine(3.0), 2.0),
        ("other frequency, sine of ±20 V at 30 Hz", sine(30.0), 2.0),
        ("AM sine, up to ±20 V at 5 Hz", swelling(plant), 6.0),
        ("staircase to ±16 V, steps of 0.1 s", staircase, 7.5),
        ("multisine, 1 to 40 Hz, up to ±16 V", multisine, 4.0),
    ];
    recordings.into_iter().enumerate().map(move |(index, (condition, waveform, duration_s))| {
        Trial::whole(condition, plant.log(condition, &waveform, duration_s, recording(seed, 100 + index)))
    })
}

/// What it is judged on once it has changed.
fn changed(plant: &Plant, seed: u32) -> impl Iterator<Item = Trial> {
    let changes = [
        ("warming by 0.5 K/s, AM sine", Change::warming(0.5)),
        ("loaded by a spring of a tenth of its stiffness, AM sine", Change::load(0.1, -0.5)),
        ("aged by 5 %, AM sine", Change::ageing(0.05)),
    ];
    changes.into_iter().enumerate().map(move |(index, (condition, change))| {
        let log = plant.after(change).log(condition, &swelling(plant), 6.0, recording(seed, 150 + index));
        Trial::whole(condition, log)
    })
}

fn swelling(plant: &Plant) -> Waveform {
    Waveform::AmplitudeModulated { amplitude: plant.full_v, hertz: 5.0, swell_hz: 0.5 }
}

/// Seed of a recording.
fn recording(seed: u32, index: usize) -> u64 {
    1_000 * u64::from(seed) + index as u64
}
