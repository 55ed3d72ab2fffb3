//! What is said of the creep of simulated actuators, whose creep is known: logs with rests tell it, and of others it is
//! said that they do not.

use calibration::CalibrationOptions;
use estimator_core::Model;
use identifiability::{Experiment, Found, Told, determination};
use identification::cost::{Cost, Feedback};
use identification::{Conditions, Job, ModelChoice, SearchOptions};
use plants::{Density, Instruments, Kind, Plant, STEP_S};
use recordings::log::Log;
use recordings::prepare::PrepareOptions;
use std::f64::consts::PI;

/// Steps of the plant from one row of a log to the next.
const EVERY: usize = 50;
const FULL_V: f64 = 20.0;

/// A command that is made piece by piece, from 0 V.
struct Command(Vec<f64>);

impl Command {
    /// To a voltage, as half a cosine.
    fn to(&mut self, volts: f64, seconds: f64) {
        let (from, steps) = (self.0.last().copied().unwrap_or(0.0), (seconds / STEP_S).round());
        let part = |step: f64| 0.5 - 0.5 * (PI * step / steps).cos();
        self.0.extend((1..=steps as u32).map(|step| from + (volts - from) * part(f64::from(step))));
    }

    fn rest(&mut self, seconds: f64) {
        let volts = self.0.last().copied().unwrap_or(0.0);
        self.0.extend(vec![volts; (seconds / STEP_S).round() as usize]);
    }

    /// Loops of several sizes and frequencies between 0 V and the full voltage.
    fn loops() -> Self {
        let mut command = Self(vec![0.0; EVERY]);
        for (part, hz, count) in [(1.0, 1.0, 5), (0.5, 1.0, 3), (1.0, 5.0, 15), (0.25, 2.0, 4), (1.0, 0.5, 2)] {
            for _ in 0..count {
                command.to(part * FULL_V, 0.5 / hz);
                command.to(0.0, 0.5 / hz);
            }
        }
        command
    }

    fn loops_and_rests() -> Self {
        let mut command = Self::loops();
        for volts in [FULL_V, 0.3 * FULL_V, 0.8 * FULL_V] {
            command.to(volts, 0.1);
            command.rest(10.5);
        }
        command
    }
}

fn log(plant: &Plant, Command(command): &Command) -> Log {
    let row = |values: &[f64]| values.iter().step_by(EVERY).copied().collect::<Vec<f64>>();
    // Noise of 4 nm in steps.
    let noise = (0u32..).map(|n| if n.wrapping_mul(2_654_435_761) >> 31 == 0 { 4e-3 } else { -4e-3 });
    Log {
        name: "made".into(),
        path: "made".into(),
        sha256: "made".into(),
        start_s: 0.0,
        sample_period: EVERY as f64 * STEP_S,
        voltage: row(command),
        displacement: Some(row(&plant.respond(command)).iter().zip(noise).map(|(y, noise)| y + noise).collect()),
        displacement_estimated: false,
        holes: Vec::new(),
    }
}

/// What is said of the creep of an actuator after a log of it.
fn said(plant: &Plant, command: &Command) -> Found {
    let job = Job {
        training: vec![log(plant, command)],
        held_out: Vec::new(),
        hold_out: 0.0,
        as_judged: false,
        prepare: PrepareOptions::default(),
        model: ModelChoice::Is(Model::GeneralisedPrandtlIshlinskii),
        conditions: Conditions::default(),
        calibration: CalibrationOptions::default(),
        cost: Cost::from(Feedback::Simulation),
        search: SearchOptions { evaluations: 60, ..SearchOptions::DEFAULT },
    };
    let outcome = job.run(&mut |_, _| ()).expect("the model is found");
    let training: Vec<_> = outcome.problem.training().collect();
    let of = determination(&outcome.judged().table, &training).expect("there is something to tell");
    *of.found.iter().find(|found| found.experiment == Experiment::Creep).expect("every experiment is made")
}

/// How far an actuator that has been over its voltages and rested creeps from 0.1 to 10 s after a ramp of 0.1 s
/// over them, µm.
fn truth(plant: &Plant) -> f64 {
    let steps = |seconds: f64| (seconds / STEP_S).round() as usize;
    let mut command = Command(vec![0.0]);
    command.to(FULL_V, 0.5);
    command.to(0.0, 0.5);
    command.rest(10.0);
    let ramp = (1..=steps(0.1)).map(|step| FULL_V * step as f64 / steps(0.1) as f64);
    command.0.extend(ramp);
    let end = command.0.len() - 1;
    command.rest(10.0);
    let response = plant.respond(&command.0);
    response[end + steps(10.0)] - response[end + steps(0.1)]
}

#[test]
fn creep_is_within_twice_its_standard_error_or_said_to_be_hardly_told() {
    let kinds = [Kind::Relays(Density::Gaussian), Kind::RateDependent, Kind::BoucWen];
    for (kind, creep) in kinds.into_iter().zip([0.01, 0.03, 0.02]) {
        let plant = Plant { creep, instruments: Instruments::EXACT, ..Plant::drawn(kind, 3) };
        let truth = truth(&plant);
        let (with, without) = (said(&plant, &Command::loops_and_rests()), said(&plant, &Command::loops()));
        assert_eq!(without.told, Told::Restless, "{kind:?}, {truth:.3} µm: {without:?}");
        let off = (with.value_um - truth).abs();
        assert!(off <= 2.0 * with.standard_error_um, "{kind:?}, {truth:.3} µm: {with:?}");
        assert!(matches!(with.told, Told::Well | Told::Partly), "{kind:?}, {truth:.3} µm: {with:?}");
    }
}
