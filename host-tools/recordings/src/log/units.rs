//! Units a log may be written in, and their conversion to s, V and µm.

use std::fmt;
use std::str::FromStr;

/// What one column of a log holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time, read into seconds.
    Time,
    /// Amplifier voltage, read into volts.
    Voltage,
    /// Measured displacement, read into micrometres.
    Displacement,
}

impl Quantity {
    /// The unit a log is held in: s, V or µm.
    #[must_use]
    pub fn base(self) -> Unit {
        match self {
            Self::Time => Unit::Second,
            Self::Voltage => Unit::Volt,
            Self::Displacement => Unit::Micrometre,
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Time => "time",
            Self::Voltage => "voltage",
            Self::Displacement => "displacement",
        })
    }
}

/// A unit of time, voltage or displacement. Displayed as its ASCII symbol (`um` for µm).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// s
    Second,
    /// ms
    Millisecond,
    /// µs
    Microsecond,
    /// kV
    Kilovolt,
    /// V
    Volt,
    /// mV
    Millivolt,
    /// m
    Metre,
    /// mm
    Millimetre,
    /// µm
    Micrometre,
    /// nm
    Nanometre,
}

impl Unit {
    /// Every unit, from large to small within a quantity.
    const ALL: [Self; 10] = [
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Kilovolt,
        Self::Volt,
        Self::Millivolt,
        Self::Metre,
        Self::Millimetre,
        Self::Micrometre,
        Self::Nanometre,
    ];

    /// What this unit measures.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Second | Self::Millisecond | Self::Microsecond => Quantity::Time,
            Self::Kilovolt | Self::Volt | Self::Millivolt => Quantity::Voltage,
            Self::Metre | Self::Millimetre | Self::Micrometre | Self::Nanometre => Quantity::Displacement,
        }
    }

    /// `value` of this unit in s, V or µm. Small units divide, so that 0.5 ms is the double nearest to 0.0005 s.
    #[must_use]
    pub fn to_base(self, value: f64) -> f64 {
        match self {
            Self::Second | Self::Volt | Self::Micrometre => value,
            Self::Millisecond | Self::Millivolt | Self::Nanometre => value / 1e3,
            Self::Microsecond => value / 1e6,
            Self::Kilovolt | Self::Millimetre => value * 1e3,
            Self::Metre => value * 1e6,
        }
    }

    /// The next smaller unit of the same quantity.
    pub(super) fn smaller(self) -> Option<Self> {
        let at = Self::ALL.iter().position(|&unit| unit == self)?;
        let next = *Self::ALL.get(at + 1)?;
        (next.quantity() == self.quantity()).then_some(next)
    }

    /// The next larger unit of the same quantity.
    pub(super) fn larger(self) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.smaller() == Some(self))
    }

    fn symbol(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Kilovolt => "kV",
            Self::Volt => "V",
            Self::Millivolt => "mV",
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Nanometre => "nm",
        }
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.symbol())
    }
}

/// The text names none of the units a log may be written in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("unknown unit {0:?}: use s, ms, us, kV, V, mV, m, mm, um or nm")]
pub struct UnknownUnit(pub String);

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// Symbols in any case but for a leading `M`, which would be mega (`MV` is not `mV`); µ as U+00B5, U+03BC or `u`;
    /// English names in both spellings.
    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        let ascii = text.trim().replace(['\u{b5}', '\u{3bc}'], "u");
        let spelling = if ascii.len() <= 2 && ascii.starts_with('M') { ascii } else { ascii.to_lowercase() };
        match spelling.as_str() {
            "s" | "sec" | "second" | "seconds" => Ok(Self::Second),
            "ms" | "msec" | "millisecond" | "milliseconds" => Ok(Self::Millisecond),
            "us" | "usec" | "microsecond" | "microseconds" => Ok(Self::Microsecond),
            "kv" | "kilovolt" | "kilovolts" => Ok(Self::Kilovolt),
            "v" | "volt" | "volts" => Ok(Self::Volt),
            "mv" | "millivolt" | "millivolts" => Ok(Self::Millivolt),
            "m" | "metre" | "metres" | "meter" | "meters" => Ok(Self::Metre),
            "mm" | "millimetre" | "millimetres" | "millimeter" | "millimeters" => Ok(Self::Millimetre),
            "um" | "micron" | "microns" | "micrometre" | "micrometres" | "micrometer" | "micrometers" => {
                Ok(Self::Micrometre)
            }
            "nm" | "nanometre" | "nanometres" | "nanometer" | "nanometers" => Ok(Self::Nanometre),
            _ => Err(UnknownUnit(text.trim().to_owned())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_symbol_reads_back() {
        for unit in Unit::ALL {
            assert_eq!(unit.to_string().parse(), Ok(unit));
        }
    }

    #[test]
    fn both_micro_signs_and_capitals() {
        for text in ["um", "UM", "\u{b5}m", "\u{3bc}m", "micron", " um "] {
            assert_eq!(text.parse(), Ok(Unit::Micrometre), "{text}");
        }
        assert_eq!("\u{b5}s".parse(), Ok(Unit::Microsecond));
        assert_eq!("Volts".parse(), Ok(Unit::Volt));
        for mega in ["MV", "Mm", "M", "Ms", "furlong", "", "mA"] {
            assert!(mega.parse::<Unit>().is_err(), "{mega}");
        }
    }

    #[test]
    fn converts_to_seconds_volts_and_micrometres() {
        assert_eq!(Unit::Millisecond.to_base(0.5), 0.0005);
        assert_eq!(Unit::Microsecond.to_base(500.0), 0.0005);
        assert_eq!(Unit::Kilovolt.to_base(0.15), 150.0);
        assert_eq!(Unit::Millivolt.to_base(-1500.0), -1.5);
        assert_eq!(Unit::Metre.to_base(12e-6), 12.0);
        assert_eq!(Unit::Millimetre.to_base(0.012), 12.0);
        assert_eq!(Unit::Nanometre.to_base(12_000.0), 12.0);
    }

    #[test]
    fn neighbours_stay_within_the_quantity() {
        assert_eq!(Unit::Micrometre.smaller(), Some(Unit::Nanometre));
        assert_eq!(Unit::Micrometre.larger(), Some(Unit::Millimetre));
        assert_eq!(Unit::Microsecond.smaller(), None);
        assert_eq!(Unit::Kilovolt.larger(), None);
    }
}
