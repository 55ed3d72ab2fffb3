//! `board.toml`: what a board's converters and its wires stand for, one file for every verb.
//!
//! ```toml
//! adc_span = [-35.0, 135.0]     # V at the amplifier at ADC code 0 and at full scale
//! adc_full_scale = 65520        # largest ADC code, oversampling included
//! amplifier_slew = 20000.0      # V/s, fastest that the amplifier can: its peak current over the stack's capacitance
//! dac_full_scale = 4095         # largest DAC code
//! drive_span = [-30.0, 130.0]   # V at the amplifier at DAC code 0 and at full scale
//! drive_range = [0.0, 100.0]    # V that it may be driven to
//! drive_rest = 0.0              # V when nothing is wanted
//! drive_slew = 500.0            # V/s, fastest change
//! sensor_span = [-5.0, 25.0]    # µm at the sensor's code 0 and at full scale
//! setpoint_span = [-1.0, 16.0]  # µm that a controller wants by the set-point's code 0 and by its full scale
//! linearise = true              # whether the device follows the set-point of itself after a start
//! board_uid = "0039…"           # the unique number of the board that this was measured on
//! ```
//!
//! What a file does not say is not known; nothing is assumed.

mod error;

use ::calibration::CalibrationOptions;
use ::calibration::drive::{DriveOptions, ordered};
use ::calibration::span::Span;
use estimator_core::Range;
use protocol::{Identity, Uid};
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::path::Path;

pub use error::{AnotherBoard, BoardFileError};

/// No such file is longer.
pub(crate) const MOST_BYTES: u64 = 1 << 20;
/// This part of the ADC's range at either end is taken for saturated by the firmware's watch.
const ADC_MARGIN: f64 = 1.0 / 128.0;

/// What the file says.
#[derive(Clone, Copy, PartialEq, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoardFacts {
    /// Amplifier voltage at ADC code 0 and at full scale, V.
    #[serde(default, deserialize_with = "ends")]
    pub adc_span: Option<(f64, f64)>,
    /// Largest ADC code, oversampling included.
    pub adc_full_scale: Option<u16>,
    /// Fastest that the amplifier can, V/s.
    pub amplifier_slew: Option<f64>,
    /// Largest DAC code.
    pub dac_full_scale: Option<u16>,
    /// Amplifier voltage at DAC code 0 and at full scale, V.
    #[serde(default, deserialize_with = "ends")]
    pub drive_span: Option<(f64, f64)>,
    /// Voltages that the amplifier may be driven to, V.
    #[serde(default, deserialize_with = "ends")]
    pub drive_range: Option<(f64, f64)>,
    /// Voltage when nothing is wanted, V.
    pub drive_rest: Option<f64>,
    /// Fastest change, V/s.
    pub drive_slew: Option<f64>,
    /// Displacement at the sensor's code 0 and at full scale, µm.
    #[serde(default, deserialize_with = "ends")]
    pub sensor_span: Option<(f64, f64)>,
    /// Displacement that a controller wants by the set-point's code 0 and by its full scale, µm.
    #[serde(default, deserialize_with = "ends")]
    pub setpoint_span: Option<(f64, f64)>,
    /// Whether the device follows the set-point of itself after a start.
    pub linearise: Option<bool>,
    /// The unique number of the board that this was measured on.
    pub board_uid: Option<Uid>,
}

/// Two numbers and no more, as a tuple takes the first two of whatever is there: `[-5,0, 25,0]` with decimal commas.
fn ends<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<(f64, f64)>, D::Error> {
    let numbers = Vec::deserialize(deserializer)?;
    <[f64; 2]>::try_from(numbers).map(|[zero, full]| Some((zero, full))).map_err(|numbers| {
        let many = numbers.len();
        D::Error::custom(format_args!(
            "expected two numbers, as [-5.0, 25.0], not {many}: write decimals with a point, not a comma"
        ))
    })
}

/// Every value with what it is.
const WHAT: [(&str, &str); 12] = [
    ("adc_span", "V at the amplifier at ADC code 0 and at full scale"),
    ("adc_full_scale", "largest ADC code, oversampling included"),
    ("amplifier_slew", "V/s, fastest that the amplifier can: its peak current over the stack's capacitance"),
    ("dac_full_scale", "largest DAC code"),
    ("drive_span", "V at the amplifier at DAC code 0 and at full scale"),
    ("drive_range", "V that it may be driven to"),
    ("drive_rest", "V when nothing is wanted"),
    ("drive_slew", "V/s, fastest change"),
    ("sensor_span", "µm at the sensor's code 0 and at full scale"),
    ("setpoint_span", "µm that a controller wants by the set-point's code 0 and by its full scale"),
    ("linearise", "whether the device follows the set-point of itself after a start"),
    ("board_uid", "the unique number of the board that this was measured on"),
];

impl BoardFacts {
    /// The voltages at the amplifier that it may be driven to, V; `None` where nobody has said: the ADC may read more
    /// than the actuator stands.
    pub fn range_v(&self) -> Option<Range> {
        self.drive_range.map(|(zero, full)| ordered(Span { zero, full }))
    }

    /// Reads a file.
    ///
    /// # Errors
    /// It cannot be read, says something else, or what cannot be.
    pub fn read(path: &Path) -> Result<Self, BoardFileError> {
        let text = result_files::read_text(path, MOST_BYTES)
            .map_err(|error| BoardFileError::Unreadable { path: path.to_owned(), error })?;
        Self::parse(path, &text)
    }

    /// Reads a file's text.
    ///
    /// # Errors
    /// It says something else, or what cannot be.
    pub fn parse(path: &Path, text: &str) -> Result<Self, BoardFileError> {
        let facts: Self = toml::from_str(text)
            .map_err(|error| BoardFileError::Wrong { path: path.to_owned(), error: Box::new(error) })?;
        facts.check().map_err(|(field, value, rule)| BoardFileError::Value {
            path: path.to_owned(),
            line: text.lines().position(|line| line.trim_start().starts_with(field)).map(|before| before + 1),
            field,
            value,
            rule,
        })?;
        Ok(facts)
    }

    /// The file's text, every value with what it is.
    pub fn to_toml(&self) -> String {
        let pair = |(zero, full): (f64, f64)| format!("[{zero:?}, {full:?}]");
        let number = |x: f64| format!("{x:?}");
        let values = [
            ("adc_span", self.adc_span.map(pair)),
            ("adc_full_scale", self.adc_full_scale.map(|n| n.to_string())),
            ("amplifier_slew", self.amplifier_slew.map(number)),
            ("dac_full_scale", self.dac_full_scale.map(|n| n.to_string())),
            ("drive_span", self.drive_span.map(pair)),
            ("drive_range", self.drive_range.map(pair)),
            ("drive_rest", self.drive_rest.map(number)),
            ("drive_slew", self.drive_slew.map(number)),
            ("sensor_span", self.sensor_span.map(pair)),
            ("setpoint_span", self.setpoint_span.map(pair)),
            ("linearise", self.linearise.map(|so| so.to_string())),
            ("board_uid", self.board_uid.map(|uid| format!("\"{uid}\""))),
        ];
        let said =
            values.into_iter().filter_map(|(name, value)| Some((format!("{name} = {}", value?), Self::what(name))));
        said.map(|(line, what)| format!("{line:<31}# {what}\n")).collect()
    }

    /// What a value of the file is, in words.
    pub fn what(field: &str) -> &'static str {
        WHAT.iter().find(|(name, _)| *name == field).map_or("", |(_, what)| what)
    }

    /// Refuses a file that was measured on another board. One that does not say on which is nobody's in particular.
    ///
    /// # Errors
    /// It says so, and the board is not that one.
    pub fn of_board(&self, identity: &Identity) -> Result<(), AnotherBoard> {
        self.of_board_uid(identity.uid)
    }

    fn of_board_uid(&self, this: Option<Uid>) -> Result<(), AnotherBoard> {
        match self.board_uid {
            Some(of) if this != Some(of) => Err(AnotherBoard { of, this }),
            _ => Ok(()),
        }
    }

    /// What a table's converters are by this, where `stated` says nothing else.
    pub fn calibration(&self, stated: &CalibrationOptions) -> CalibrationOptions {
        let span = |pair: Option<(f64, f64)>| pair.map(|(zero, full)| Span { zero, full });
        // A table without a drive shows the displacement: then the file's drive is not meant.
        let shows = stated.dac_span.is_some();
        let drive = if shows { Self::default() } else { *self };
        CalibrationOptions {
            adc_span: stated.adc_span.or(span(self.adc_span)),
            adc_full_scale: stated.adc_full_scale.or(self.adc_full_scale),
            amplifier_slew: stated.amplifier_slew.or(self.amplifier_slew),
            dac_span: stated.dac_span,
            dac_full_scale: stated.dac_full_scale.or(self.dac_full_scale),
            drive: DriveOptions {
                drive_span: stated.drive.drive_span.or(span(drive.drive_span)),
                drive_slew: stated.drive.drive_slew.or(drive.drive_slew),
                drive_range: stated.drive.drive_range,
                drive_within: span(drive.drive_range),
                drive_rest: stated.drive.drive_rest.or(drive.drive_rest),
                setpoint_span: stated.drive.setpoint_span.or(span(drive.setpoint_span)),
                linearise: stated.drive.linearise.or(drive.linearise),
            },
        }
    }

    /// The first value that cannot be: its name, itself, and what it would have to be.
    fn check(&self) -> Result<(), (&'static str, String, &'static str)> {
        let pair = |(zero, full): (f64, f64)| format!("[{zero}, {full}]");
        let spans = [
            ("adc_span", self.adc_span),
            ("drive_span", self.drive_span),
            ("drive_range", self.drive_range),
            ("sensor_span", self.sensor_span),
            ("setpoint_span", self.setpoint_span),
        ];
        for (field, span) in spans {
            if let Some((zero, full)) = span
                && !(zero.is_finite() && full.is_finite() && zero != full)
            {
                return Err((field, pair((zero, full)), "the two ends must be numbers that differ"));
            }
        }
        let holds = |outer: (f64, f64), inner: (f64, f64)| {
            let (low, high) = (outer.0.min(outer.1), outer.0.max(outer.1));
            [inner.0, inner.1].iter().all(|volts| (low..=high).contains(volts))
        };
        if let Some(range) = self.drive_range {
            let said = pair(range);
            if self.drive_span.is_some_and(|span| !holds(span, range)) {
                return Err(("drive_range", said, "must lie within drive_span, which is all that the DAC can put out"));
            }
            if self.adc_span.is_some_and(|(zero, full)| {
                let margin = ADC_MARGIN * (full - zero);
                !holds((zero + margin, full - margin), range)
            }) {
                return Err((
                    "drive_range",
                    said,
                    "must lie within adc_span and keep 1/128 of it away from either end, where the device takes the ADC for \
                     saturated and stops the drive",
                ));
            }
            if let Some(rest) = self.drive_rest.filter(|rest| !holds(range, (*rest, *rest))) {
                return Err(("drive_rest", rest.to_string(), "must lie within drive_range"));
            }
        }
        for (field, slew) in [("drive_slew", self.drive_slew), ("amplifier_slew", self.amplifier_slew)] {
            if let Some(slew) = slew.filter(|slew| !(slew.is_finite() && *slew > 0.0)) {
                return Err((field, slew.to_string(), "must be a positive number, V/s"));
            }
        }
        if let Some((drive, _)) = self.drive_slew.zip(self.amplifier_slew).filter(|(drive, can)| drive > can) {
            return Err((
                "drive_slew",
                drive.to_string(),
                "must be no more than amplifier_slew, the fastest that the amplifier can",
            ));
        }
        if let Some(rest) = self.drive_rest.filter(|rest| !rest.is_finite()) {
            return Err(("drive_rest", rest.to_string(), "must be a finite number, V"));
        }
        if let Some(scale) = self.adc_full_scale.filter(|scale| *scale < 3) {
            return Err(("adc_full_scale", scale.to_string(), "must be at least 3"));
        }
        let drive = [
            ("drive_span", self.drive_span.map(pair)),
            ("drive_range", self.drive_range.map(pair)),
            ("drive_slew", self.drive_slew.map(|slew| slew.to_string())),
        ];
        let rest = ("drive_rest", self.drive_rest.map(|rest| rest.to_string()));
        if drive.iter().any(|(_, value)| value.is_none())
            && let Some((field, value)) =
                drive.into_iter().chain([rest]).find_map(|(field, value)| Some((field, value?)))
        {
            let rule = "drive_span, drive_range and drive_slew belong together: a DAC drives the amplifier by all of them, or by \
                        none and shows the displacement";
            return Err((field, value, rule));
        }
        if let Some(span) = self.setpoint_span.filter(|_| self.drive_span.is_none()) {
            let rule = "needs drive_span, drive_range and drive_slew: a set-point is followed by a DAC that drives the amplifier";
            return Err(("setpoint_span", pair(span), rule));
        }
        if self.linearise == Some(true) && self.setpoint_span.is_none() {
            return Err(("linearise", "true".to_owned(), "needs setpoint_span, which says what a set-point wants"));
        }
        match self.dac_full_scale {
            Some(0) => Err(("dac_full_scale", "0".to_owned(), "must be at least 1")),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests;
