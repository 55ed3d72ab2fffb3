//! The model as a program without any of this project's means would have it: one candidate after the other, a sample at
//! a time, in `f64` and the standard library's functions. ln|V| is taken once for all candidates, so that a sample
//! costs two exponentials, and powers are taken at reversals only.

use estimator_core::{Tracker, VoigtParameters};
use identification::Problem;

/// A log, with what no candidate changes.
struct Log {
    voltage: Vec<f64>,
    ln_voltage: Vec<f64>,
    displacement: Vec<f64>,
}

/// The logs of a problem.
pub struct Plain {
    logs: Vec<Log>,
    tick_s: f64,
    deadband: f64,
}

impl Plain {
    /// Of a problem whose logs are measured at every tick, by the scheme of forward Euler.
    pub fn new(problem: &Problem) -> Self {
        let log = |session: &recordings::session::Session| {
            assert_eq!(session.instants.len(), session.voltage.len(), "measured at every tick");
            Log {
                voltage: session.voltage.clone(),
                ln_voltage: session.voltage.iter().map(|voltage| voltage.abs().ln()).collect(),
                displacement: session.displacement.clone(),
            }
        };
        Self { logs: problem.training().map(log).collect(), tick_s: problem.extent().tick, deadband: problem.deadband }
    }

    /// Mean absolute error (µm) of a candidate, in simulation or of one-step prediction.
    pub fn cost(&self, candidate: &VoigtParameters<f64>, one_step: bool) -> f64 {
        self.logs.iter().map(|log| self.of_log(log, candidate, one_step)).sum::<f64>() / self.logs.len() as f64
    }

    fn of_log(&self, log: &Log, p: &VoigtParameters<f64>, one_step: bool) -> f64 {
        let rate_scale = 1e6 / (p.alpha_um * p.lambda_per_v * p.b_ohm);
        let ln_drive_scale = 1e6_f64.ln() - p.p * p.b_ohm.ln();
        let e_um = p.e_m_per_s * 1e6_f64.powf(1.0 - p.f);
        let power = |value: f64, exponent: f64| value.abs().powf(exponent).copysign(value);
        let mut tracker = Tracker::new(self.deadband);
        let (mut displacement, mut extrema, mut sum) = (log.displacement[0], 0.0, 0.0);
        for ((&voltage, &ln_voltage), &measured) in log.voltage.iter().zip(&log.ln_voltage).zip(&log.displacement[1..])
        {
            if tracker.update(voltage, displacement) {
                let last = tracker.last();
                extrema = p.g_um_per_s * power(last.voltage, p.h) + e_um * power(last.displacement, p.f);
            }
            let x = (p.lambda_per_v * (p.beta_v - voltage)).exp();
            let rate = rate_scale * (2.0 + x + 1.0 / x);
            let drive = (p.p * ln_voltage + ln_drive_scale).exp().copysign(voltage);
            displacement += self.tick_s * (drive - rate * displacement + extrema);
            sum += (displacement - measured).abs();
            if one_step {
                displacement = measured;
            }
        }
        sum / (log.voltage.len() - 1) as f64
    }
}
