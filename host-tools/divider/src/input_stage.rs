//! A divider before one of the board's inputs, and what it is for, in words.

use crate::{CODES_A_STEP, Divider, DividerError, FULL_SCALE, Sampling, Series, series};
use serde::Serialize;

/// Tolerances that resistors are sold with, each with the drift that is usual for it, of the value a kelvin: thick
/// film, thin film.
const TOLERANCES: [(f64, f64); 2] = [(0.01, 100e-6), (0.001, 25e-6)];
/// How far off a supply is looked at, of its value.
const SUPPLY: f64 = 0.01;
/// A divider that uses less of the converter's range is remarked on.
const HALF: f64 = 0.5;
/// Change of temperature for which the drift is said, K.
const WARMER_K: f64 = 10.0;

/// What a pin reads.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Source {
    /// The amplifier's monitor: volts of the amplifier.
    Monitor,
    /// A displacement sensor's output: µm.
    Sensor,
}

impl Source {
    /// Its name in a sentence.
    pub fn name(self) -> &'static str {
        match self {
            Self::Monitor => "monitor",
            Self::Sensor => "sensor",
        }
    }

    /// What its volts stand for, and the unit of that.
    pub fn stands_for(self) -> (&'static str, &'static str) {
        match self {
            Self::Monitor => ("the amplifier", "V"),
            Self::Sensor => ("the displacement", "µm"),
        }
    }
}

/// A divider, what it reads, and between which voltages.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct InputStage {
    /// The resistors before the follower.
    pub divider: Divider,
    /// The signal that they divide.
    pub source: Source,
    /// Lowest and highest voltage of that, V.
    pub ends_v: (f64, f64),
    /// What these two stand for, V or µm, where it was said.
    pub stands_for: Option<(f64, f64)>,
}

/// What a tolerance and the drift that is usual for it cost.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Cost {
    /// Tolerance, of the value.
    pub tolerance: f64,
    /// Largest error of the source's voltage, V, before two points are measured.
    pub off_v: f64,
    /// Drift, of the value a kelvin.
    pub drift_per_k: f64,
    /// Largest error of the source's voltage by that, V.
    pub off_by_drift_v: f64,
    /// For so many kelvin.
    pub drift_over_k: f64,
    /// Lowest and highest voltage at the pin, V.
    pub pin_v: (f64, f64),
}

impl InputStage {
    /// The divider of standard resistors for these voltages of a source, V.
    ///
    /// # Errors
    /// There is none.
    pub fn choose(
        source: Source,
        ends_v: (f64, f64),
        stands_for: Option<(f64, f64)>,
        series: Series,
    ) -> Result<Self, DividerError> {
        Ok(Self { divider: Divider::choose(ends_v, series)?, source, ends_v, stands_for })
    }

    /// What a volt of the source stands for, V or µm.
    pub fn a_volt(&self) -> Option<f64> {
        let (at_low, at_high) = self.stands_for?;
        Some((at_high - at_low) / (self.ends_v.1 - self.ends_v.0))
    }

    /// What a voltage of the source stands for, V or µm.
    fn at(&self, volts: f64) -> Option<f64> {
        let ((at_low, _), a_volt) = (self.stands_for?, self.a_volt()?);
        Some(at_low + a_volt * (volts - self.ends_v.0))
    }

    /// What code 0 and the largest one stand for, V or µm.
    pub fn span(&self) -> Option<(f64, f64)> {
        let (zero, full) = self.divider.span();
        Some((self.at(zero)?, self.at(full)?))
    }

    /// What resistors of each usual tolerance cost.
    pub fn costs(&self) -> [Cost; 2] {
        TOLERANCES.map(|(tolerance, drift_per_k)| Cost {
            tolerance,
            off_v: self.divider.off(self.ends_v, tolerance),
            drift_per_k,
            off_by_drift_v: self.divider.off(self.ends_v, drift_per_k * WARMER_K),
            drift_over_k: WARMER_K,
            pin_v: self.divider.pin_within(self.ends_v, tolerance),
        })
    }

    /// What a hundredth more of supply costs, V of the source, where nothing corrects it.
    pub fn off_by_a_hundredth_of_supply_v(&self) -> f64 {
        Divider::off_by_supply(self.ends_v, SUPPLY)
    }

    /// What to buy, what the pin then sees, and what it costs, as lines.
    pub fn lines(&self) -> Vec<String> {
        let (divider, (low, high), source) = (&self.divider, self.ends_v, self.source.name());
        let mut lines = vec![
            "Buy, and wire as in the book's chapter \"Bringing up a board\":".to_owned(),
            series::part("R1", Some(divider.r1), &format!("from the {source} to the node")),
            series::part("R2", divider.r2, "from the board's 3.3 V to the node"),
            series::part("R3", divider.r3, "from the node to GND"),
            "  a rail-to-rail follower on the board's 3.3 V behind the node, then 100 Ω, and 4.7 nF from the pin to GND"
                .to_owned(),
            format!("R1 takes {:.1} mW at most.", 1e3 * divider.watts_in_r1(low).max(divider.watts_in_r1(high))),
            String::new(),
            format!("{low} … {high} V of the {source} are {:.3} … {:.3} V at the pin.", divider.pin(low), divider.pin(high)),
        ];
        let (zero, full) = divider.span();
        lines.push(format!("Codes 0 … {FULL_SCALE} are {zero:.3} … {full:.3} V of the {source}."));
        lines.extend(self.resolution());
        lines.push(String::new());
        lines.extend(self.costs().map(|cost| self.cost(&cost)));
        lines.push(format!(
            "A supply that is {} % off the one of the calibration: {:.1} mV at most, whatever the resistors; the firmware \
             corrects it.",
            100.0 * SUPPLY,
            1e3 * self.off_by_a_hundredth_of_supply_v()
        ));
        if self.source == Source::Monitor {
            lines.push(self.open());
        }
        let used = divider.used(self.ends_v);
        if used < HALF {
            lines.push(format!(
                "Only {:.0} % of the converter's range is used, and the resolution is that much worse: amplify the {source}'s output first.",
                100.0 * used
            ));
        }
        let sampling = Sampling::of(divider);
        lines.push(format!(
            "The node has {}. The firmware samples for {:.2} µs, sixteen times in a row: behind the follower, 100 Ω and 4.7 nF settle with \
             {:.2} µs, to {:.4} % of the difference to the other channel; without the follower it would be {:.1} µs, so it is needed.",
            series::ohms(divider.impedance()),
            1e6 * sampling.time_s,
            1e6 * sampling.filter_s,
            100.0 * sampling.missing,
            1e6 * sampling.bare_s,
        ));
        lines
    }

    fn resolution(&self) -> Vec<String> {
        let a_code = self.divider.volts_a_code();
        let said = |unit: &str, scale: f64| {
            let step = scale * a_code * CODES_A_STEP;
            format!("{:.4} {unit} a code, {step:.3} {unit} a step of one conversion", scale * a_code)
        };
        let (of, unit) = self.source.stands_for();
        let mut lines = vec![format!("Resolution: {} of the {}.", said("mV", 1e3), self.source.name())];
        lines.extend(self.a_volt().map(|a_volt| format!("            {} of {of}.", said(unit, a_volt.abs()))));
        lines
    }

    fn cost(&self, cost: &Cost) -> String {
        let (of, unit) = self.source.stands_for();
        let also = |volts: f64| {
            self.a_volt().map_or(String::new(), |scale| format!(" ({:.3} {unit} of {of})", volts * scale.abs()))
        };
        let (least, most) = cost.pin_v;
        format!(
            "Resistors of {} %: off by {:.1} mV of the {} at most{}, the pin at {least:.3} … {most:.3} V. Two measured points \
             take that away, and their drift is left: with {:.0} ppm/K, {:.2} mV at most{} for {} K.",
            100.0 * cost.tolerance,
            1e3 * cost.off_v,
            self.source.name(),
            also(cost.off_v),
            1e6 * cost.drift_per_k,
            1e3 * cost.off_by_drift_v,
            also(cost.off_by_drift_v),
            cost.drift_over_k
        )
    }

    /// What the firmware makes of a wire that is off.
    fn open(&self) -> String {
        let (low, high) = self.ends_v;
        match self.divider.open() {
            Some(volts) if (low..=high).contains(&volts) => format!(
                "With the monitor's wire off, it reads as {volts:.3} V{}. Where the DAC does not drive the amplifier and the table's range \
                 holds that voltage, no flag tells it from an actuator at rest, unless the voltage leaps there farther than the amplifier \
                 can (amplifier_slew of board.toml).",
                self.at(volts).map_or(String::new(), |volts| format!(", which is {volts:.2} V of the amplifier"))
            ),
            Some(volts) => format!(
                "With the monitor's wire off, it reads as {volts:.3} V, which is beyond its range: a fault within a second."
            ),
            None => "With the monitor's wire off, the follower's input floats, and may read as any voltage.".to_owned(),
        }
    }
}
