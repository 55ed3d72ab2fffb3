//! The sample time that a preamble states: `SAMPLE_TIME = 0.005`, `Sample Interval,5.00E-03`, `Delta_X`, `Sampling
//! rate: 200 Hz`.

use crate::fault::Place;
use crate::preamble::Entry;
use crate::unit::{Quantity, Unit};

/// What instruments call the time from sample to sample.
const PERIODS: [&str; 37] = [
    "sample time",
    "sampletime",
    "tinterval",
    "hresolution",
    "sample interval",
    "sample period",
    "sampling interval",
    "sampling period",
    "time step",
    "timestep",
    "time interval",
    "time increment",
    "delta x",
    "delta t",
    "dt",
    "tinc",
    "xinc",
    "xincr",
    "xincrement",
    "x increment",
    "horizontal interval",
    "increment",
    "wf increment",
    "abtastzeit",
    "abtastintervall",
    "abtastperiode",
    "periode d échantillonnage",
    "période d échantillonnage",
    "pas de temps",
    "période de muestreo",
    "periodo de muestreo",
    "intervalo de muestreo",
    "periodo di campionamento",
    "采样间隔",
    "采样周期",
    "サンプリング間隔",
    "サンプリング周期",
];

/// What instruments call the samples a second.
const RATES: [&str; 19] = [
    "sample rate",
    "samplerate",
    "sampling rate",
    "sample frequency",
    "sampling frequency",
    "samples per second",
    "samples s",
    "data rate",
    "acquisition rate",
    "fs",
    "abtastrate",
    "abtastfrequenz",
    "fréquence d échantillonnage",
    "frequence d echantillonnage",
    "frecuencia de muestreo",
    "frequenza di campionamento",
    "采样率",
    "采样频率",
    "サンプリング周波数",
];

/// What two sample times of one file may differ by, and be one.
const ALIKE: f64 = 1e-3;

/// A sample time that a file states in words.
#[derive(Debug, Clone, PartialEq)]
pub struct SampleTime {
    /// Time from sample to sample, s.
    pub seconds: f64,
    /// Where the file says so.
    pub place: Place,
    /// What the file calls it.
    pub name: String,
}

/// The sample time among the entries, by the first that states one; the first line of the text is line 1. None where
/// two contradict each other. A line whose number may have a thousands separator, as in `10,000 Hz`, states none.
pub(crate) fn find(entries: &[Entry]) -> Option<SampleTime> {
    let unclear: Vec<usize> = entries.iter().filter(|entry| is_unclear(entry)).map(|entry| entry.line).collect();
    // Cells cut `12,5` at its decimal comma; the whole line has it.
    let cut = |entry: &Entry| {
        let number = |entry: &Entry| numeric(entry.values.first().map_or("", |value| value)).0.to_owned() + ",";
        let same = entries.iter().filter(|other| (other.line, &other.key) == (entry.line, &entry.key));
        same.map(number).any(|other| other != number(entry) && other.starts_with(&number(entry)))
    };
    let stated = entries.iter().filter(|entry| !unclear.contains(&entry.line) && !cut(entry)).filter_map(|entry| {
        let value = entry.values.first()?;
        let unit = entry.unit.as_deref().or_else(|| entry.values.get(1).map(String::as_str));
        let seconds = seconds(&entry.key, value, unit)?;
        Some(SampleTime { seconds, place: Place::Line(entry.line + 1), name: entry.written.clone() })
    });
    let stated: Vec<SampleTime> = stated.collect();
    let first = stated.first()?;
    let alike = |other: &SampleTime| (other.seconds / first.seconds - 1.0).abs() < ALIKE;
    stated.iter().all(alike).then(|| first.clone())
}

/// The sample time that `key` states by `value`, s: a number with a unit behind it, else in `unit`, else in s or Hz.
pub(crate) fn seconds(key: &str, value: &str, unit: Option<&str>) -> Option<f64> {
    let (number, behind) = number(value)?;
    let unit = if behind.is_empty() { unit.unwrap_or("") } else { behind };
    let seconds = if PERIODS.contains(&key) {
        match unit.parse::<Unit>() {
            Ok(unit) if unit.quantity() == Quantity::Time => unit.to_base(number),
            _ if is_none(unit) => number,
            _ => return None,
        }
    } else if RATES.contains(&key) {
        1.0 / (number * hertz(unit)?)
    } else {
        return None;
    };
    (seconds.is_finite() && seconds > 0.0).then_some(seconds)
}

/// Whether an entry states a sample time or rate by a number that may be one or a thousand times as much.
fn is_unclear(entry: &Entry) -> bool {
    let has_key = PERIODS.contains(&&*entry.key) || RATES.contains(&&*entry.key);
    let first = entry.values.first().map_or("", |value| numeric(value).0);
    // Where a comma separates the cells, it parts the number, too.
    let parted = entry.values.get(1).is_some_and(|next| {
        let rest = numeric(next).0;
        rest != first && !first.contains(',') && may_be_thousands(&format!("{first},{rest}"))
    });
    has_key && (parted || may_be_thousands(first))
}

/// Whether commas, each with exactly three digits behind it, may separate thousands: not in `0,005`.
fn may_be_thousands(number: &str) -> bool {
    let digits = |text: &str| text.bytes().all(|b| b.is_ascii_digit());
    let Some((whole, rest)) = number.trim_start_matches(['+', '-']).split_once(',') else { return false };
    rest.split(',').all(|group| group.len() == 3 && digits(group))
        && digits(whole)
        && !whole.is_empty()
        && !whole.starts_with('0')
}

/// A number and what stands behind it.
fn number(text: &str) -> Option<(f64, &str)> {
    let (number, behind) = numeric(text);
    Some((number.replace(',', ".").parse().ok()?, behind))
}

/// The text of a number and what stands behind it.
fn numeric(text: &str) -> (&str, &str) {
    let text = text.trim().trim_matches('"');
    let is_part = |(at, c): &(usize, char)| {
        let exponent = |c: char| c.eq_ignore_ascii_case(&'e');
        let after_exponent = text[..*at].ends_with(exponent);
        c.is_ascii_digit() || ".,".contains(*c) || ("+-".contains(*c) && (*at == 0 || after_exponent)) || {
            let rest = text[at + c.len_utf8()..].trim_start_matches(['+', '-']);
            exponent(*c) && rest.starts_with(|c: char| c.is_ascii_digit())
        }
    };
    let end = text.char_indices().find(|part| !is_part(part)).map_or(text.len(), |(at, _)| at);
    (text[..end].trim_end_matches(','), text[end..].trim())
}

/// Hz of one of the units of a rate, 1 where none is stated.
fn hertz(unit: &str) -> Option<f64> {
    if unit.trim() == "mHz" {
        return Some(1e-3);
    }
    match unit.to_lowercase().replace(' ', "").as_str() {
        "hz" | "s/s" | "sa/s" | "sps" | "1/s" | "samples/s" | "samples/sec" | "samples/second" => Some(1.0),
        "khz" | "ks/s" | "ksps" | "ksa/s" => Some(1e3),
        "mhz" | "ms/s" | "msps" | "msa/s" => Some(1e6),
        "ghz" | "gs/s" | "gsps" | "gsa/s" => Some(1e9),
        _ if is_none(unit) => Some(1.0),
        _ => None,
    }
}

/// Whether what stands in a unit's place is nothing, or the next number.
fn is_none(unit: &str) -> bool {
    !unit.chars().any(char::is_alphabetic) || number(unit).is_some_and(|(_, behind)| behind.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preamble::entries;

    #[test]
    fn every_spelling_states_five_milliseconds() {
        for text in [
            "# SAMPLE_TIME = 5e-3",
            "Sample Interval,5.00E-03,5.00E-03",
            "Sample interval:\t5 ms",
            "Delta_X\t0.005\t0.005",
            "Abtastintervall [ms];5",
            "Abtastrate;200",
            "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,0.000000e+00,5.000000e-03",
            "CH1V,t0 =-0.05, tInc = 5e-03,",
            "\"Sampling Rate\",\"0.2 kHz\"",
            "% fs: 200",
            "Sampling period (us): 5000",
            "Sample Rate,200,Hz",
            "Intervalo de muestreo;0,005;s",
            "采样率:200Hz",
        ] {
            let lines: Vec<String> = text.lines().map(str::to_owned).collect();
            let found = find(&entries(&lines)).unwrap_or_else(|| panic!("{text}"));
            assert!((found.seconds - 0.005).abs() < 1e-15, "{text}: {}", found.seconds);
            assert_eq!(found.place, Place::Line(1));
        }
    }

    #[test]
    fn a_comma_before_three_digits_is_not_guessed_at() {
        for text in [
            "# Sampling rate: 10,000 Hz",
            "\"Sample Rate\",\"1,000\"",
            "Sample Rate,1,000",
            "Sample Rate;1,000;Hz",
            "fs = 2,500",
            "Sampling rate: 1,000,000 Hz",
        ] {
            assert_eq!(find(&entries(&[text.to_owned()])), None, "{text}");
        }
        for (text, seconds) in [("Abtastrate: 0,125 Hz", 8.0), ("Abtastrate: 12,50 Hz", 0.08), ("fs,200,200", 0.005)] {
            assert_eq!(find(&entries(&[text.to_owned()])).map(|found| found.seconds), Some(seconds), "{text}");
        }
    }

    #[test]
    fn other_entries_state_none() {
        for text in [
            "Record Length,2000",
            "Sample Interval,",
            "Sample rate: fast",
            "SAMPLE_TIME = 0",
            "Sampling time: 60 s",
            "Time resolution: 1e-6 s",
            "Sample Interval,0.005\nSample Rate,1000",
            "Sample rate = -1",
            "ts",
        ] {
            let lines: Vec<String> = text.lines().map(str::to_owned).collect();
            assert_eq!(find(&entries(&lines)), None, "{text}");
        }
        assert_eq!(hertz("mHz"), Some(1e-3));
        assert_eq!(hertz("MHz"), Some(1e6));
    }
}
