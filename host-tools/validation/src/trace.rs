//! An estimate beside the sensor, instant by instant.

/// An estimate beside the sensor, at the measured instants after the first.
#[derive(Clone, PartialEq, Debug, Default)]
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

/// Errors in the first tenth of a log beyond this multiple of the largest later on are a transient.
const TRANSIENT: f64 = 2.0;

impl Trace {
    /// Without what lies before an instant.
    pub(crate) fn since(self, from: usize) -> Self {
        let rest = |values: Vec<f64>| values.into_iter().skip(from).collect();
        Self {
            time_s: rest(self.time_s),
            voltage: rest(self.voltage),
            measured: rest(self.measured),
            estimated: rest(self.estimated),
        }
    }

    /// How long the first tenth has errors beyond twice the largest of the rest, s; `None` where it has none.
    pub fn transient_s(&self) -> Option<f64> {
        let errors: Vec<f64> = self.estimated.iter().zip(&self.measured).map(|(e, m)| (e - m).abs()).collect();
        let (early, rest) = errors.split_at(errors.len() / 10);
        let large = TRANSIENT * rest.iter().copied().fold(0.0, f64::max);
        let last = early.iter().rposition(|&error| error > large)?;
        // The first time is that of the second sample.
        Some(self.time_s[last + 1] - self.time_s[0])
    }

    /// By how much the error changes from the first instant to the last, by the straight line of least squares through
    /// it, and the rms of what that line leaves, µm; `None` of fewer than three instants.
    pub fn trend_um(&self) -> Option<(f64, f64)> {
        let errors = || self.estimated.iter().zip(&self.measured).map(|(estimate, measured)| estimate - measured);
        let (first, last) = (self.time_s.first()?, self.time_s.last()?);
        let count = self.time_s.len();
        let (middle, mean) = (self.time_s.iter().sum::<f64>() / count as f64, errors().sum::<f64>() / count as f64);
        let [along, together] = self.time_s.iter().zip(errors()).fold([0.0; 2], |[along, together], (time, error)| {
            [along + (time - middle).powi(2), together + (time - middle) * (error - mean)]
        });
        let slope = together / along;
        let left = self.time_s.iter().zip(errors()).map(|(time, error)| error - mean - slope * (time - middle));
        let rms = (left.map(|of| of * of).sum::<f64>() / count as f64).sqrt();
        (count > 2 && along > 0.0).then(|| (slope * (last - first), rms))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trace(error: impl Fn(usize) -> f64) -> Trace {
        let measured = vec![0.0; 1000];
        Trace {
            time_s: (0..1000).map(|k| k as f64 * 0.01).collect(),
            voltage: measured.clone(),
            estimated: (0..1000).map(error).collect(),
            measured,
        }
    }

    #[test]
    fn a_trend_is_a_line_s_and_a_ripple_is_none() {
        let ripple = |k: usize| 0.1 * (k as f64 * 0.2).sin();
        let (by_um, left) = trace(|k| 0.002 * k as f64 + ripple(k)).trend_um().unwrap();
        assert!((by_um - 1.998).abs() < 0.01 && (left - 0.0707).abs() < 1e-3, "{by_um} {left}");
        assert!(trace(ripple).trend_um().unwrap().0.abs() < 0.01);
        assert_eq!(Trace::default().trend_um(), None);
    }

    #[test]
    fn only_a_large_error_at_the_beginning_is_a_transient() {
        let ripple = |k: usize| 0.1 * (k as f64).sin();
        assert_eq!(trace(ripple).transient_s(), None);
        let until = trace(|k| ripple(k) + if k < 30 { 1.0 } else { 0.0 }).transient_s().unwrap();
        assert!((until - 0.30).abs() < 1e-9, "{until}");
        assert_eq!(trace(|k| ripple(k) + if k % 200 < 30 { 1.0 } else { 0.0 }).transient_s(), None);
    }
}
