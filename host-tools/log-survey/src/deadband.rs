//! The deadband of reversals where nobody gives one: above what noise alone makes the voltage retreat by.

use crate::noise::noise_of;
use recordings::session::Session;

/// Of the voltage span, at least: a few steps of a 12-bit converter. No round fraction, so that a generated ramp does
/// not retreat by exactly the deadband in a tick, which f32 and f64 would see differently.
const LEAST: f64 = 0.83e-3;
/// Of the noise's standard deviation: the retreat from the highest of some thousand readings to the lowest.
const DEVIATIONS: f64 = 8.0;

/// The deadband (V) for sessions whose voltages have this span (V): the larger of 0.083 % of it and eight deviations of
/// the voltage's noise.
pub fn deadband(sessions: &[Session], span: f64) -> f64 {
    (LEAST * span).max(DEVIATIONS * noise(sessions.iter()).0)
}

/// One standard deviation of what voltage (V) and sensor (µm) are read with, that of the quietest session, since in
/// fast ones some of the course remains.
pub fn noise<'a>(sessions: impl Iterator<Item = &'a Session> + Clone) -> (f64, f64) {
    let quietest =
        |of: &dyn Fn(&Session) -> Option<f64>| sessions.clone().filter_map(of).reduce(f64::min).unwrap_or(0.0);
    let voltage = |session: &Session| {
        noise_of(&session.instants.iter().map(|&instant| session.voltage[instant as usize]).collect::<Vec<f64>>())
    };
    (quietest(&voltage), quietest(&|session| noise_of(&session.displacement)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, Normal};
    use std::f64::consts::TAU;

    /// Two seconds of a sine of ±20 V with noise on its voltage.
    fn sine(hertz: f64, noise_v: f64) -> Session {
        let mut draw = ChaCha8Rng::seed_from_u64(3);
        let noise = Normal::new(0.0, noise_v).unwrap();
        let voltage: Vec<f64> =
            (0..4000).map(|k| 20.0 * libm::sin(TAU * hertz * f64::from(k) * 5e-4) + noise.sample(&mut draw)).collect();
        let displacement = voltage.clone();
        Session::new("sine".into(), voltage, (0..4000).collect(), displacement, 5e-4)
    }

    fn of(sessions: &[Session]) -> f64 {
        deadband(sessions, 40.0)
    }

    #[test]
    fn a_clean_voltage_has_the_least_however_fast_it_is() {
        for hertz in [1.0, 10.0, 100.0] {
            assert_eq!(of(&[sine(hertz, 0.0)]), LEAST * 40.0, "{hertz} Hz");
        }
        assert_eq!(deadband(&[], 1.0), LEAST);
    }

    #[test]
    fn a_noisy_voltage_has_eight_deviations() {
        let found = of(&[sine(5.0, 0.05)]);
        assert!((found / 0.4 - 1.0).abs() < 0.1, "{found} V");
        let (volts, micrometres) = noise([sine(5.0, 0.05)].iter());
        assert!((volts / 0.05 - 1.0).abs() < 0.1 && micrometres == volts, "{volts} V, {micrometres} µm");
        let found = of(&[sine(300.0, 0.05), sine(5.0, 0.05)]);
        assert!((found / 0.4 - 1.0).abs() < 0.1, "{found} V: the slow one tells");
    }
}
