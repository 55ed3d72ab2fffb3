//! What comes of a trajectory, before a device follows it: the way there from rest, what a limit keeps out of reach,
//! and what does not count because it begins at a speed.

use crate::waveform::{WaveformError, begins_in_reach};
use device_link::streamed::Streamed;
use estimator_core::{Admitted, DriveCalibration, DriveLimits, Estimator, Status};
use feedforward::{Plan, Trajectory, approach, near, plan, reach};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::ops::Range;

/// Ticks in which the way over the drive's range is looked at, at most.
const LONGEST_RANGE: f64 = 1e6;

/// A trajectory that no limit is in the way of, and the way there from rest.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Foreseen {
    /// Both, by the device's own model.
    #[serde(skip)]
    pub plan: Plan,
    /// Ticks of the way there.
    #[serde(rename = "approach_ticks")]
    pub begins: usize,
    /// Ticks of the trajectory whose errors do not count: it may begin at a speed that the displacement has only
    /// a moment later.
    #[serde(rename = "uncounted_ticks")]
    pub uncounted: usize,
    /// How far the model is off the trajectory there, µm.
    pub uncounted_off_um: f64,
    /// How far the model is off the trajectory, µm.
    pub off_um: f64,
    /// On how many ticks of the trajectory a limit is in the way; none where that leads nowhere off.
    #[serde(rename = "limited_ticks")]
    pub limited: usize,
}

impl Foreseen {
    /// What comes of a trajectory on the device that has this table.
    ///
    /// # Errors
    /// The table does not drive; or a limit keeps the model off by `allowed_um`, without it by what counts as off.
    pub fn of(table: &Admitted, trajectory: &Trajectory, allowed_um: Option<f64>) -> Result<Self, WaveformError> {
        let DriveCalibration { limits, .. } = table.drive.ok_or(WaveformError::NoDrive)?;
        if allowed_um.is_none() {
            begins_in_reach(table, &limits, trajectory.at(0.0) as f32)?;
        }
        let mut whole = approach(table, &limits, trajectory)?;
        let begins = whole.len();
        whole.extend(&trajectory.0);
        let plan = plan(table, &limits, &Trajectory(whole))?;
        // A tick's voltage is for what is wanted so many ticks later.
        let ahead = (1.0 + table.parameters.delay_ticks()).ceil() as usize;
        let (near, end) = (near(table), plan.wanted.len());
        let limited = |ticks: Range<usize>| ticks.filter(|&tick| plan.limited[tick]);
        // A moment is no longer than the voltage takes for its range, and no speed is come to that it cannot have.
        let (ticks_of_range, fastest) = fastest(table, &limits);
        let too_fast = trajectory.0.windows(2).position(|pair| (pair[1] - pair[0]).abs() > fastest);
        let moment = begins + too_fast.unwrap_or(trajectory.0.len()).min(ticks_of_range);
        let before = begins.saturating_sub(ahead);
        let last = limited(before..moment.saturating_sub(ahead)).next_back();
        // Of a trajectory that is over before its speed is come to all counts.
        let uncounted = last.map_or(0, |tick| tick + ahead + 1 - begins);
        let uncounted = if begins + uncounted < end { uncounted } else { 0 };
        let counts = begins + uncounted;
        let uncounted_off_um = plan.off(begins..counts);
        let off_um = plan.off(counts..end);
        let in_the_way = limited(counts.saturating_sub(ahead)..end).next();
        let short_um = in_the_way.map(|tick| plan.off(tick.max(counts)..end));
        let limited = limited(before..end).count();
        if let Some(off_um) = short_um.filter(|short_um| *short_um >= allowed_um.unwrap_or(near)) {
            let (ticks, reach_um) = (trajectory.0.len(), reach(table, &limits));
            return Err(WaveformError::OutOfReach { limited, ticks, off_um, reach_um });
        }
        let limited = if off_um < near { 0 } else { limited };
        Ok(Self { plan, begins, uncounted, uncounted_off_um, off_um, limited })
    }

    /// What the device said of it in these samples.
    pub fn reached(&self, samples: &[Streamed]) -> Reached {
        let mut status = samples.iter().fold(Status::empty(), |all, of| all | of.sample.status);
        let own = || samples.iter().filter(|of| of.tick >= self.begins);
        let limited = own().filter(|of| of.sample.status.contains(Status::OUT_OF_REACH)).count();
        status.set(Status::OUT_OF_REACH, limited > 0 && self.limited > 0);
        Reached { status, limited, ticks: own().count() }
    }

    /// From which tick on errors count.
    pub fn counts(&self) -> usize {
        self.begins + self.uncounted
    }

    /// What of it does not count, in words.
    pub(crate) fn aside(&self) -> String {
        match self.uncounted {
            0 => String::new(),
            ticks => format!(
                " without its first {ticks} ticks (it begins at a speed, and there the model is up to {:.4} µm off),",
                self.uncounted_off_um
            ),
        }
    }
}

impl Display for Foreseen {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { plan, begins, off_um, limited, .. } = self;
        write!(
            f,
            "{} ticks, the first {begins} of them from rest to where the trajectory begins; the device's model is {off_um:.4} µm off it at \
             most,{} with a limit in the way on {limited} of its ticks; nothing was driven",
            plan.voltage.len(),
            self.aside()
        )
    }
}

/// Ticks that the voltage takes for the drive's range at its slew rate, and the fastest that the displacement goes on
/// the way up and back, µm a tick.
fn fastest(table: &Admitted, limits: &DriveLimits) -> (usize, f64) {
    let estimator_core::Range { min, max } = limits.range_v;
    let ticks = (f64::from(max - min) / (f64::from(limits.slew_v_per_s) * table.sample_period::<f64>())).ceil();
    let ticks = ticks.clamp(1.0, LONGEST_RANGE) as usize;
    let mut model = Estimator::<f64>::new(table).of_held_voltage();
    let mut at = |volts: f64| model.tick_volts(volts).displacement;
    let mut last = at(min.into());
    let up = (0..=ticks).map(|k| f64::from(min) + f64::from(max - min) * k as f64 / ticks as f64);
    let fastest = up.clone().chain(up.rev()).fold(0.0, |most: f64, volts| {
        let before = std::mem::replace(&mut last, at(volts));
        most.max((last - before).abs())
    });
    (ticks, fastest)
}

/// What the device said of a trajectory.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reached {
    /// Of all that it did, but for limits that lead nowhere off or were in the way there.
    pub status: Status,
    /// On how many ticks of the trajectory it was at a limit.
    pub limited: usize,
    /// Ticks of the trajectory, all of them.
    pub ticks: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{GeneralisedPrandtlIshlinskiiParameters, Parameters, Table};
    use std::path::Path;
    use table_files::TableFile;

    /// A table that drives 3.6 V in 90 ms, with a delay in ticks.
    fn delayed(delay_ticks: f32) -> Admitted {
        let models = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/table/models");
        let (_, table) = TableFile::load(&Path::new(models).join("generalised-prandtl-ishlinskii.toml")).unwrap();
        let Parameters::GeneralisedPrandtlIshlinskii(of) = table.parameters else { panic!("another model") };
        let of = GeneralisedPrandtlIshlinskiiParameters { delay_ticks, ..of };
        let limits =
            DriveLimits { range_v: estimator_core::Range { min: 0.0, max: 3.6 }, rest_v: 0.0, slew_v_per_s: 40.0 };
        let drive = DriveCalibration { gain_codes_per_v: 1000.0, offset_code: 0.0, limits, setpoint: None };
        let parameters = Parameters::GeneralisedPrandtlIshlinskii(of);
        Table { parameters, drive: Some(drive), ..*table }.admit().unwrap()
    }

    /// Held at `at` µm, then from a tick on by so many µm a tick.
    fn trajectory(at: f64, from: usize, per_tick: f64, most: f64) -> Trajectory {
        Trajectory((0..600).map(|tick: usize| at + most.min(per_tick * tick.saturating_sub(from) as f64)).collect())
    }

    #[test]
    fn a_step_is_refused_however_late_the_displacement_is_and_a_speed_is_come_to() {
        for delay_ticks in [0.0, 8.0] {
            let table = delayed(delay_ticks);
            let (_, fastest) = fastest(&table, &table.drive.unwrap().limits);
            let rest = Estimator::<f64>::new(&table).of_held_voltage().tick_volts(0.0).displacement;
            for (at, from) in [15.0, rest].into_iter().flat_map(|at| [0, 1, 5, 20, 100, 400].map(|from| (at, from))) {
                // The voltage goes as far within the delay.
                let step = Foreseen::of(&table, &trajectory(at, from, 5.0 * fastest, 5.0 * fastest), None)
                    .map(|of| of.uncounted);
                assert!(
                    matches!(step, Err(WaveformError::OutOfReach { .. })),
                    "{delay_ticks}, {at} µm, {from}: {step:?}"
                );
            }
            let ramp = Foreseen::of(&table, &trajectory(15.0, 0, 0.5 * fastest, 20.0), None).unwrap();
            let Foreseen { uncounted, uncounted_off_um, off_um, .. } = ramp;
            assert!(off_um < near(&table) && (1..=180).contains(&uncounted), "{uncounted} ticks, then {off_um} µm off");
            assert!(uncounted_off_um >= near(&table), "{uncounted_off_um} µm");
            // Over before that speed is come to, it is not met.
            let short = Trajectory(trajectory(15.0, 0, 0.9 * fastest, f64::MAX).0[..20].to_vec());
            let short = Foreseen::of(&table, &short, None).map(|of| of.uncounted);
            assert!(matches!(short, Err(WaveformError::OutOfReach { .. })), "{delay_ticks}: {short:?}");
        }
    }
}
