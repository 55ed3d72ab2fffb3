//! Tracking: the rig driven along trajectories by each model's inverse, beside plain scaling of the trajectory to volts.
//! What Table 3.1 calls reversibility is worth what it makes of the displacement.

use super::bench::Bench;
use crate::error::ThesisError;
use estimator_core::{Admitted, DriveLimits, Model, Range};
use feedforward::{Trajectory, plan};
use identification::cost::Feedback;
use identification::{Problem, Progress, SearchOptions, StraightLine};
use recordings::rig::Rig;
use report::{Grid, Section, shown};
use serde::Serialize;
use std::f64::consts::TAU;

/// A trajectory: its name and its value at a time in s, −1 … 1 of half the training stroke about its middle.
type Shape = (&'static str, fn(f64) -> f64);

const SHAPES: [Shape; 6] = [
    ("sine 1 Hz", |t| 0.7 * libm::sin(TAU * t)),
    ("sine 10 Hz", |t| 0.7 * libm::sin(TAU * 10.0 * t)),
    ("sine 50 Hz", |t| 0.4 * libm::sin(TAU * 50.0 * t)),
    ("triangle 5 Hz", |t| 0.7 * triangle(5.0 * t)),
    ("staircase", staircase),
    ("shrinking 5 Hz", |t| 0.8 * (1.0 - 0.45 * t) * libm::sin(TAU * 5.0 * t)),
];

/// Length of a trajectory, s.
const SECONDS: f64 = 2.0;
/// From here on it is judged, s: the way there from rest is nobody's fault.
const FROM: f64 = 0.5;
/// Fastest change of the voltage, V/s.
const SLEW: f32 = 20_000.0;

/// −1 … 1, period 1, from 0 upwards.
fn triangle(phase: f64) -> f64 {
    let phase = (phase + 0.25).fract();
    1.0 - 4.0 * (phase - 0.5).abs()
}

/// Steps of a fifth of a second, up and down, each taken in 10 ms.
fn staircase(t: f64) -> f64 {
    const LEVELS: [f64; 11] = [0.0, 0.3, 0.6, 0.2, -0.4, -0.7, -0.1, 0.5, 0.1, -0.3, 0.0];
    let step = (t / 0.2).floor();
    let level = |index: f64| LEVELS.get(index as usize).copied().unwrap_or(0.0);
    let (from, to) = (level(step - 1.0), level(step));
    let part = ((t - 0.2 * step) / 0.01).clamp(0.0, 1.0);
    from + (to - from) * 0.5 * (1.0 - libm::cos(TAU * 0.5 * part))
}

#[derive(Serialize)]
struct Row {
    /// `None`: the trajectory scaled to volts.
    model: Option<Model>,
    name: String,
    /// Mean absolute error of each trajectory, nm; `None` where the model has no inverse.
    mae_nm: Option<Vec<f64>>,
    /// Mean of them, of plain scaling's.
    of_scaling: Option<f64>,
    /// Largest error of the model itself at the voltages of its inverse, nm.
    round_trip_nm: Option<f64>,
    /// Why there is no inverse.
    failed: Option<String>,
}

/// Generations that it takes, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    search.generations_of(&Model::VOIGT_FAMILY) + 500
}

/// Drives the rig.
///
/// # Errors
/// The logs are a user's: there is nothing to drive.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    let rig = bench.rig.clone().ok_or(ThesisError::NoRig)?;
    let recipe = &bench.prepared.context.recipe;
    if recipe.voltage_zero_v != 0.0 || recipe.displacement_zero_um != 0.0 {
        return Err(ThesisError::OtherZeros);
    }
    bench.identify(Feedback::Simulation, &Model::ALL, progress);
    let problem = bench.problem();
    let tick_s = problem.extent().tick;
    let stroke = problem.stroke();
    let ticks = (SECONDS / tick_s).round() as u32;
    let trajectory = |&(_, shape): &Shape| {
        let at = |tick| stroke.min + stroke.span() / 2.0 * (1.0 + shape(f64::from(tick) * tick_s));
        Trajectory((0..ticks).map(at).collect())
    };
    let trajectories: Vec<Trajectory> = SHAPES.iter().map(trajectory).collect();
    let driven = |voltages: &[f64], wanted: &[f64]| mae_nm(&rig, voltages, wanted, tick_s);

    let volts = scaling(problem);
    let scaled = |wanted: &Trajectory| {
        // It knows the trajectory ahead of time as the inverses do.
        let voltages: Vec<f64> = (0..wanted.0.len()).map(|tick| volts(wanted.at(tick as f64 + 1.0))).collect();
        driven(&voltages, &wanted.0)
    };
    let plain: Vec<f64> = trajectories.iter().map(scaled).collect();
    let mut rows = vec![Row {
        model: None,
        name: "plain scaling".to_owned(),
        of_scaling: Some(1.0),
        mae_nm: Some(plain.clone()),
        round_trip_nm: None,
        failed: None,
    }];
    let limits = limits(problem);
    for model in Model::ALL {
        let Some(attempt) = bench.attempt(Feedback::Simulation, model) else { continue };
        let found = match &attempt.result {
            Ok(candidate) => inverted(&candidate.table, &limits, &trajectories, tick_s, &driven),
            Err(why) => Err((bench.say)(why)),
        };
        let mean = |errors: &[f64]| errors.iter().sum::<f64>() / errors.len().max(1) as f64;
        let name = model.to_string();
        rows.push(match found {
            Ok((errors, round_trip)) => Row {
                model: Some(model),
                name,
                of_scaling: Some(mean(&errors) / mean(&plain)),
                mae_nm: Some(errors),
                round_trip_nm: Some(round_trip),
                failed: None,
            },
            Err(why) => {
                Row { model: Some(model), name, of_scaling: None, mae_nm: None, round_trip_nm: None, failed: Some(why) }
            }
        });
    }
    let mut table = Grid::new("Tracking: mean absolute error of the driven synthetic rig, nm.".to_owned())
        .words("voltages from", 27);
    for (name, _) in SHAPES {
        table = table.numbers(name, 8);
    }
    table = table.numbers("mean, of scaling's", 8).numbers("round trip, MAX nm", 8);
    for row in &rows {
        let errors = (0..SHAPES.len()).map(|index| row.mae_nm.as_ref().and_then(|errors| errors.get(index)).copied());
        let cells = errors.map(|error| shown(error, 1));
        let last = [shown(row.of_scaling, 3), shown(row.round_trip_nm, 2)];
        table.row(std::iter::once(row.name.clone()).chain(cells).chain(last));
    }
    let mut notes = vec![format!(
        "Each voltage stands for a tick; judged from {FROM} s on, against the true displacement. Amplitudes are 40 to 80 % of half \
         the training stroke. Plain scaling: the line of least squares through the training logs, a tick ahead as the inverses are. Round trip: the identified model \
         at the voltages of its own inverse."
    )];
    notes.extend(rows.iter().filter_map(|row| Some(format!("{}: {}.", row.name, row.failed.as_ref()?))));
    Ok(Section {
        title: "Tracking with the models' inverses",
        tables: vec![table],
        notes,
        figures: Vec::new(),
        json: serde_json::to_string_pretty(&rows)?,
    })
}

/// Errors on the rig (nm, a trajectory each) and the largest of the round trips (nm).
fn inverted(
    table: &Admitted,
    limits: &DriveLimits,
    trajectories: &[Trajectory],
    tick_s: f64,
    driven: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<(Vec<f64>, f64), String> {
    let (mut errors, mut round_trip) = (Vec::new(), 0.0f64);
    for trajectory in trajectories {
        let plan = plan(table, limits, trajectory).map_err(|error| error.to_string())?;
        errors.push(driven(&plan.voltage, &trajectory.0));
        let own = plan.round_trip(first(tick_s)).map_or(0.0, |own| own.max_um);
        round_trip = round_trip.max(1e3 * own);
    }
    Ok((errors, round_trip))
}

/// The first tick that is judged.
fn first(tick_s: f64) -> usize {
    (FROM / tick_s).round() as usize
}

fn mae_nm(rig: &Rig, voltages: &[f64], wanted: &[f64], tick_s: f64) -> f64 {
    let displacement = rig.respond(voltages, (rig.fs * tick_s).round().max(1.0) as usize);
    let errors = displacement.iter().zip(wanted).skip(first(tick_s)).map(|(y, r)| (y - r).abs());
    1e3 * errors.sum::<f64>() / wanted.len().saturating_sub(first(tick_s)).max(1) as f64
}

/// All voltages of the training, from rest at 0 V.
fn limits(problem: &Problem) -> DriveLimits {
    let Range { min, max } = problem.training_voltages();
    let range_v = Range { min: min as f32, max: max as f32 };
    DriveLimits { range_v, rest_v: range_v.clamp(0.0), slew_v_per_s: SLEW }
}

/// Displacement (µm) to voltage by the line of least squares through the training logs, within their voltages.
fn scaling(problem: &Problem) -> impl Fn(f64) -> f64 + use<> {
    let line = StraightLine::through(problem.training().flat_map(|session| {
        let at = |&tick: &u32| session.voltage.get(tick as usize).copied().unwrap_or(0.0);
        session
            .instants
            .iter()
            .map(at)
            .zip(&session.displacement)
            .map(|(voltage, &displacement)| (voltage, displacement, 1.0))
    }));
    let voltages = problem.training_voltages();
    // A voltage that rests has no line, and a job refuses it.
    move |y| voltages.clamp(line.map_or(f64::NAN, |line| line.voltage(y)))
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn shapes_stay_within_the_stroke_and_do_not_jump() {
        assert_eq!([0.0, 0.25, 0.5, 0.75, 1.0].map(triangle), [0.0, 1.0, 0.0, -1.0, 0.0]);
        for (name, shape) in SHAPES {
            let values: Vec<f64> = (0..4000).map(|k| shape(f64::from(k) * 5e-4)).collect();
            assert!(values.iter().all(|value| value.abs() <= 0.81), "{name}");
            assert!(values.windows(2).all(|pair| (pair[1] - pair[0]).abs() < 0.08), "{name}");
        }
    }

    #[test]
    fn inverses_track_better_than_scaling_and_the_black_box_has_none() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let of = |model: &str| data.as_array().unwrap().iter().find(|row| row["model"] == model).unwrap().clone();
        assert!(of("generalised-prandtl-ishlinskii")["of_scaling"].as_f64().unwrap() < 0.3, "{}", section.text());
        assert!(of("narx")["mae_nm"].is_null() && of("narx")["failed"].as_str().unwrap().contains("no inverse"));
        assert!(of("prandtl-ishlinskii")["round_trip_nm"].as_f64().unwrap() < 1.0, "{}", section.text());
    }

    #[test]
    fn a_user_s_logs_cannot_be_driven() {
        let mut bench = small();
        bench.rig = None;
        assert!(section(&mut bench, &mut |_, _| ()).is_err());
    }
}
