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
    fn only_a_large_error_at_the_beginning_is_a_transient() {
        let ripple = |k: usize| 0.1 * (k as f64).sin();
        assert_eq!(trace(ripple).transient_s(), None);
        let until = trace(|k| ripple(k) + if k < 30 { 1.0 } else { 0.0 }).transient_s().unwrap();
        assert!((until - 0.30).abs() < 1e-9, "{until}");
        assert_eq!(trace(|k| ripple(k) + if k % 200 < 30 { 1.0 } else { 0.0 }).transient_s(), None);
    }
}
