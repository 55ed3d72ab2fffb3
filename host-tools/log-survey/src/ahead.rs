//! A displacement that runs ahead of the voltage. Hysteresis, creep, lag and a late sensor all make it run behind: on a
//! loop the displacement is lower while the voltage rises than while it falls. Where it is the other way round, what is
//! taken for the voltage may be the displacement.
//!
//! ```text
//! ahead = ∮ y dV / (ΔV·Δy)     of a loop over the voltages that both of its branches have; below 0 of an actuator
//! ```

use crate::noise::noise_of;
use crate::reversals::reversals;
use crate::signal::range;
use estimator_core::Range;
use recordings::log::Log;
use serde::Serialize;

/// A displacement that runs ahead of the voltage.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Ahead {
    /// By how much of its way on the slowest loops, on average, %.
    pub percent: f64,
    /// Loops that say so.
    pub loops: usize,
}

/// A swing of the voltage, of its range, at least, and in deviations of its noise.
const SWING: f64 = 0.1;
const DEVIATIONS: f64 = 8.0;
/// Voltages that both branches of a loop have, of the range, at least.
const SHARED: f64 = 0.25;
/// Fewest loops that say something.
const FEWEST: usize = 3;
/// What is ahead by less is none that is taken for exchanged columns: an actuator is several times as far behind.
const LEAST: f64 = 0.01;
/// Standard errors that must lie between.
const SURELY: f64 = 2.0;
/// The voltage may be read so much later than the displacement, s, and by a row.
const LATE_S: f64 = 1e-3;
/// Loops are looked at on which that does so much, or so many times what it does on the slowest.
const LATE: f64 = 0.005;
const AS_SLOW: f64 = 2.0;

/// What of a log runs the wrong way round; `None` where nothing does, or the displacement is no sensor's.
pub fn ahead(log: &Log) -> Option<Ahead> {
    let displacement = log.displacement.as_deref().filter(|_| !log.displacement_estimated)?;
    in_rows(&log.voltage, displacement, log.sample_period)
}

/// The same of rows, one a `period`, s.
pub(crate) fn in_rows(voltage: &[f64], displacement: &[f64], period: f64) -> Option<Ahead> {
    let whole = range(voltage);
    let noise = noise_of(voltage)?;
    let turns = reversals(voltage, (SWING * whole).max(DEVIATIONS * noise));
    let mut loops: Vec<Loop> = turns
        .windows(3)
        .filter_map(|turns| Loop::of(voltage, displacement, [turns[0], turns[1], turns[2]], SHARED * whole))
        .collect();
    loops.sort_by(|one, other| one.a_row_late.total_cmp(&other.a_row_late));
    let late = (LATE_S / period).max(1.0);
    let slow = LATE.max(AS_SLOW * late * loops.get(FEWEST - 1)?.a_row_late);
    loops.retain(|of| late * of.a_row_late <= slow);
    let surplus: Vec<f64> = loops.iter().map(|of| of.ahead - late * of.a_row_late).collect();
    let count = loops.len() as f64;
    let mean = surplus.iter().sum::<f64>() / count;
    let variance = surplus.iter().map(|of| (of - mean) * (of - mean)).sum::<f64>() / (count - 1.0);
    let percent = 100.0 * loops.iter().map(|of| of.ahead).sum::<f64>() / count;
    (mean - SURELY * (variance / count).sqrt() > LEAST).then_some(Ahead { percent, loops: loops.len() })
}

/// Two branches, and how far the displacement is ahead on them, of its way.
struct Loop {
    ahead: f64,
    /// How far it would be ahead if the voltage were read a row late, of its way.
    a_row_late: f64,
}

impl Loop {
    /// The loop from a reversal to the next but one; `None` where its branches share less than so many volts, or
    /// the displacement rests.
    fn of(voltage: &[f64], displacement: &[f64], [from, turn, to]: [usize; 3], least_v: f64) -> Option<Self> {
        let ends = [from, to].map(|end| voltage[end]);
        let nearer = if voltage[turn] > ends[0] { ends[0].max(ends[1]) } else { ends[0].min(ends[1]) };
        let shared = Range { min: voltage[turn].min(nearer), max: voltage[turn].max(nearer) };
        let (mut area, mut late, mut way) = (0.0, 0.0, Range::empty());
        for row in from..to {
            let ([v, next_v], [y, next_y]) =
                ([voltage[row], voltage[row + 1]], [displacement[row], displacement[row + 1]]);
            let [begin, end] = [v, next_v].map(|volts| shared.clamp(volts));
            if begin != end {
                let at = |volts: f64| y + (volts - v) / (next_v - v) * (next_y - y);
                late += (at(end) - at(begin)) * (end - begin);
                area += 0.5 * (at(begin) + at(end)) * (end - begin);
                way = way.include(at(begin)).include(at(end));
            }
        }
        // A sensor that is mounted the other way falls while the voltage rises.
        let rises = (displacement[turn] - displacement[from]) * (voltage[turn] - voltage[from]) > 0.0;
        let box_of = shared.span() * way.span();
        (shared.span() >= least_v && box_of > 0.0)
            .then(|| Self { ahead: if rises { area } else { -area } / box_of, a_row_late: late.abs() / box_of })
    }
}
