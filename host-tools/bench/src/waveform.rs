//! A waveform for a device's memory: what a log says of it, and whether the device's own model follows it before
//! anything is sent.

use crate::described::believed;
use device_link::{Client, LinkError, words};
use estimator_core::{Admitted, DriveCalibration, DriveLimits, NoInverse, Pace, Transition};
use feedforward::{Trajectory, near, plan, reach};
use protocol::waveform::checksum;
use protocol::{Health, MOST_POINTS, Mode, Playback};
use recordings::log::Log;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};
use std::num::NonZeroU16;

/// Part of a tick by which points may be off.
const OFF: f64 = 1e-3;
/// Most ticks that are looked at ahead of time; of a line that is longer, its beginning is.
const LOOKED_AT: usize = 2_000_000;

/// Points, µm relative to the model's zero, and how far they are apart.
#[derive(Clone, PartialEq, Debug)]
pub struct Waveform {
    points: Vec<f32>,
    count: NonZeroU16,
    every: NonZeroU16,
}

/// Why a waveform is not played, or a trajectory not followed.
#[derive(Debug, thiserror::Error)]
pub enum WaveformError {
    /// Its points are not so many ticks apart as can be said.
    #[error("its points are {:.6} ms apart, {:.3} ticks: it must be a whole number of ticks, 1 … 65,535", 1e3 * period_s, period_s / tick_s)]
    NotTicks {
        /// How far the points are apart, s.
        period_s: f64,
        /// The device's tick, s.
        tick_s: f64,
    },
    /// A device has no room for it.
    #[error("it has {0} points, and a device keeps 1 … {MOST_POINTS}")]
    Points(usize),
    /// The device cannot follow it.
    #[error(
        "on {limited} of its {ticks} ticks the voltage or its slew rate would stand at a limit, and the displacement be up to \
         {off_um:.3} µm off, where {:.2} … {:.2} µm can be held; nothing was sent", reach_um[0], reach_um[1]
    )]
    OutOfReach {
        /// Ticks at a limit.
        limited: usize,
        /// Ticks of a line, or of a trajectory.
        ticks: usize,
        /// Largest distance of the model from what is wanted, µm.
        off_um: f64,
        /// What can be held, µm.
        reach_um: [f64; 2],
    },
    /// It cannot begin where it is to.
    #[error(
        "its first point, {first_um} µm, is beyond what can be held, {:.2} … {:.2} µm; nothing was sent", reach_um[0], reach_um[1]
    )]
    Beyond {
        /// The first point, µm.
        first_um: f32,
        /// What can be held, µm.
        reach_um: [f64; 2],
    },
    /// The way to its first point takes longer than is looked at.
    #[error(
        "at the drive's slew rate the way to its first point takes {0} ticks, and no more than {LOOKED_AT} are looked at ahead of time"
    )]
    LongWay(u32),
    /// The device's table has no inverse.
    #[error(transparent)]
    Inverse(#[from] NoInverse),
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// It is to be left, and is not played.
    #[error("the device {}: there is nothing to leave", words::mode(*.0))]
    NotPlayed(Mode),
    /// The device's table says nothing of a drive.
    #[error("the device's table does not say how the DAC drives the amplifier")]
    NoDrive,
}

/// A waveform that has been left.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Left {
    /// Lines that had begun.
    pub lines: u32,
    /// Triggers that began none: on the way to the first point, or during a line.
    pub triggers_ignored: u32,
}

impl Display for Left {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { lines, triggers_ignored } = self;
        write!(
            f,
            "The device leaves its waveform after {lines} lines and {triggers_ignored} triggers that came too early; its "
        )?;
        f.write_str("voltage goes to rest at the drive's slew rate, and it estimates")
    }
}

/// Has the device leave its waveform.
///
/// # Errors
/// It plays none, the link fails, or the device refuses.
pub fn leave(client: &mut Client) -> Result<Left, WaveformError> {
    let Health { mode, lines, triggers_ignored, .. } = client.health()?;
    if mode != Mode::Waveform {
        return Err(WaveformError::NotPlayed(mode));
    }
    client.set_mode(Mode::Estimate)?;
    Ok(Left { lines, triggers_ignored })
}

/// What comes of a waveform.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Foreseen {
    /// How many points it has.
    pub points: usize,
    /// Ticks from each to the next.
    pub every_ticks: u16,
    /// From the beginning of a line to that of the next, ticks.
    pub line_ticks: usize,
    /// Of them, the way back from the last point, where it is not as long as those between points.
    pub back_ticks: Option<u32>,
    /// From rest to the first point, ticks.
    pub approach_ticks: u32,
    /// Ticks of a line that were judged: all, where there are not too many of them.
    pub judged_ticks: usize,
    /// Largest distance of the model from what is wanted on them, µm.
    pub off_um: f64,
    /// Mean error of the model itself on what was held out when it was identified, µm.
    pub held_out_mae_um: Option<f32>,
}

impl Foreseen {
    /// The same in words, at so many seconds a tick.
    pub fn said(&self, tick_s: f64) -> String {
        let Self { points, every_ticks, line_ticks, back_ticks, approach_ticks, judged_ticks, off_um, held_out_mae_um } =
            *self;
        let line_s = line_ticks as f64 * tick_s;
        let back = back_ticks.map_or(String::new(), |ticks| {
            format!(", {:.4} s of it back to its first point", f64::from(ticks) * tick_s)
        });
        let judged = match judged_ticks == line_ticks {
            true => "within a line".to_owned(),
            false => {
                format!("in the first {judged_ticks} of its {line_ticks} ticks, and was not asked about the others")
            }
        };
        format!(
            "{points} points of {every_ticks} ticks: a line takes {line_s:.4} s ({:.3} a second){back}; from rest to its first point, \
             {:.3} s. The device's model is {off_um:.4} µm off at most {judged}. {}",
            1.0 / line_s,
            f64::from(approach_ticks) * tick_s,
            believed(held_out_mae_um)
        )
    }
}

/// Refuses what cannot begin where it is to, µm.
pub(crate) fn begins_in_reach(table: &Admitted, limits: &DriveLimits, first_um: f32) -> Result<(), WaveformError> {
    let reach_um = reach(table, limits);
    let (low, high, near) = (reach_um[0].min(reach_um[1]), reach_um[0].max(reach_um[1]), near(table));
    match (low - near..=high + near).contains(&f64::from(first_um)) {
        true => Ok(()),
        false => Err(WaveformError::Beyond { first_um, reach_um }),
    }
}

impl Waveform {
    /// The displacements of a log, as far apart as it says, or `every` so many ticks (s).
    ///
    /// # Errors
    /// There is no room for so many, or they are not a whole number of ticks apart.
    pub fn of(log: &Log, tick_s: f64, every: Option<NonZeroU16>) -> Result<Self, WaveformError> {
        let points: Vec<f32> = log.displacement.iter().flatten().map(|&um| um as f32).collect();
        let count = u16::try_from(points.len()).ok().filter(|_| points.len() <= MOST_POINTS).and_then(NonZeroU16::new);
        let count = count.ok_or(WaveformError::Points(points.len()))?;
        let ticks = log.sample_period / tick_s;
        let whole = (ticks - ticks.round()).abs() < OFF && (1.0..65_535.5).contains(&ticks.round());
        // Whole numbers up to 65,535.
        let stated = NonZeroU16::new(ticks.round() as u16).filter(|_| whole);
        let every = every.or(stated).ok_or(WaveformError::NotTicks { period_s: log.sample_period, tick_s })?;
        Ok(Self { points, count, every })
    }

    /// What comes of it on the device that has this table, by its own model.
    ///
    /// # Errors
    /// The table does not drive, or a limit is in the way of a line.
    pub fn foreseen(&self, table: &Admitted) -> Result<Foreseen, WaveformError> {
        let (DriveCalibration { limits, .. }, pace) = table.drive.zip(Pace::of(table)).ok_or(WaveformError::NoDrive)?;
        let rest = table.inverse::<f32>(&limits)?.release().displacement;
        let (first, last) = (self.points[0], self.points[self.points.len() - 1]);
        begins_in_reach(table, &limits, first)?;
        let (reach_um, near) = (reach(table, &limits), near(table));
        let approach_ticks = pace.ticks(rest, first);
        let back_ticks = pace.back(last, first, self.every.get());
        let (between, every) = ((self.points.len() - 1) * usize::from(self.every.get()), usize::from(self.every.get()));
        let line_ticks = between + back_ticks.map_or(every, |ticks| ticks as usize);
        let back = back_ticks.map(|ticks| Transition::new(last, first, ticks));
        let of_line = |tick: usize| match back {
            // Less than a way's ticks.
            Some(back) if tick > between => back.at((tick - between) as u32),
            _ => self.straight(tick),
        };
        let approach = Transition::new(rest, first, approach_ticks);
        let lead = (1..approach_ticks).map(|tick| approach.at(tick));
        // The second is like all others.
        let lines = (0..2 * line_ticks).map(|tick| of_line(tick % line_ticks));
        let wanted: Vec<f64> = lead.chain(lines).map(f64::from).take(LOOKED_AT).collect();
        let plan = plan(table, &limits, &Trajectory(wanted))?;
        let from = approach_ticks as usize - 1;
        let from = if from + 2 * line_ticks <= plan.wanted.len() { from + line_ticks } else { from };
        let ticks = line_ticks.min(plan.wanted.len().saturating_sub(from));
        if ticks == 0 {
            return Err(WaveformError::LongWay(approach_ticks));
        }
        let off = |tick: usize| (plan.displacement[tick] - plan.wanted[tick]).abs();
        let off_um = (from..from + ticks).map(off).fold(0.0, f64::max);
        let limited = plan.limited[from..from + ticks].iter().filter(|&&limited| limited).count();
        if limited > 0 && off_um >= near {
            return Err(WaveformError::OutOfReach { limited, ticks, off_um, reach_um });
        }
        let (points, every_ticks) = (self.points.len(), self.every.get());
        let held_out_mae_um = table.provenance.validation_mae_um;
        Ok(Foreseen {
            points,
            every_ticks,
            line_ticks,
            back_ticks,
            approach_ticks,
            judged_ticks: ticks,
            off_um,
            held_out_mae_um,
        })
    }

    /// What lies between two points, and behind the last one.
    fn straight(&self, tick: usize) -> f32 {
        let every = usize::from(self.every.get());
        let (point, behind) = (tick / every, tick % every);
        let (here, next) = (self.points[point], self.points[(point + 1) % self.points.len()]);
        here + (next - here) * (behind as f32 / f32::from(self.every.get()))
    }

    /// Loads it into a device and has it played: so many lines, or for ever where there are 0.
    ///
    /// # Errors
    /// The link fails, or the device refuses.
    pub fn play(&self, client: &mut Client, lines: u32, on_trigger: bool) -> Result<(), WaveformError> {
        client.load(&self.points)?;
        let crc = checksum(self.points.iter().copied());
        Ok(client.play(Playback { points: self.count, crc, every: self.every, lines, on_trigger })?)
    }
}

#[cfg(test)]
mod tests;
