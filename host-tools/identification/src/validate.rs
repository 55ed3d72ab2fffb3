//! How far an admitted table's estimate is from the sensor, in simulation: the f64 reference (MIL) and the f32 core that
//! the target runs (SIL) side by side, through the very [`Estimator`] that the firmware has.

use estimator_core::{Admitted, Estimator, Real, Status};
use recordings::session::Session;
use serde::Serialize;

/// Errors of an estimate, µm, at the measured instants after the first.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Figures {
    /// Mean absolute error.
    pub mae_um: f64,
    /// Largest absolute error.
    pub max_um: f64,
    /// Root mean square error.
    pub rmse_um: f64,
    /// Measured displacement, peak to peak.
    pub stroke_um: f64,
    /// Median of estimate − measurement: what drift, creep and the session's start leave, and re-zeroing removes.
    pub offset_um: f64,
    /// Mean absolute error without that offset.
    pub mae_without_offset_um: f64,
    /// Mean absolute error in % of the stroke.
    pub mae_percent: f64,
    /// Largest absolute error in % of the stroke.
    pub max_percent: f64,
    /// Root mean square error in % of the stroke.
    pub rmse_percent: f64,
    /// Mean absolute error without the offset in % of the stroke.
    pub mae_without_offset_percent: f64,
}

impl Figures {
    /// Of estimates beside what was measured at the same instants, µm.
    pub(crate) fn of(estimated: &[f64], measured: &[f64]) -> Self {
        let errors: Vec<f64> = estimated.iter().zip(measured).map(|(e, m)| e - m).collect();
        let count = errors.len().max(1) as f64;
        let mean = |of: &dyn Fn(f64) -> f64| errors.iter().map(|&e| of(e)).sum::<f64>() / count;
        let mut sorted = errors.clone();
        sorted.sort_by(f64::total_cmp);
        let offset_um = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        let mae_um = mean(&f64::abs);
        let mae_without_offset_um = mean(&|e| (e - offset_um).abs());
        let extreme = |pick: fn(f64, f64) -> f64, start| measured.iter().copied().fold(start, pick);
        let stroke_um = extreme(f64::max, f64::NEG_INFINITY) - extreme(f64::min, f64::INFINITY);
        let max_um = errors.iter().fold(0.0f64, |max, e| e.abs().max(max));
        let rmse_um = mean(&|e| e * e).sqrt();
        let percent = |um: f64| 100.0 * um / stroke_um;
        Self {
            mae_um,
            max_um,
            rmse_um,
            stroke_um,
            offset_um,
            mae_without_offset_um,
            mae_percent: percent(mae_um),
            max_percent: percent(max_um),
            rmse_percent: percent(rmse_um),
            mae_without_offset_percent: percent(mae_without_offset_um),
        }
    }

    /// Several logs in one line: the means of MAE and of its percentages, the largest of MAX, each log weighing the same.
    pub fn all<'a>(figures: impl ExactSizeIterator<Item = &'a Self> + Clone) -> Option<Self> {
        let count = figures.len() as f64;
        let mean = |of: fn(&Self) -> f64| figures.clone().map(of).sum::<f64>() / count;
        let max = |of: fn(&Self) -> f64| figures.clone().map(of).fold(0.0, f64::max);
        (count > 0.0).then(|| Self {
            mae_um: mean(|f| f.mae_um),
            max_um: max(|f| f.max_um),
            rmse_um: mean(|f| f.rmse_um * f.rmse_um).sqrt(),
            stroke_um: max(|f| f.stroke_um),
            offset_um: mean(|f| f.offset_um),
            mae_without_offset_um: mean(|f| f.mae_without_offset_um),
            mae_percent: mean(|f| f.mae_percent),
            max_percent: max(|f| f.max_percent),
            rmse_percent: mean(|f| f.rmse_percent * f.rmse_percent).sqrt(),
            mae_without_offset_percent: mean(|f| f.mae_without_offset_percent),
        })
    }
}

/// An estimate beside the sensor, at the measured instants after the first.
#[derive(Clone, PartialEq, Debug)]
pub struct Trace {
    /// Time within the log, s.
    pub time_s: Vec<f64>,
    /// Voltage, V relative to the model's zero.
    pub voltage: Vec<f64>,
    /// Sensor, µm relative to the model's zero.
    pub measured: Vec<f64>,
    /// Reference estimate, µm.
    pub estimated: Vec<f64>,
}

/// The f32 core as a device starts: without the sensor's first reading, from rest at the first voltage.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Cold {
    /// From the first sample on.
    pub all: Figures,
    /// From where it counts as settled ([`Status::NOT_SETTLED`]); `None` where it never does.
    pub settled: Option<Figures>,
    /// When that is, s from the first sample.
    pub settled_after_s: Option<f64>,
}

/// One log against a table.
#[derive(Clone, PartialEq, Debug)]
pub struct Comparison {
    /// Name of the log.
    pub name: String,
    /// The f64 reference.
    pub mil: Figures,
    /// The f32 core.
    pub sil: Figures,
    /// Largest difference of the two estimates, µm.
    pub mil_sil_um: f64,
    /// The f32 core told nothing.
    pub cold: Cold,
    /// Every status bit that the f32 core raised.
    pub status: Status,
    /// The reference beside the sensor.
    pub trace: Trace,
}

/// Runs a table over a session.
pub fn compare(table: &Admitted, session: &Session) -> Comparison {
    let first = session.displacement[0];
    let (reference, _) = estimate::<f64>(table, session, Some(first), |v| v);
    let (single, raised) = estimate::<f32>(table, session, Some(first as f32), |v| v as f32);
    let single: Vec<f64> = single.into_iter().map(f64::from).collect();
    let measured = &session.displacement[1..];
    let instants = &session.instants[1..];
    let difference = |(a, b): (&f64, &f64)| (a - b).abs();
    Comparison {
        name: session.name.clone(),
        mil: Figures::of(&reference, measured),
        sil: Figures::of(&single, measured),
        mil_sil_um: reference.iter().zip(&single).map(difference).fold(0.0, f64::max),
        cold: cold(table, session),
        status: raised.into_iter().fold(Status::empty(), Status::union),
        trace: Trace {
            time_s: instants.iter().map(|&tick| session.start_s + f64::from(tick) * session.tick_s).collect(),
            // The last instant's own voltage is the one after the last tick that was run.
            voltage: instants.iter().map(|&tick| session.voltage[tick as usize]).collect(),
            measured: measured.to_vec(),
            estimated: reference,
        },
    }
}

fn cold(table: &Admitted, session: &Session) -> Cold {
    let (estimates, raised) = estimate::<f32>(table, session, None, |v| v as f32);
    let estimates: Vec<f64> = estimates.into_iter().map(f64::from).collect();
    let (instants, measured) = (&session.instants[1..], &session.displacement[1..]);
    let settled = raised.iter().position(|status| !status.contains(Status::NOT_SETTLED));
    Cold {
        all: Figures::of(&estimates, measured),
        settled: settled.map(|from| Figures::of(&estimates[from..], &measured[from..])),
        settled_after_s: settled.map(|from| f64::from(instants[from]) * session.tick_s),
    }
}

/// The estimates at the measured instants after the first, with the status bits that were raised on the way to each. `start`
/// is the displacement (µm) that the estimator is told.
fn estimate<T: Real>(
    table: &Admitted,
    session: &Session,
    start: Option<T>,
    number: impl Fn(f64) -> T,
) -> (Vec<T>, Vec<Status>) {
    let mut estimator = Estimator::new(table);
    if let Some(start) = start {
        estimator.start_at(start);
    }
    let mut estimates = Vec::with_capacity(session.displacement.len());
    let mut statuses = Vec::with_capacity(session.displacement.len());
    let mut tick = 0;
    for &instant in &session.instants[1..] {
        let mut displacement = T::nan();
        let mut raised = Status::empty();
        while tick < instant as usize {
            let estimate = estimator.tick_volts(number(session.voltage[tick] + f64::from(table.voltage_zero_v)));
            displacement = estimate.displacement;
            raised |= estimate.status;
            tick += 1;
        }
        estimates.push(displacement);
        statuses.push(raised);
    }
    (estimates, statuses)
}
