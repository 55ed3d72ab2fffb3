//! Tracking: the rig driven along trajectories by each model's inverse, beside plain scaling of the trajectory to
//! volts. What Table 3.1 calls reversibility is worth what it makes of the displacement.

use super::bench::Bench;
use super::shapes::{SHAPES, Shape};
use crate::error::ThesisError;
use estimator_core::{Admitted, DriveLimits, Model, Range};
use feedforward::{Trajectory, plan};
use identification::cost::Feedback;
use identification::{Problem, Progress, SearchOptions, StraightLine};
use plants::{ADC_INL_CODES, Converter, DAC_INL_CODES};
use recordings::rig::Rig;
use report::{Grid, Section, shown};
use serde::Serialize;
use std::convert::Infallible;

/// Length of a trajectory, s.
const SECONDS: f64 = 2.0;
/// From here on it is judged, s: the way there from rest is nobody's fault.
const FROM: f64 = 0.5;
/// Fastest change of the voltage, V/s.
const SLEW: f32 = 20_000.0;

/// How well voltages from one source track.
#[derive(Clone)]
struct Judged {
    /// Mean absolute error of each trajectory, nm.
    mae_nm: Vec<f64>,
    /// Mean of them through the board's converters, nm.
    converted_nm: f64,
    /// Largest error of the model itself at the voltages of its inverse, nm.
    round_trip_nm: Option<f64>,
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
    /// Mean of them, nm.
    mean_nm: Option<f64>,
    /// The same through the board's converters, nm.
    converted_nm: Option<f64>,
    /// Largest error of the model itself at the voltages of its inverse, nm.
    round_trip_nm: Option<f64>,
    /// Why there is no inverse.
    failed: Option<String>,
}

impl Row {
    fn of(model: Option<Model>, found: Result<Judged, String>, plain: &Judged) -> Self {
        let name = model.map_or("plain scaling".to_owned(), |model| model.to_string());
        let (judged, failed) = match found {
            Ok(judged) => (Some(judged), None),
            Err(why) => (None, Some(why)),
        };
        let of = |number: fn(&Judged) -> f64| judged.as_ref().map(number);
        Self {
            model,
            name,
            of_scaling: judged.as_ref().map(|judged| mean(&judged.mae_nm) / mean(&plain.mae_nm)),
            mean_nm: of(|judged| mean(&judged.mae_nm)),
            converted_nm: of(|judged| judged.converted_nm),
            round_trip_nm: judged.as_ref().and_then(|judged| judged.round_trip_nm),
            mae_nm: judged.map(|judged| judged.mae_nm),
            failed,
        }
    }
}

fn mean(errors: &[f64]) -> f64 {
    errors.iter().sum::<f64>() / errors.len().max(1) as f64
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
    let drive = Drive {
        rig: &rig,
        setpoint: Converter::adc(stroke),
        voltage: Converter::dac(problem.training_voltages()),
        tick_s,
        trajectories: &trajectories,
    };
    let volts = scaling(problem);
    let Ok(plain) = drive.judged(|wanted| {
        // It knows the trajectory ahead of time as the inverses do.
        let voltages = (0..wanted.0.len()).map(|tick| volts(wanted.at(tick as f64 + 1.0))).collect();
        Ok::<_, Infallible>((voltages, None))
    });
    let mut rows = vec![Row::of(None, Ok(plain.clone()), &plain)];
    let limits = limits(problem);
    for model in Model::ALL {
        let Some(attempt) = bench.attempt(Feedback::Simulation, model) else { continue };
        let found = match &attempt.result {
            Ok(candidate) => drive.judged(|wanted| inverted(&candidate.table, &limits, wanted, tick_s)),
            Err(why) => Err((bench.say)(why)),
        };
        rows.push(Row::of(Some(model), found, &plain));
    }
    let mut table = Grid::new("Tracking: mean absolute error of the driven synthetic rig, nm.".to_owned())
        .words("voltages from", 27);
    for (name, _) in SHAPES {
        table = table.numbers(name, 8);
    }
    table = table
        .numbers("mean, of scaling's", 8)
        .numbers("mean nm", 8)
        .numbers("by the board", 8)
        .numbers("round trip, MAX nm", 8);
    for row in &rows {
        let errors = (0..SHAPES.len()).map(|index| row.mae_nm.as_ref().and_then(|errors| errors.get(index)).copied());
        let cells = errors.map(|error| shown(error, 1));
        let means = [row.mean_nm, row.converted_nm].map(|nm| shown(nm, 1));
        let last = [shown(row.of_scaling, 3)].into_iter().chain(means).chain([shown(row.round_trip_nm, 2)]);
        table.row(std::iter::once(row.name.clone()).chain(cells).chain(last));
    }
    let mut notes = vec![format!(
        "Each voltage stands for a tick; judged from {FROM} s on, against the true displacement. Amplitudes are 40 to 80 % of half \
         the training stroke. Plain scaling: the line of least squares through the training logs, a tick ahead as the inverses are. Round trip: the identified model \
         at the voltages of its own inverse. By the board: the set-point read by its ADC (twelve bits, sixteenfold, {ADC_INL_CODES} codes of \
         integral nonlinearity, over the stroke) and the voltage put out by its DAC (twelve bits, sixteenfold by noise shaping, \
         {DAC_INL_CODES} codes, over the voltages of the training)."
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

/// The rig, and the board before it.
struct Drive<'a> {
    rig: &'a Rig,
    /// By which the set-point comes in, over the stroke.
    setpoint: Converter,
    /// By which the voltage goes out, over the training's.
    voltage: Converter,
    tick_s: f64,
    trajectories: &'a [Trajectory],
}

impl Drive<'_> {
    /// Judges what `voltages` makes of trajectories: a voltage a tick, and the largest error of its own model at them
    /// (nm), where it has one.
    fn judged<E>(&self, voltages: impl Fn(&Trajectory) -> Result<(Vec<f64>, Option<f64>), E>) -> Result<Judged, E> {
        let (mut exact, mut converted, mut round_trip_nm) = (Vec::new(), Vec::new(), None);
        for wanted in self.trajectories {
            let (given, own) = voltages(wanted)?;
            exact.push(self.mae_nm(&given, wanted));
            round_trip_nm = own.map(|own| round_trip_nm.map_or(own, |most: f64| most.max(own))).or(round_trip_nm);
            let setpoint = Trajectory(wanted.0.iter().map(|&um| self.setpoint.through(um)).collect());
            let (given, _) = voltages(&setpoint)?;
            let given: Vec<f64> = given.iter().map(|&volts| self.voltage.through(volts)).collect();
            converted.push(self.mae_nm(&given, wanted));
        }
        Ok(Judged { mae_nm: exact, converted_nm: mean(&converted), round_trip_nm })
    }

    fn mae_nm(&self, voltages: &[f64], Trajectory(wanted): &Trajectory) -> f64 {
        let displacement = self.rig.respond(voltages, (self.rig.fs * self.tick_s).round().max(1.0) as usize);
        let errors = displacement.iter().zip(wanted).skip(first(self.tick_s)).map(|(y, r)| (y - r).abs());
        1e3 * errors.sum::<f64>() / wanted.len().saturating_sub(first(self.tick_s)).max(1) as f64
    }
}

/// Voltages by a table's inverse, and the largest error of its model at them, nm.
fn inverted(
    table: &Admitted,
    limits: &DriveLimits,
    wanted: &Trajectory,
    tick_s: f64,
) -> Result<(Vec<f64>, Option<f64>), String> {
    let plan = plan(table, limits, wanted).map_err(|error| error.to_string())?;
    let own = plan.round_trip(first(tick_s)).map_or(0.0, |own| 1e3 * own.max_um);
    Ok((plan.voltage, Some(own)))
}

/// The first tick that is judged.
fn first(tick_s: f64) -> usize {
    (FROM / tick_s).round() as usize
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
