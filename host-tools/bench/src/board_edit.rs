//! A measured calibration into `board.toml`: its values are replaced where they stand, everything else in the file
//! stays as it was written.

use crate::board_file::{BoardFacts, BoardFileError, MOST_BYTES};
use protocol::Uid;
use result_files::FileError;
use std::fmt::{self, Display, Formatter};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use toml_edit::{Array, DocumentMut, Item, Value};

/// Decimal places of a value: 10 µV, and 10 pm.
const PLACES: f64 = 1e5;

/// What was measured of a board; what is `None` stays as it is.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Measured {
    /// Amplifier voltage at ADC code 0 and at full scale, V.
    pub adc_span: Option<(f64, f64)>,
    /// Amplifier voltage at DAC code 0 and at full scale, V.
    pub drive_span: Option<(f64, f64)>,
    /// Displacement at the sensor's code 0 and at full scale, µm.
    pub sensor_span: Option<(f64, f64)>,
    /// Largest ADC code, as the board says.
    pub adc_full_scale: Option<u16>,
    /// Largest DAC code, as the board says.
    pub dac_full_scale: Option<u16>,
    /// Whose calibration it is.
    pub board_uid: Option<Uid>,
}

impl Display for Measured {
    /// The spans, as the file says them.
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let said = [("adc_span", self.adc_span), ("drive_span", self.drive_span), ("sensor_span", self.sensor_span)];
        let said = said.into_iter().filter_map(|(name, span)| Some((name, span?)));
        for (index, (name, (zero, full))) in said.enumerate() {
            let comma = if index > 0 { ", " } else { "" };
            write!(f, "{comma}{name} = [{zero:.3}, {full:.3}]")?;
        }
        Ok(())
    }
}

/// A file with another calibration, not yet written.
#[derive(Debug)]
pub struct Edited {
    path: PathBuf,
    text: String,
    /// What it said before.
    pub before: BoardFacts,
    /// What it says now.
    pub after: BoardFacts,
}

impl Edited {
    /// The file with what was measured; where there is none, one with nothing else.
    ///
    /// # Errors
    /// It cannot be read, is no board.toml, or would say what cannot be.
    pub fn of(path: &Path, measured: &Measured) -> Result<Self, BoardFileError> {
        let text = match result_files::read_text(path, MOST_BYTES) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            read => read.map_err(|error| BoardFileError::Unreadable { path: path.to_owned(), error })?,
        };
        let before = BoardFacts::parse(path, &text)?;
        // It was just read as TOML, by the same grammar.
        let mut document: DocumentMut =
            text.parse().map_err(|error| BoardFileError::Edit { path: path.to_owned(), error })?;
        let pair = |(zero, full): (f64, f64)| {
            let rounded = [zero, full].map(|x| (x * PLACES).round() / PLACES);
            Value::from(Array::from_iter(rounded))
        };
        let said = [
            ("board_uid", measured.board_uid.map(|uid| uid.to_string().into())),
            ("adc_span", measured.adc_span.map(pair)),
            ("adc_full_scale", measured.adc_full_scale.map(|n| i64::from(n).into())),
            ("dac_full_scale", measured.dac_full_scale.map(|n| i64::from(n).into())),
            ("drive_span", measured.drive_span.map(pair)),
            ("sensor_span", measured.sensor_span.map(pair)),
        ];
        for (field, value) in said {
            if let Some(value) = value {
                put(&mut document, field, value);
            }
        }
        let text = document.to_string();
        let after = BoardFacts::parse(path, &text)?;
        Ok(Self { path: path.to_owned(), text, before, after })
    }

    /// Writes it, whole or not at all.
    ///
    /// # Errors
    /// It cannot be written, and is as it was.
    pub fn write(&self) -> Result<(), FileError> {
        result_files::write(&self.path, &self.text)
    }

    /// The lines whose values are others than before, with the former value.
    pub fn changes(&self) -> Vec<String> {
        let (before, after) = (self.before.to_toml(), self.after.to_toml());
        let value = |line: &str| line.split('#').next().unwrap_or(line).trim_end().to_owned();
        let former = |line: &str| {
            let field = line.split(" = ").next().unwrap_or(line).to_owned() + " = ";
            before.lines().find(|former| former.starts_with(&field)).map(&value)
        };
        let changed = after.lines().filter(|line| !before.lines().any(|former| former == *line));
        changed
            .map(|line| match former(line) {
                Some(former) => format!("{}   (it was: {former})", value(line)),
                None => value(line),
            })
            .collect()
    }

    /// The spans that a file which named no board had before, and that were not measured now: of which board they
    /// are, nothing says.
    pub fn unmeasured(&self, measured: &Measured) -> Vec<&'static str> {
        if self.before.board_uid.is_some() || measured.board_uid.is_none() {
            return Vec::new();
        }
        let stood = [
            ("adc_span", self.before.adc_span, measured.adc_span),
            ("drive_span", self.before.drive_span, measured.drive_span),
            ("sensor_span", self.before.sensor_span, measured.sensor_span),
        ];
        stood.into_iter().filter(|(_, before, now)| before.is_some() && now.is_none()).map(|(name, ..)| name).collect()
    }
}

/// Puts a value in a former one's place, with the former's comment.
fn put(document: &mut DocumentMut, field: &str, mut value: Value) {
    let item = document.entry(field).or_insert(Item::None);
    match item.as_value() {
        Some(former) => *value.decor_mut() = former.decor().clone(),
        None => value.decor_mut().set_suffix(format!("     # {}", BoardFacts::what(field))),
    }
    *item = Item::Value(value);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::FACTS;

    const UID: Uid = Uid([0xab; 12]);

    fn edited(before: Option<&str>, measured: &Measured) -> Result<(String, BoardFacts), String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("board.toml");
        if let Some(text) = before {
            std::fs::write(&path, text).unwrap();
        }
        let edited = Edited::of(&path, measured).map_err(|error| error.to_string())?;
        assert_eq!(std::fs::read_to_string(&path).ok().as_deref(), before, "nothing is written before it is asked for");
        edited.write().unwrap();
        assert_eq!(BoardFacts::read(&path).unwrap(), edited.after);
        Ok((std::fs::read_to_string(&path).unwrap(), edited.after))
    }

    #[test]
    fn what_was_measured_takes_the_place_of_what_stood_there_and_the_rest_stays() {
        let before = "# the rig in room 4\nadc_span = [-35, 135]   # by Anna, 3 May\n\n\n  sensor_span=[ -5.0,25.0 ]\nadc_full_scale = 65520\n";
        let measured = Measured { adc_span: Some((-34.123456789, 136.0)), board_uid: Some(UID), ..Measured::default() };
        let (text, facts) = edited(Some(before), &measured).unwrap();
        assert_eq!((facts.adc_span, facts.sensor_span), (Some((-34.12346, 136.0)), Some((-5.0, 25.0))));
        assert_eq!(facts.board_uid, Some(UID));
        for kept in
            ["# the rig in room 4\n", "# by Anna, 3 May\n\n\n  sensor_span=[ -5.0,25.0 ]\nadc_full_scale = 65520\n"]
        {
            assert!(text.contains(kept), "{kept:?} is not kept in\n{text}");
        }
        assert!(
            text.contains("board_uid = \"abababababababababababab\"") && text.contains("# the unique number"),
            "{text}"
        );
    }

    #[test]
    fn a_file_that_is_not_there_is_begun_and_one_that_would_not_fit_is_not_written() {
        let measured = Measured { sensor_span: Some((-1.0, 31.0)), ..Measured::default() };
        let (text, facts) = edited(None, &measured).unwrap();
        assert_eq!(facts, BoardFacts { sensor_span: Some((-1.0, 31.0)), ..BoardFacts::default() }, "{text}");
        let narrow = Measured { adc_span: Some((-10.0, 90.0)), ..Measured::default() };
        let refused = edited(Some(&FACTS.to_toml()), &narrow).unwrap_err();
        assert!(refused.contains("drive_range = [0, 100]: must lie within adc_span"), "{refused}");
        assert!(edited(Some("adc_span = "), &narrow).is_err());
    }
}
