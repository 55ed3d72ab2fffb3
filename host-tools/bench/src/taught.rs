//! What a drive will teach, before it is driven: played to an actuator that is none of the models, learnt from, and
//! asked what that determines.

use crate::emulated::emulated;
use crate::wiring::Wiring;
use calibration::CalibrationOptions;
use emulator::{Plant, TICK_US};
use estimator_core::{AdcCode, Model};
use excitation::{Drive, Segment};
use identifiability::{Determination, Unknown, determination};
use identification::cost::{Cost, Feedback};
use identification::{Conditions, Job, JobError, ModelChoice, SearchOptions};
use plants::{Density, Kind};
use recordings::log::Log;
use recordings::prepare::PrepareOptions;

/// Candidates a number: enough for standard errors.
const EVALUATIONS: u32 = 10;

/// What the logs of a drive with the emulator's tick would determine of an [emulated](emulated()) actuator beside
/// an emulated sensor.
///
/// # Errors
/// Nothing can be learnt from such logs.
pub fn taught(wiring: &Wiring, drive: &Drive) -> Result<Result<Determination, Unknown>, JobError> {
    // Each segment begins where the one before ended, at rest, and the actuator remembers.
    let mut plant = emulated(wiring, Kind::Relays(Density::Gaussian), 1).connected();
    let played: Vec<Log> = drive.segments.iter().map(|segment| log(wiring, segment, &mut plant)).collect();
    let slew = wiring.drive().limits.slew_v_per_s;
    let learnt = drive.segments.iter().zip(played).filter(|(segment, _)| !segment.held_out);
    let job = Job {
        training: learnt.map(|(_, log)| log).collect(),
        held_out: Vec::new(),
        hold_out: 0.0,
        as_judged: false,
        prepare: PrepareOptions { tick_us: TICK_US, ..PrepareOptions::default() },
        model: ModelChoice::Is(Model::GeneralisedPrandtlIshlinskii),
        conditions: Conditions::default(),
        calibration: CalibrationOptions { amplifier_slew: Some(slew.into()), ..CalibrationOptions::default() },
        cost: Cost::from(Feedback::Simulation),
        search: SearchOptions { evaluations: EVALUATIONS, ..SearchOptions::DEFAULT },
    };
    let outcome = job.run(&mut |_, _| ())?;
    let sessions: Vec<_> = outcome.learnt_from().training().collect();
    Ok(determination(&outcome.learnt.candidate.table, &sessions))
}

/// What would be recorded of a segment.
fn log(wiring: &Wiring, segment: &Segment, plant: &mut impl Plant) -> Log {
    let (adc, drive, full_scale) = (wiring.adc(), wiring.drive(), wiring.line().dac.full_scale);
    let (voltage, displacement) = segment
        .volts
        .iter()
        .map(|&volts| {
            let read = plant.sample(drive.code(volts, full_scale));
            (adc.voltage::<f64>(read.monitor), wiring.sensor.displacement(read.sensor.unwrap_or(AdcCode(0))))
        })
        .unzip();
    Log {
        name: segment.name.to_owned(),
        path: segment.name.into(),
        sha256: format!("{wiring:?} {}", segment.name),
        start_s: 0.0,
        sample_period: wiring.line().sample_period(),
        voltage,
        displacement: Some(displacement),
        displacement_estimated: false,
        holes: Vec::new(),
    }
}
