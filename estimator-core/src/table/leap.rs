//! How far a monitor's voltage goes at least from one tick to another, to be more than the amplifier and noise can.
//!
//! ```text
//! least leap after n ticks = n · (slew · tick, rounded up to a code) + largest code / 96
//! ```

use super::Table;

/// This part of the ADC's range is left to noise: 43 codes of 12 bits. Two codes with a noise of 5 of them rms differ
/// by 7 rms, and by six times that once in days.
const NOISE: u16 = 96;

/// What a device holds as more than the amplifier can, codes of the ADC.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LeastLeap {
    /// Farthest that the amplifier goes in a tick.
    slew: u32,
    /// What is left to noise.
    noise: u32,
}

impl LeastLeap {
    /// Farthest that a code may be from that of so many ticks before.
    #[inline]
    #[must_use]
    pub fn after(self, ticks: u32) -> u32 {
        self.slew.saturating_mul(ticks).saturating_add(self.noise)
    }
}

impl Table {
    /// What a device holds; `None` where nobody said how fast the amplifier is.
    #[must_use]
    pub fn least_leap(&self) -> Option<LeastLeap> {
        let codes = self.amplifier_slew_v_per_s? * self.sample_period::<f32>() / self.adc.gain_v_per_code;
        let full_scale = self.adc.full_scale;
        // Whatever is beyond the range is as good as all of it.
        let slew = (codes as u32).saturating_add(1).min(full_scale.into());
        Some(LeastLeap { slew, noise: (full_scale / NOISE).into() })
    }

    /// The same from a tick to the next, V: no smaller leap is found.
    #[must_use]
    pub fn least_leap_v(&self) -> Option<f32> {
        self.least_leap().map(|leap| leap.after(1) as f32 * self.adc.gain_v_per_code)
    }

    /// Whether a device finds a monitor's wire that comes off. From an open input that reads the middle of the
    /// table's voltages none is farther than half of their range: where the least leap is more, nothing within the
    /// range is ever held.
    #[must_use]
    pub fn finds_open_wire(&self) -> bool {
        self.least_leap_v().is_some_and(|volts| volts <= 0.5 * self.voltage_range_v.span())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leap_is_what_the_amplifier_goes_in_the_time_and_a_hundredth_of_the_range() {
        let table = *Table::parse(include_bytes!("../../../tests/data/table/table.bin")).unwrap();
        assert_eq!((table.least_leap(), table.least_leap_v(), table.finds_open_wire()), (None, None, false));
        let codes = |codes: f32| {
            let slew = codes * table.adc.gain_v_per_code / table.sample_period::<f32>();
            Table { amplifier_slew_v_per_s: Some(slew), ..table }
        };
        let noise = u32::from(table.adc.full_scale / NOISE);
        let leap = codes(9.5).least_leap().unwrap();
        assert_eq!((leap.after(0), leap.after(1), leap.after(5)), (noise, noise + 10, noise + 50));
        let volts = codes(9.5).least_leap_v().unwrap();
        assert!((volts / table.adc.gain_v_per_code - (noise + 10) as f32).abs() < 1e-2, "{volts} V");
        // As far as half of the table's voltages, and a code farther.
        let half = (0.5 * table.voltage_range_v.span() / table.adc.gain_v_per_code).floor() - noise as f32;
        assert!(codes(half - 1.5).finds_open_wire() && !codes(half + 0.5).finds_open_wire());
        // A voltage that moves by less than a code a tick is one, too: noise is what is left to it.
        assert!(codes(1e-3).admit().is_ok_and(|slow| slow.finds_open_wire()));
        assert_eq!(codes(1e9).least_leap().unwrap().after(1), u32::from(table.adc.full_scale) + noise);
    }
}
