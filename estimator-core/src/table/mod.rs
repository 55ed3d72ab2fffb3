//! The parameter table: everything that the estimator must know, in one plain value with three faces.
//!
//! It is written as `table.toml` for people, as a Rust `const` for the firmware image, and as a binary record for a
//! flash page ([`crate::record`]). All numbers are `f32`, so the three are equal to the last bit and the reference runs
//! on the very parameters that the target has. A [`Table`] is only data; an [`Admitted`] one has passed every check,
//! and nothing else makes an [`Estimator`](crate::Estimator).

mod cycles;
mod digest;
mod drive;
mod error;
mod interface;
mod leap;
mod rate;

pub use cycles::{ALLOWED_PERCENT, Cycles, MARGIN_PERCENT};
pub use digest::Digest;
pub use error::TableError;
pub use interface::{Interface, Misfit};
pub use leap::LeastLeap;
pub use rate::BoundToTick;

use crate::calibration::{AdcCalibration, DacCalibration, DriveCalibration};
use crate::extremum::between_codes;
use crate::interval::IntervalParameters;
use crate::math::Real;
use crate::model::{
    Discretisation, Engine, GeneralisedPrandtlIshlinskii, Model, Parameters, Process, Remanence, Scheme,
};
use crate::range::Range;
use crate::rule::{self, Rule};
use serde::{Deserialize, Serialize};

/// Where a table comes from.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Start of a SHA-256 over each training log's own digest, its first second used, and its number of samples.
    pub logs: Digest,
    /// Seed of the identification's random numbers: with the same logs and options it gives this table again.
    pub seed: u32,
    /// Version of the tool that made the table.
    pub tool_version: [u16; 3],
    /// Mean absolute simulation error on the training logs, each without its own offset, µm.
    pub train_mae_um: f32,
    /// Mean absolute simulation error on what was held out, offset included, µm, of the model before it was learnt from
    /// that, too, where it was; `None` where nothing was held out.
    pub validation_mae_um: Option<f32>,
    /// Largest absolute simulation error there, µm.
    pub validation_max_um: Option<f32>,
}

/// A parameter table as data. [`admit`](Self::admit) it to use it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Tick, µs; 500 is 2 kHz.
    pub sample_period_us: u32,
    /// How the Voigt family's differential equation becomes a recursion; of every other model forward Euler, and
    /// without effect.
    pub scheme: Scheme,
    /// Retreat from the running extreme that counts as a reversal, V; to the model it stands midway between the two
    /// numbers of codes that it lies between ([`retreat_v`](Self::retreat_v)), as a deadband among its parameters does.
    pub deadband_v: f32,
    /// Amplifier voltage that the model calls 0, V.
    pub voltage_zero_v: f32,
    /// Sensor reading that the model calls 0, µm. The estimate is relative to it.
    pub displacement_zero_um: f32,
    /// Voltages the model was identified on, relative to its zero, V. Beyond, the estimator holds the nearest
    /// and says so.
    pub voltage_range_v: Range,
    /// The estimate never leaves these, µm relative to the model's zero.
    pub displacement_limits_um: Range,
    /// Published parameters, and with them which model it is.
    pub parameters: Parameters,
    /// What an actuator that has long rested at the lowest of the voltages stands above where the model by itself
    /// begins there, and at the highest, µm. Where nothing is known of a start the model begins so far off, between the
    /// two in proportion, or as near to that as its memory can be. 0 of a model that does not
    /// [remember](crate::Recursion::REMEMBERS).
    #[serde(default)]
    pub remanence_um: [f32; 2],
    /// From the ADC's codes to the amplifier's voltage, V.
    pub adc: AdcCalibration,
    /// Fastest change of the amplifier's voltage, V/s; `None` where nobody said it. A device holds what
    /// leaps beyond it.
    pub amplifier_slew_v_per_s: Option<f32>,
    /// From the displacement, µm, to the DAC's codes; not used where there is a drive.
    pub dac: DacCalibration,
    /// Where the DAC drives the amplifier: volts to codes, and limits. It then shows no displacement.
    pub drive: Option<DriveCalibration>,
    /// How far the estimate may be off; `None` where nobody knows.
    pub interval: Option<IntervalParameters>,
    /// Logs, seed, tool and errors of the identification that made it; no estimate depends on it.
    pub provenance: Provenance,
}

/// A table that has passed every check of [`Table::admit`].
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Admitted(Table);

impl core::ops::Deref for Admitted {
    type Target = Table;

    fn deref(&self) -> &Table {
        &self.0
    }
}

/// Displacement limits beyond this (µm) are refused: a metre is no piezo.
const LARGEST_DISPLACEMENT_UM: f32 = 1e6;
/// The DAC's code of 0 lies no farther away than this, codes: an eighth of a code is then left in an `f32`.
const LARGEST_OFFSET_CODE: f32 = 1_048_576.0;
const OFFSET_RULE: Rule = "the DAC's offset_code must lie within a million codes, so that an f32 tells two codes apart";
/// Voltages beyond this (V) are refused: no amplifier for piezos reaches it.
const LARGEST_VOLTAGE_V: f32 = 1e5;
/// A range of voltages narrower than this (V) is refused: no converter sees it, and what is divided by it may
/// be no number.
const LEAST_VOLTAGES_V: f32 = 1e-6;
impl Admitted {
    /// How far voltages in step with the model's resonance could make the displacement swing, µm, where that is beyond
    /// the limits: the estimate is then held at them, and says so ([`Status::CLAMPED`](crate::Status::CLAMPED)). Every
    /// other table stays within its limits by itself.
    pub fn rings(&self) -> Option<Range> {
        let Parameters::GeneralisedPrandtlIshlinskii(parameters) = &self.parameters else { return None };
        let reach =
            GeneralisedPrandtlIshlinskii::build(parameters, self.sample_period()).reach(self.voltage_range_v).ok()?;
        (reach.intersection(self.displacement_limits_um) != reach).then_some(reach)
    }
}

impl Table {
    /// Checks everything, admissibility in the target's `f32` included.
    ///
    /// # Errors
    /// What is wrong, each cause by itself.
    pub fn admit(self) -> Result<Admitted, TableError> {
        self.check_finite()?;
        self.check_ranges()?;
        self.engine::<f32>().bound(self.voltage_range_v, self.displacement_limits_um)?;
        let admitted = Admitted(self);
        match &self.drive {
            Some(drive) => admitted.check_drive(drive).map(|()| admitted),
            None => Ok(admitted),
        }
    }

    /// The model that the parameters are of.
    pub const fn model(&self) -> Model {
        self.parameters.model()
    }

    /// The model in the number type `T`.
    pub fn engine<T: Real>(&self) -> Engine<T> {
        self.parameters
            .between_codes(self.adc.gain_v_per_code)
            .build(&Discretisation {
                sample_period: self.sample_period(),
                scheme: self.scheme,
                deadband: T::of(self.retreat_v()),
            })
            .resting(Remanence::new(self.voltage_range_v, self.remanence_um))
    }

    /// Retreat that counts as a reversal, V: `deadband_v` [between two numbers of codes](between_codes) of the ADC.
    pub fn retreat_v(&self) -> f32 {
        between_codes(self.deadband_v, self.adc.gain_v_per_code)
    }

    /// `sample_period_us` in s, exact before it is rounded once to `T`.
    pub fn sample_period<T: Real>(&self) -> T {
        // Exact: 1 s in µs fits the 24 bits of an f32.
        T::of(self.sample_period_us as f32) / T::of(1e6)
    }

    fn check_finite(&self) -> Result<(), TableError> {
        let numbers = [
            ("deadband_v", self.deadband_v),
            ("voltage_zero_v", self.voltage_zero_v),
            ("displacement_zero_um", self.displacement_zero_um),
            ("voltage_range_v", self.voltage_range_v.min),
            ("voltage_range_v", self.voltage_range_v.max),
            ("displacement_limits_um", self.displacement_limits_um.min),
            ("displacement_limits_um", self.displacement_limits_um.max),
            ("remanence_um", self.remanence_um[0]),
            ("remanence_um", self.remanence_um[1]),
            ("adc.gain_v_per_code", self.adc.gain_v_per_code),
            ("adc.offset_v", self.adc.offset_v),
            ("amplifier_slew_v_per_s", self.amplifier_slew_v_per_s.unwrap_or(0.0)),
            ("dac.gain_codes_per_um", self.dac.gain_codes_per_um),
            ("dac.offset_code", self.dac.offset_code),
            ("train_mae_um", self.provenance.train_mae_um),
            ("validation_mae_um", self.provenance.validation_mae_um.unwrap_or(0.0)),
            ("validation_max_um", self.provenance.validation_max_um.unwrap_or(0.0)),
        ];
        match numbers.into_iter().find(|(_, x)| !x.is_finite()) {
            Some((field, _)) => Err(TableError::NonFinite { field }),
            None => Ok(()),
        }
    }

    /// Whether two neighbouring codes of the ADC are two voltages in `f32`, wherever the voltage is counted from.
    fn adc_resolves(&self) -> bool {
        let AdcCalibration { gain_v_per_code, offset_v, full_scale, .. } = self.adc;
        let Range { min, max } = self.voltage_range_v;
        let largest = offset_v.abs() + gain_v_per_code * f32::from(full_scale) + self.voltage_zero_v.abs();
        gain_v_per_code >= f32::EPSILON * largest.max(min.abs()).max(max.abs())
    }

    fn check_ranges(&self) -> Result<(), TableError> {
        let ordered = |range: Range| range.min < range.max;
        let limits = self.displacement_limits_um;
        let voltages = self.voltage_range_v;
        rule::check([
            (
                "only a model of the Voigt family has a scheme other than forward-euler",
                self.model().is_voigt() || self.scheme == Scheme::ForwardEuler,
            ),
            ("only a model that remembers how its voltage has gone has a remanence_um other than 0", {
                self.model().remembers() || self.remanence_um == [0.0; 2]
            }),
            ("sample_period_us must lie between 1 and 1000000", (1..=1_000_000).contains(&self.sample_period_us)),
            ("voltage_range_v must be ordered", ordered(voltages)),
            ("voltage_range_v must lie within 100 kV", {
                voltages.min.abs().max(voltages.max.abs()) <= LARGEST_VOLTAGE_V
            }),
            ("voltage_range_v must be a microvolt wide at least", voltages.span() >= LEAST_VOLTAGES_V),
            ("deadband_v must lie between 0 and the voltage range", {
                (0.0..self.voltage_range_v.span()).contains(&self.deadband_v)
            }),
            ("displacement_limits_um must be ordered", ordered(limits)),
            ("displacement_limits_um must lie within a metre", {
                limits.min.abs().max(limits.max.abs()) <= LARGEST_DISPLACEMENT_UM
            }),
            ("adc.gain_v_per_code must be positive", self.adc.gain_v_per_code > 0.0),
            (
                "adc.gain_v_per_code must be so large that an f32 tells the voltages of two codes apart",
                self.adc_resolves(),
            ),
            ("adc.full_scale must be at least 3", self.adc.full_scale >= 3),
            (
                "amplifier_slew_v_per_s must be positive; where nobody knows it, remove the line from table.toml",
                self.amplifier_slew_v_per_s.is_none_or(|slew| slew > 0.0),
            ),
            ("dac.gain_codes_per_um must not be 0", self.dac.gain_codes_per_um != 0.0),
            ("dac.gain_codes_per_um must make displacement_limits_um a code wide at least", {
                self.dac.gain_codes_per_um.abs() * limits.span() >= 1.0
            }),
            (OFFSET_RULE, self.dac.offset_code.abs() <= LARGEST_OFFSET_CODE),
            ("dac.full_scale must be at least 1", self.dac.full_scale >= 1),
        ])
        .and_then(|()| self.parameters.check())
        .and_then(|()| self.interval.as_ref().map_or(Ok(()), IntervalParameters::check))
        .map_err(|rule| TableError::OutOfRange { rule })
    }
}
