//! A searched number: where it may lie, and on which scale.

/// How a gene's fraction becomes its value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Scale {
    /// Linear between the ends, Eq. (4.5).
    Linear,
    /// Eq. (4.5) on the logarithm; the interval is positive.
    Logarithmic,
}

/// This close to an end of its range, as a fraction of it, a coordinate is at the end.
const AT_END: f64 = 0.005;

/// One searched number.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Gene {
    /// Name on the command line and in the report.
    pub name: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Lower end of its range.
    pub min: f64,
    /// Upper end of its range.
    pub max: f64,
    /// Linear or logarithmic.
    pub scale: Scale,
}

impl Gene {
    /// A coordinate on a linear scale.
    pub const fn linear(name: &'static str, meaning: &'static str, unit: &'static str, min: f64, max: f64) -> Self {
        Self { name, meaning, unit, min, max, scale: Scale::Linear }
    }

    /// A coordinate on a logarithmic scale; its interval is positive.
    pub const fn logarithmic(
        name: &'static str,
        meaning: &'static str,
        unit: &'static str,
        min: f64,
        max: f64,
    ) -> Self {
        Self { name, meaning, unit, min, max, scale: Scale::Logarithmic }
    }

    /// The value at a fraction of the interval.
    pub fn value(&self, fraction: f64) -> f64 {
        match self.scale {
            Scale::Linear => self.min + (self.max - self.min) * fraction,
            Scale::Logarithmic => self.min * libm::pow(self.max / self.min, fraction),
        }
    }

    /// Where in the interval a value lies, limited to 0 … 1.
    pub fn fraction(&self, value: f64) -> f64 {
        let fraction = match self.scale {
            Scale::Linear => (value - self.min) / (self.max - self.min),
            Scale::Logarithmic => libm::log(value / self.min) / libm::log(self.max / self.min),
        };
        fraction.clamp(0.0, 1.0)
    }

    /// Whether a value is so close to an end of the interval that the optimum may lie beyond, unless that end is a
    /// limit of the model itself: a sigmoid without curvature is the pure exponential that β → ±∞ gives, a short lag is
    /// none, no displacement comes before its voltage, a high slew limit is none, and a rest has wiped out all memory,
    /// or nothing of it.
    pub fn undetermined(&self, value: f64) -> bool {
        let fraction = self.fraction(value);
        let model_limit = match self.name {
            "curvature" | "lag" | "late" | "delay" => fraction < 0.5,
            "slew" => fraction > 0.5,
            "memory" => true,
            _ => false,
        };
        !(AT_END..=1.0 - AT_END).contains(&fraction) && !model_limit
    }

    /// The interval shrunk by a factor around a value, moved to stay within this one.
    pub fn around(&self, value: f64, factor: f64) -> Self {
        let low = (self.fraction(value) - factor / 2.0).clamp(0.0, 1.0 - factor);
        Self { min: self.value(low), max: self.value(low + factor), ..*self }
    }
}
