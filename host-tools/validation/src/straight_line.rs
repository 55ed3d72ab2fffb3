//! The straight line that every model is to better: what is left of the linear relation, Eq. (2.1), of an actuator
//! without load, one field and one strain. It knows neither hysteresis nor creep nor rate.
//!
//! ```text
//! y(n) = k·V(n − 1) + offset       µm at tick n
//! ```
//!
//! As every model's estimate of a tick it follows from the voltages before it. It is no choice of a table.

use crate::figures::Figures;
use crate::told::stroke;
use recordings::session::Session;

/// A voltage (V), the displacement (µm) that belongs to it, and the weight of the pair's squared error.
pub type Point = (f64, f64, f64);

/// Voltages that differ by less than this of their mean do so by rounding.
const SAME: f64 = 1e-9;

/// A displacement that is linear in the voltage.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StraightLine {
    /// The slope k, µm/V.
    pub gain_um_per_v: f64,
    /// A voltage (V) and its displacement (µm).
    at: (f64, f64),
}

impl StraightLine {
    /// As it is written in tables, beside the models.
    pub const NAME: &str = "straight line (2.1)";

    /// The line of least squares through points; `None` where their voltages do not differ.
    pub fn through(points: impl Iterator<Item = Point> + Clone) -> Option<Self> {
        let total: f64 = points.clone().map(|(_, _, weight)| weight).sum();
        let mean = |(v, y), (a, b, weight): Point| (v + weight * a / total, y + weight * b / total);
        let (mean_v, mean_y) = points.clone().fold((0.0, 0.0), mean);
        let (both, square) = points.fold((0.0, 0.0), |(both, square), (v, y, weight)| {
            (both + weight * ((v - mean_v) * (y - mean_y)), square + weight * ((v - mean_v) * (v - mean_v)))
        });
        let rests = total * (SAME * mean_v) * (SAME * mean_v);
        (square > rests).then(|| Self { gain_um_per_v: both / square, at: (mean_v, mean_y) })
    }

    /// The line of least squares through the measured instants of sessions, each session weighing the same whatever its
    /// length; `None` where the voltage does not move.
    pub fn fit<'a>(sessions: impl Iterator<Item = &'a Session> + Clone) -> Option<Self> {
        Self::through(sessions.flat_map(|session| {
            let weight = 1.0 / session.instants.len().saturating_sub(1).max(1) as f64;
            let measured = session.displacement.iter().skip(1);
            voltages(session).zip(measured).map(move |(voltage, &displacement)| (voltage, displacement, weight))
        }))
    }

    /// Displacement at 0 V, µm.
    pub fn offset_um(&self) -> f64 {
        self.displacement(0.0)
    }

    /// Displacement (µm) at a voltage (V).
    pub fn displacement(&self, voltage: f64) -> f64 {
        let (v, y) = self.at;
        y + self.gain_um_per_v * (voltage - v)
    }

    /// Voltage (V) of a displacement (µm); not finite where the line is level.
    pub fn voltage(&self, displacement: f64) -> f64 {
        let (v, y) = self.at;
        v + (displacement - y) / self.gain_um_per_v
    }

    /// Its errors on a session, where those of a table are ([`compare`](crate::compare)).
    pub fn errors(&self, session: &Session) -> Figures {
        let judged = session.lead_in.max(1);
        let estimated = voltages(session).skip(judged - 1).map(|voltage| self.displacement(voltage));
        let stroke_um = stroke(session, &(judged - 1..session.instants.len().saturating_sub(1)));
        let measured = session.displacement.get(judged..).unwrap_or_default();
        Figures::of(&estimated.collect::<Vec<f64>>(), measured, stroke_um)
    }
}

/// The voltage (V) of the tick before each measured instant after the first.
fn voltages(session: &Session) -> impl Iterator<Item = f64> + Clone {
    let before = |&instant: &u32| session.voltage.get((instant as usize).saturating_sub(1)).copied();
    session.instants.iter().skip(1).filter_map(before)
}
