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
    /// Time in seconds, s.
    Second,
    /// Time in milliseconds, ms.
    Millisecond,
    /// Time in microseconds, µs.
    Microsecond,
    /// Time in nanoseconds, ns.
    Nanosecond,
    /// Voltage in kilovolts, kV.
    Kilovolt,
    /// Voltage in volts, V.
    Volt,
    /// Voltage in millivolts, mV.
    Millivolt,
    /// Voltage in microvolts, µV.
    Microvolt,
    /// Displacement in metres, m.
    Metre,
    /// Displacement in millimetres, mm.
    Millimetre,
    /// Displacement in micrometres, µm.
    Micrometre,
    /// Displacement in nanometres, nm.
    Nanometre,
    /// Displacement in picometres, pm.
    Picometre,
    /// Time in hours, h.
    Hour,
    /// Time in minutes, min.
    Minute,
    /// Displacement in ångströms, 0.1 nm.
    Angstrom,
}

impl Unit {
    /// Every unit, from large to small within a quantity; behind them those that are no power of a thousand away, of
    /// which none is another's neighbour.
    const ALL: [Self; 16] = [
        Self::Second,
        Self::Millisecond,
        Self::Microsecond,
        Self::Nanosecond,
        Self::Kilovolt,
        Self::Volt,
        Self::Millivolt,
        Self::Microvolt,
        Self::Metre,
        Self::Millimetre,
        Self::Micrometre,
        Self::Nanometre,
        Self::Picometre,
        Self::Hour,
        Self::Angstrom,
        Self::Minute,
    ];

    /// What this unit measures.
    #[must_use]
    pub fn quantity(self) -> Quantity {
        match self {
            Self::Second | Self::Millisecond | Self::Microsecond | Self::Nanosecond | Self::Minute | Self::Hour => {
                Quantity::Time
            }
            Self::Kilovolt | Self::Volt | Self::Millivolt | Self::Microvolt => Quantity::Voltage,
            Self::Metre | Self::Millimetre | Self::Micrometre | Self::Nanometre | Self::Picometre | Self::Angstrom => {
                Quantity::Displacement
            }
        }
    }

    /// `value` of this unit in s, V or µm. Small units divide, so that 0.5 ms is the double nearest to 0.0005 s.
    #[must_use]
    pub fn to_base(self, value: f64) -> f64 {
        match self {
            Self::Second | Self::Volt | Self::Micrometre => value,
            Self::Millisecond | Self::Millivolt | Self::Nanometre => value / 1e3,
            Self::Microsecond | Self::Microvolt | Self::Picometre => value / 1e6,
            Self::Nanosecond => value / 1e9,
            Self::Kilovolt | Self::Millimetre => value * 1e3,
            Self::Metre => value * 1e6,
            Self::Minute => value * 60.0,
            Self::Hour => value * 3600.0,
            Self::Angstrom => value / 1e4,
        }
    }

    /// Whether a column that is called by this alone holds it: a `min` or an `h` may be something else.
    #[must_use]
    pub fn names_a_column(self) -> bool {
        !matches!(self, Self::Minute | Self::Hour | Self::Angstrom)
    }

    /// The next smaller unit of the same quantity.
    #[must_use]
    pub fn smaller(self) -> Option<Self> {
        let at = Self::ALL.iter().position(|&unit| unit == self)?;
        let next = *Self::ALL.get(at + 1)?;
        (next.quantity() == self.quantity()).then_some(next)
    }

    /// The next larger unit of the same quantity.
    #[must_use]
    pub fn larger(self) -> Option<Self> {
        Self::ALL.into_iter().find(|unit| unit.smaller() == Some(self))
    }

    fn symbol(self) -> &'static str {
        match self {
            Self::Second => "s",
            Self::Millisecond => "ms",
            Self::Microsecond => "us",
            Self::Nanosecond => "ns",
            Self::Kilovolt => "kV",
            Self::Volt => "V",
            Self::Millivolt => "mV",
            Self::Microvolt => "uV",
            Self::Metre => "m",
            Self::Millimetre => "mm",
            Self::Micrometre => "um",
            Self::Nanometre => "nm",
            Self::Picometre => "pm",
            Self::Hour => "h",
            Self::Minute => "min",
            Self::Angstrom => "angstrom",
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
#[error("unknown unit {0:?}: use s, ms, us, ns, min, h, kV, V, mV, uV, m, mm, um, nm, pm or angstrom")]
pub struct UnknownUnit(pub String);

impl FromStr for Unit {
    type Err = UnknownUnit;

    /// Symbols in any case but for a leading `M`, which would be mega (`MV` is not `mV`); µ as U+00B5, U+03BC or `u`;
    /// names in the languages that instruments speak.
    fn from_str(text: &str) -> Result<Self, UnknownUnit> {
        let ascii = text.trim().replace(['\u{b5}', '\u{3bc}'], "u");
        let spelling = if ascii.len() <= 2 && ascii.starts_with('M') { ascii } else { ascii.to_lowercase() };
        let spelled = |(_, spellings): &&(Self, &[&str])| spellings.contains(&spelling.as_str());
        match SPELLINGS.iter().find(spelled) {
            Some((unit, _)) => Ok(*unit),
            None => Err(UnknownUnit(text.trim().to_owned())),
        }
    }
}

/// How each unit is written: its symbol, and names in English, German, French, Spanish, Italian, Chinese and Japanese.
const SPELLINGS: [(Unit, &[&str]); 16] = [
    (
        Unit::Second,
        &[
            "s", "sec", "secs", "second", "seconds", "sekunde", "sekunden", "sek", "seconde", "secondes", "segundo",
            "segundos", "secondo", "secondi", "秒",
        ],
    ),
    (
        Unit::Millisecond,
        &[
            "ms",
            "msec",
            "millisecond",
            "milliseconds",
            "millisekunden",
            "millisecondes",
            "milisegundos",
            "millisecondi",
            "毫秒",
            "ミリ秒",
        ],
    ),
    (
        Unit::Microsecond,
        &[
            "us",
            "usec",
            "microsecond",
            "microseconds",
            "mikrosekunden",
            "microsecondes",
            "microsegundos",
            "微秒",
            "マイクロ秒",
        ],
    ),
    (Unit::Nanosecond, &["ns", "nsec", "nanosecond", "nanoseconds", "纳秒", "ナノ秒"]),
    (Unit::Kilovolt, &["kv", "kilovolt", "kilovolts", "千伏"]),
    (Unit::Volt, &["v", "volt", "volts", "voltios", "伏", "伏特", "ボルト"]),
    (Unit::Millivolt, &["mv", "millivolt", "millivolts", "毫伏", "ミリボルト"]),
    (Unit::Microvolt, &["uv", "microvolt", "microvolts", "mikrovolt", "微伏"]),
    (Unit::Metre, &["m", "metre", "metres", "meter", "meters", "metro", "metros", "米"]),
    (Unit::Millimetre, &["mm", "millimetre", "millimetres", "millimeter", "millimeters", "毫米", "ミリメートル"]),
    (
        Unit::Micrometre,
        &[
            "um",
            "micron",
            "microns",
            "micrometre",
            "micrometres",
            "micrometer",
            "micrometers",
            "mikrometer",
            "micromètres",
            "micrómetros",
            "micrometri",
            "micra",
            "微米",
            "マイクロメートル",
            "㎛",
        ],
    ),
    (Unit::Nanometre, &["nm", "nanometre", "nanometres", "nanometer", "nanometers", "纳米", "ナノメートル"]),
    (
        Unit::Hour,
        &[
            "h", "hr", "hrs", "hour", "hours", "stunde", "stunden", "heure", "heures", "hora", "horas", "ora", "ore",
            "小时", "時間",
        ],
    ),
    (Unit::Minute, &["min", "mins", "minute", "minutes", "minuten", "minuto", "minutos", "minuti", "分钟", "分"]),
    (Unit::Angstrom, &["angstrom", "angstroms", "\u{e5}", "a\u{30a}", "\u{e5}ngstr\u{f6}m", "angstr\u{f6}m", "埃"]),
    (Unit::Picometre, &["pm", "picometre", "picometres", "picometer", "picometers", "皮米"]),
];

/// A unit without the brackets around it.
#[must_use]
pub fn without_brackets(unit: &str) -> &str {
    const BRACKETS: [char; 10] = ['(', ')', '[', ']', '{', '}', '（', '）', '【', '】'];
    unit.trim().trim_matches(BRACKETS).trim()
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
        for text in ["Mikrometer", "微米", "micromètres"] {
            assert_eq!(text.parse(), Ok(Unit::Micrometre), "{text}");
        }
        for text in ["\u{c5}", "\u{212b}", "A\u{30a}", "Angstrom", "\u{c5}ngstr\u{f6}m"] {
            assert_eq!(text.parse(), Ok(Unit::Angstrom), "{text}");
        }
        for mega in ["A", "MV", "Mm", "M", "Ms", "furlong", "", "mA"] {
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
        assert_eq!(Unit::Picometre.to_base(12e6), 12.0);
        assert_eq!(Unit::Microvolt.to_base(1.5e6), 1.5);
        assert_eq!(Unit::Nanosecond.to_base(500_000.0), 0.0005);
        assert_eq!([Unit::Minute.to_base(0.5), Unit::Hour.to_base(0.5)], [30.0, 1800.0]);
        assert_eq!(Unit::Angstrom.to_base(120_000.0), 12.0);
    }

    #[test]
    fn neighbours_stay_within_the_quantity() {
        assert_eq!(Unit::Micrometre.smaller(), Some(Unit::Nanometre));
        assert_eq!(Unit::Micrometre.larger(), Some(Unit::Millimetre));
        assert_eq!(Unit::Nanosecond.smaller(), None);
        assert_eq!(Unit::Kilovolt.larger(), None);
        for unit in [Unit::Hour, Unit::Minute, Unit::Angstrom] {
            assert_eq!((unit.smaller(), unit.larger()), (None, None), "{unit}");
        }
        assert_eq!((Unit::Second.larger(), Unit::Picometre.smaller()), (None, None));
    }
}
