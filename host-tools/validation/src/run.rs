//! The estimator run over a session.

use estimator_core::{Admitted, Estimator, Real, Status};
use recordings::session::Session;

/// Estimates at the measured instants after the first.
#[derive(Clone, Debug)]
pub struct Run {
    /// µm relative to the model's zero.
    pub estimated: Vec<f64>,
    /// Half-width of the interval of each, µm; `None` where there is none.
    pub half_width: Vec<Option<f64>>,
    /// What was raised on the way to each.
    pub status: Vec<Status>,
}

impl Run {
    /// Runs a table from the session's beginning at a precision. `start` is the displacement (µm) that the estimator is
    /// told; else it takes the actuator to have rested at the first voltage, or where the session says. At the `told`
    /// instant of them it is told the displacement, which moves nothing but what the interval is relative to.
    pub fn of<T: Real>(table: &Admitted, session: &Session, start: Option<f64>, told: Option<usize>) -> Self {
        let mut estimator = Estimator::<T>::new(table);
        if let Some(start) = start {
            estimator.start_at(number(start));
        }
        let count = session.displacement.len();
        if let Some(rest) = session.rested_v {
            estimator.tick_volts(number(rest + f64::from(table.voltage_zero_v)));
        }
        let mut run = Self { estimated: Vec::with_capacity(count), half_width: Vec::new(), status: Vec::new() };
        let mut tick = 0;
        for (index, &instant) in session.instants[1..].iter().enumerate() {
            let (mut displacement, mut half_width) = (T::nan(), None);
            let mut raised = Status::empty();
            while tick < instant as usize {
                let estimate = estimator.tick_volts(number(session.voltage[tick] + f64::from(table.voltage_zero_v)));
                (displacement, half_width) = (estimate.displacement, estimate.half_width);
                raised |= estimate.status;
                tick += 1;
            }
            run.estimated.push(displacement.to_f64().unwrap_or(f64::NAN));
            run.half_width.push(half_width.and_then(|half| half.to_f64()));
            run.status.push(raised);
            if told == Some(index) {
                estimator.tell();
            }
        }
        run
    }

    /// Estimate − sensor, µm.
    pub fn errors(&self, session: &Session) -> Vec<f64> {
        let measured = session.displacement.iter().skip(1);
        self.estimated.iter().zip(measured).map(|(estimated, measured)| estimated - measured).collect()
    }
}

/// A number at the run's precision, rounded once.
fn number<T: Real>(value: f64) -> T {
    T::from(value).unwrap_or_else(T::nan)
}
