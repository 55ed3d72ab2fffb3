//! Time stamps: ISO 8601 and what spreadsheets, LabVIEW and MATLAB write, with any number of decimals.
//!
//! Only differences count. Where day and month cannot be told apart, the order follows the separator: `.` and `-` day
//! first, `/` month first.

/// An instant: nanoseconds since 1970 if there is a date, else since midnight or since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stamp {
    pub nanoseconds: i128,
    /// Whether a date is part of it; without one it begins anew at midnight.
    pub dated: bool,
}

const SECOND: i128 = 1_000_000_000;
/// A day, ns.
pub(crate) const DAY: i128 = 86_400 * SECOND;

impl Stamp {
    /// The stamp in a field: a time of day, or a date and a time of day.
    pub fn parse(field: &str) -> Option<Self> {
        // MATLAB's durations.
        if let Some(seconds) = field.strip_suffix(" sec") {
            return Some(Self { nanoseconds: decimal(seconds.trim())?, dated: false });
        }
        // Cheap for what is no stamp: it needs a colon and begins with a digit.
        if !field.contains(':') || !field.starts_with(|c: char| c.is_ascii_digit()) {
            return None;
        }
        let (date, time) = match field.split_once(' ').or_else(|| field.split_once('T')) {
            Some((date, time)) if time.contains(':') => (Some(date), time),
            _ => (None, field),
        };
        let days = match date {
            Some(date) => Some(days(date)?),
            None => None,
        };
        let nanoseconds = time_of_day(time.trim())? + i128::from(days.unwrap_or(0)) * DAY;
        Some(Self { nanoseconds, dated: days.is_some() })
    }
}

/// Nanoseconds of `10:00:00.005`, `1:02:03,5 PM`, `02:03.5`, with `Z` or an offset from UTC.
fn time_of_day(text: &str) -> Option<i128> {
    let lower = text.to_ascii_lowercase();
    let (clock, afternoon) = match (lower.strip_suffix("pm"), lower.strip_suffix("am")) {
        (Some(clock), _) => (clock.trim_end(), Some(true)),
        (_, Some(clock)) => (clock.trim_end(), Some(false)),
        _ => (lower.as_str(), None),
    };
    let clock = clock.strip_suffix('z').unwrap_or(clock);
    let (clock, offset) = match clock.rfind(['+', '-']) {
        Some(at) => (&clock[..at], offset(&clock[at..])?),
        None => (clock, 0),
    };
    let parts: Vec<&str> = clock.split(':').collect();
    let fraction = |text: &str| text.contains(['.', ',']);
    let (hours, minutes, seconds) = match parts[..] {
        [hours, minutes, seconds] => (hours, minutes, seconds),
        [minutes, seconds] if fraction(seconds) => ("0", minutes, seconds),
        [hours, minutes] => (hours, minutes, "0"),
        _ => return None,
    };
    let (minutes, seconds) = (whole(minutes)?, decimal(seconds)?);
    let hours = match (whole(hours)?, afternoon) {
        (hours, None) => hours,
        (12, Some(afternoon)) => i128::from(afternoon) * 12,
        (hours, Some(afternoon)) => hours + i128::from(afternoon) * 12,
    };
    if minutes >= 60 || seconds >= 61 * SECOND {
        return None;
    }
    Some((hours * 60 + minutes) * 60 * SECOND + seconds - offset)
}

/// Nanoseconds of `+02:00`, `-0530` or `+02`.
fn offset(text: &str) -> Option<i128> {
    let sign = if text.starts_with('-') { -1 } else { 1 };
    let digits: String = text[1..].chars().filter(|c| *c != ':').collect();
    whole(&digits)?;
    let (hours, minutes) = match digits.len() {
        2 => (whole(&digits)?, 0),
        4 => (whole(&digits[..2])?, whole(&digits[2..])?),
        _ => return None,
    };
    Some(sign * (hours * 60 + minutes) * 60 * SECOND)
}

/// A whole number of at most nine digits.
fn whole(text: &str) -> Option<i128> {
    let digits = (1..=9).contains(&text.len()) && text.bytes().all(|b| b.is_ascii_digit());
    if digits { text.parse().ok() } else { None }
}

/// Nanoseconds of `7`, `7.25` or `7,25` seconds; what is finer is cut off.
fn decimal(text: &str) -> Option<i128> {
    let (seconds, fraction) = text.split_once(['.', ',']).unwrap_or((text, ""));
    if !fraction.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let nine: String = fraction.chars().chain(std::iter::repeat('0')).take(9).collect();
    Some(whole(seconds)? * SECOND + whole(&nine)?)
}

/// Days since 1970 of a date in one of the usual orders.
fn days(date: &str) -> Option<i64> {
    let date = date.trim().trim_end_matches(',');
    if date.len() == 8 && whole(date).is_some() {
        return civil(&date[..4], &date[4..6], &date[6..]);
    }
    let separators: &[char] = &['-', '/', '.', '年', '月', '日'];
    let parts: Vec<&str> = date.split(separators).filter(|part| !part.is_empty()).collect();
    let [first, second, third] = parts[..] else { return None };
    match (first.len(), third.len()) {
        (4, _) => civil(first, second, third),
        (_, 4) if date.contains('/') && whole(first)? <= 12 => civil(third, first, second),
        (_, 4) => civil(third, second, first),
        _ => None,
    }
}

/// Days since 1970 in the Gregorian calendar; years are counted from March (H. Hinnant, "chrono-compatible low-level
/// date algorithms", `days_from_civil`).
fn civil(year: &str, month: &str, day: &str) -> Option<i64> {
    const NAMES: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];
    let named = month.to_lowercase();
    let month = match NAMES.iter().position(|name| named.starts_with(name)) {
        Some(index) => index as i64 + 1,
        None => i64::try_from(whole(month)?).ok()?,
    };
    let (year, day) = (i64::try_from(whole(year)?).ok()?, i64::try_from(whole(day)?).ok()?);
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) || !(1..=9999).contains(&year) {
        return None;
    }
    let year = year - i64::from(month <= 2);
    let era = year.div_euclid(400);
    let year_of_era = year.rem_euclid(400);
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    Some(era * 146_097 + year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year - 719_468)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nanoseconds(text: &str) -> i128 {
        Stamp::parse(text).unwrap_or_else(|| panic!("{text} is a stamp")).nanoseconds
    }

    #[test]
    fn one_instant_in_many_spellings() {
        let expected = nanoseconds("2026-11-01T10:00:00.005");
        assert_eq!(expected, 1_793_527_200_005_000_000);
        for text in [
            "2026-11-01 10:00:00.005",
            "2026-11-01T10:00:00,005Z",
            "2026-11-01T12:00:00.005+02:00",
            "2026-11-01T04:30:00.005-0530",
            "20261101T10:00:00.005",
            "01.11.2026 10:00:00,005",
            "11/01/2026 10:00:00.005 AM",
            "2026/11/01 10:00:00.005000",
            "01-Nov-2026 10:00:00.005",
            "2026年11月01日 10:00:00.005",
        ] {
            assert_eq!(nanoseconds(text), expected, "{text}");
        }
        assert_eq!(nanoseconds("11/01/2026 1:00:00 PM") - nanoseconds("11/01/2026 11:00:00 AM"), 7200 * SECOND);
        assert_eq!(nanoseconds("31/12/2026 23:59:59.5") + SECOND / 2, nanoseconds("2027-01-01 00:00:00"));
    }

    #[test]
    fn times_without_a_date() {
        assert_eq!(Stamp::parse("10:00:00.25"), Some(Stamp { nanoseconds: 36_000_250_000_000, dated: false }));
        assert_eq!(nanoseconds("02:03.5"), 123_500_000_000);
        assert_eq!(nanoseconds("0.0005 sec"), 500_000);
        assert_eq!(nanoseconds("100:00:00"), 360_000 * SECOND);
    }

    #[test]
    fn other_texts_are_none() {
        for text in
            ["", "10", "1:2:3:4", "a:b", "CH1: 3", "10:61:00", "2026-13-01 10:00:00", "1:", ":1", "10:00:xx", "é:1"]
        {
            assert_eq!(Stamp::parse(text), None, "{text}");
        }
        assert_eq!(Stamp::parse("1:2é+1"), None);
    }
}
