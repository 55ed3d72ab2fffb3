//! The straight line that every model is to better: what is left of the linear relation, Eq. (2.1), of an actuator
//! without load, one field and one strain. It knows neither hysteresis nor creep nor rate.
//!
//! ```text
//! y(n) = k·V(n − 1) + offset       µm at tick n
//! ```
//!
//! As every model's estimate of a tick it follows from the voltages before it. It is no choice of a table.

use crate::problem::Problem;
use crate::validate::Figures;
use recordings::session::Session;
use serde::Serialize;

/// A voltage (V), the displacement (µm) that belongs to it, and the weight of the pair's squared error.
pub type Point = (f64, f64, f64);

/// Voltages that differ by less than this of their mean do so by rounding.
const SAME: f64 = 1e-9;

/// A displacement that is linear in the voltage.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct StraightLine {
    /// k, µm/V.
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

    /// Its errors on a session, as those of a table ([`compare`](crate::validate::compare)): at the measured instants
    /// after the first.
    pub fn errors(&self, session: &Session) -> Figures {
        let estimated: Vec<f64> = voltages(session).map(|voltage| self.displacement(voltage)).collect();
        Figures::of(&estimated, session.displacement.get(1..).unwrap_or_default())
    }
}

/// Errors of the straight line through a problem's training sessions.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Baseline {
    /// Gain, µm/V.
    pub gain_um_per_v: f64,
    /// Displacement at 0 V, µm.
    pub offset_um: f64,
    /// Over all that it was fitted to.
    pub training: Figures,
    /// Over all that was held out; `None` where nothing was.
    pub held_out: Option<Figures>,
}

impl Baseline {
    /// Of a problem; `None` where its training voltage does not move.
    pub fn of(problem: &Problem) -> Option<Self> {
        let line = StraightLine::fit(problem.training())?;
        let over = |sessions: &mut dyn Iterator<Item = &Session>| {
            let errors: Vec<Figures> = sessions.map(|session| line.errors(session)).collect();
            Figures::all(errors.iter())
        };
        Some(Self {
            gain_um_per_v: line.gain_um_per_v,
            offset_um: line.offset_um(),
            training: over(&mut problem.training())?,
            held_out: over(&mut problem.validation()),
        })
    }
}

/// The voltage (V) of the tick before each measured instant after the first.
fn voltages(session: &Session) -> impl Iterator<Item = f64> + Clone {
    let before = |&instant: &u32| session.voltage.get((instant as usize).saturating_sub(1)).copied();
    session.instants.iter().skip(1).filter_map(before)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `y(n) = 0.2·V(n − 1) − 0.5` µm with an error, measured every `every` ticks.
    fn session(ticks: u32, every: usize, error: impl Fn(u32) -> f64) -> Session {
        let voltage: Vec<f64> = (0..ticks).map(|k| 20.0 * (f64::from(k) * 0.01).sin()).collect();
        let instants: Vec<u32> = (0..ticks).step_by(every).collect();
        let at = |k: &u32| 0.2 * voltage[k.saturating_sub(1) as usize] - 0.5 + error(*k);
        let displacement = instants.iter().map(at).collect();
        Session::new("made".to_owned(), voltage, instants, displacement, 5e-4)
    }

    #[test]
    fn a_line_is_found_from_the_voltage_before_each_instant_and_has_no_error() {
        for every in [1, 7] {
            let session = session(2000, every, |_| 0.0);
            let line = StraightLine::fit(std::iter::once(&session)).unwrap();
            assert!((line.gain_um_per_v - 0.2).abs() < 1e-12 && (line.offset_um() + 0.5).abs() < 1e-12, "{line:?}");
            assert!(line.errors(&session).max_um < 1e-12);
            assert!((line.voltage(line.displacement(3.0)) - 3.0).abs() < 1e-12);
        }
    }

    #[test]
    fn errors_of_a_known_ripple_are_its_own() {
        let ripple = session(2001, 1, |k| if k % 2 == 0 { 0.03 } else { -0.03 });
        let line = StraightLine::fit(std::iter::once(&session(2001, 1, |_| 0.0))).unwrap();
        let errors = line.errors(&ripple);
        for error in [errors.mae_um, errors.rmse_um, errors.max_um] {
            assert!((error - 0.03).abs() < 1e-12, "{errors:?}");
        }
    }

    /// Two logs with other offsets: the mean of them, although one is ten times as long.
    #[test]
    fn each_session_weighs_the_same() {
        let (short, long) = (session(629, 1, |_| 0.1), session(6284, 1, |_| -0.1));
        let line = StraightLine::fit([&short, &long].into_iter()).unwrap();
        assert!((line.offset_um() + 0.5).abs() < 1e-3, "{line:?}");
    }

    #[test]
    fn a_voltage_that_rests_has_no_line() {
        let mut session = session(100, 1, |_| 0.0);
        session.voltage.fill(3.0);
        assert_eq!(StraightLine::fit(std::iter::once(&session)), None);
    }
}
