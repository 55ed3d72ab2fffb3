//! When the instruments beside an emulated bench are worth reading.

/// How many looks in a row must show the same, and what that is, V and µm.
const STILL: u32 = 5;
const SAME_V: f64 = 0.05;
const SAME_UM: f64 = 2e-3;

/// What was seen of the instruments, V and µm, look by look.
#[derive(Default)]
pub struct Readings {
    last: (f64, f64),
    times: u32,
    told: Option<f64>,
}

impl Readings {
    /// Whether a voltage, and what it moves with it, has come to stand still that is another than the one of which this
    /// was said last.
    pub fn still_anew(&mut self, volts: f64, um: f64) -> bool {
        let same = (volts - self.last.0).abs() < SAME_V && (um - self.last.1).abs() < SAME_UM;
        self.times = if same { self.times + 1 } else { 0 };
        self.last = (volts, um);
        let anew = self.times >= STILL && self.told.is_none_or(|told| (volts - told).abs() > SAME_V);
        if anew {
            self.told = Some(volts);
        }
        anew
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_voltage_that_stands_still_is_said_once() {
        let mut readings = Readings::default();
        let mut said =
            |volts: &mut dyn Iterator<Item = f64>| volts.filter(|&v| readings.still_anew(v, 0.1 * v)).count();
        assert_eq!(said(&mut (0..50).map(f64::from)), 0, "it moves");
        assert_eq!(said(&mut std::iter::repeat_n(50.0, 20)), 1);
        assert_eq!(said(&mut std::iter::repeat_n(50.01, 20)), 0, "the same still");
        assert_eq!(said(&mut std::iter::repeat_n(70.0, 20)), 1);
    }
}
