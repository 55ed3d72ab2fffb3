//! The parameter table: everything that the estimator must know, in one plain value with three faces.
//!
//! It is written as `table.toml` for people, as a Rust `const` for the firmware image, and as a binary record for a
//! flash page ([`crate::record`]). All numbers are `f32`, so the three are equal to the last bit and the reference runs
//! on the very parameters that the target has. A [`Table`] is only data; an [`Admitted`] one has passed every check, and
//! nothing else makes an [`Estimator`](crate::Estimator).

mod board;
mod digest;
mod error;

pub use board::{Board, Misfit};
pub use digest::Digest;
pub use error::TableError;

use crate::admissible;
use crate::calibration::{AdcCalibration, DacCalibration, DriveCalibration, DriveLimits};
use crate::inverse::{Ground, Inverse, NoInverse};
use crate::lookup::{self, Lookup};
use crate::math::Real;
use crate::model::{Engine, Model, Parameters, Scheme, Voigt, VoigtParameters};
use crate::range::Range;
use serde::{Deserialize, Serialize};

/// How the per-tick functions are evaluated.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub enum Form {
    /// As the equations say: for the Voigt family one exponential and one power a tick.
    Direct,
    /// Linear interpolation between [`crate::lookup::KNOTS`] knots.
    Tabulated {
        /// Bound of the displacement error that interpolation adds between two reversals, µm; computed by the host tool.
        error_bound_um: f32,
    },
}

/// Where a table comes from.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Provenance {
    /// Start of a SHA-256 over each training log's own digest, its first second used, and its number of samples.
    pub logs: Digest,
    /// Seed of the identification.
    pub seed: u32,
    /// Version of the tool that made the table.
    pub tool_version: [u16; 3],
    /// Mean absolute simulation error on the training logs, µm.
    pub train_mae_um: f32,
    /// The same on what was held out, µm; `None` where nothing was.
    pub validation_mae_um: Option<f32>,
    /// Largest absolute simulation error on what was held out, µm.
    pub validation_max_um: Option<f32>,
}

/// A parameter table as data. [`admit`](Self::admit) it to use it.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// Which model it is; [`parameters`](Self::parameters) are its.
    pub model: Model,
    /// Tick, µs; 500 is 2 kHz.
    pub sample_period_us: u32,
    /// Discretisation.
    pub scheme: Scheme,
    /// Retreat from the running extreme that counts as a reversal, V.
    pub deadband_v: f32,
    /// Amplifier voltage that the model calls 0, V.
    pub voltage_zero_v: f32,
    /// Sensor reading that the model calls 0, µm. The estimate is relative to it.
    pub displacement_zero_um: f32,
    /// Direct or tabulated.
    pub form: Form,
    /// Voltages the model was identified on, relative to its zero, V. Beyond, the estimator holds the nearest and says so.
    pub voltage_range_v: Range,
    /// The estimate never leaves these, µm relative to the model's zero.
    pub displacement_limits_um: Range,
    /// Published parameters.
    pub parameters: Parameters,
    /// Codes to volts.
    pub adc: AdcCalibration,
    /// Displacement to codes.
    pub dac: DacCalibration,
    /// Where the DAC drives the amplifier: volts to codes, and limits. It then shows no displacement.
    pub drive: Option<DriveCalibration>,
    /// Where it comes from.
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
/// Voltages beyond this (V) are refused: no amplifier for piezos reaches it.
const LARGEST_VOLTAGE_V: f32 = 1e5;
/// Exponents beyond this are refused.
const LARGEST_EXPONENT: f32 = 8.0;

impl Admitted {
    /// The inverse of the model, at rest, within limits that may be other than the table's own.
    pub fn inverse<T: Real>(&self, limits: &DriveLimits) -> Result<Inverse<T>, NoInverse> {
        let zero = self.voltage_zero_v;
        let Range { min, max } = self.voltage_range_v;
        if let Some(rule) = limits.fault(Range { min: min + zero, max: max + zero }) {
            return Err(NoInverse::Limits(rule));
        }
        let ground = Ground {
            voltage_zero: T::of(zero),
            deadband: T::of(self.deadband_v),
            sample_period: self.sample_period(),
            displacement_span: T::of(self.displacement_limits_um.span()),
        };
        Inverse::build(self.engine(), &ground, limits)
    }

    fn check_drive(&self, drive: &DriveCalibration) -> Result<(), TableError> {
        let DriveCalibration { gain_codes_per_v, offset_code, limits } = *drive;
        if !gain_codes_per_v.is_finite() || !offset_code.is_finite() || gain_codes_per_v == 0.0 {
            return Err(TableError::OutOfRange { rule: "the drive's gain and offset must be finite, the gain not 0" });
        }
        self.inverse::<f32>(&limits).map_err(TableError::Drive)?;
        let codes = [limits.range_v.min, limits.range_v.max].map(|volts| offset_code + gain_codes_per_v * volts);
        let scale = Range { min: -0.5, max: f32::from(self.dac.full_scale) + 0.5 };
        if codes.iter().all(|&code| scale.contains(code)) {
            Ok(())
        } else {
            Err(TableError::OutOfRange { rule: "the drive's range_v must lie within what the DAC can put out" })
        }
    }
}

impl Table {
    /// Checks everything, admissibility in the target's `f32` included.
    pub fn admit(self) -> Result<Admitted, TableError> {
        self.check_finite()?;
        self.check_ranges()?;
        match self.engine::<f32>() {
            Engine::Voigt(model) => self.check_voigt(&model)?,
            Engine::Other(model) => {
                admissible::check_reach(model.reach(self.voltage_range_v), self.displacement_limits_um)?;
            }
        }
        let admitted = Admitted(self);
        match &self.drive {
            Some(drive) => admitted.check_drive(drive).map(|()| admitted),
            None => Ok(admitted),
        }
    }

    fn check_voigt(&self, model: &Voigt<f32>) -> Result<(), TableError> {
        let voltage = match self.form {
            Form::Direct => self.voltage_range_v,
            Form::Tabulated { .. } => lookup::covered(self.voltage_range_v),
        };
        let ends = [voltage.min, voltage.max];
        let limits = [self.displacement_limits_um.min, self.displacement_limits_um.max];
        let overflows = ends.iter().any(|&v| !model.drive(v).is_finite() || !model.voltage_term(v).is_finite())
            || limits.iter().any(|&y| !model.displacement_term(y).is_finite());
        if overflows {
            return Err(TableError::Overflow);
        }
        admissible::check(model, voltage, self.displacement_limits_um)?;
        Ok(())
    }

    /// The model in the number type `T`.
    pub fn engine<T: Real>(&self) -> Engine<T> {
        self.parameters.build(self.sample_period(), self.scheme)
    }

    /// The per-tick coefficients of a model of the Voigt family.
    pub fn coefficients<T: Real>(&self) -> Option<Voigt<T>> {
        match self.engine() {
            Engine::Voigt(model) => Some(model),
            Engine::Other(_) => None,
        }
    }

    /// The per-tick functions tabulated over the voltage range, where that is the form: what an
    /// [`Estimator`](crate::Estimator) needs.
    pub fn lookup<T: Real>(&self) -> Option<Lookup<T>> {
        match self.form {
            Form::Direct => None,
            Form::Tabulated { .. } => Some(Lookup::tabulate(&self.coefficients()?, self.voltage_range_v.of())),
        }
    }

    /// Tick, s.
    pub fn sample_period<T: Real>(&self) -> T {
        // Exact: 1 s in µs fits the 24 bits of an f32.
        T::of(self.sample_period_us as f32) / T::of(1e6)
    }

    fn check_finite(&self) -> Result<(), TableError> {
        let error_bound_um = match self.form {
            Form::Direct => 0.0,
            Form::Tabulated { error_bound_um } => error_bound_um,
        };
        let others = [
            ("deadband_v", self.deadband_v),
            ("voltage_zero_v", self.voltage_zero_v),
            ("displacement_zero_um", self.displacement_zero_um),
            ("error_bound_um", error_bound_um),
            ("voltage_range_v", self.voltage_range_v.min),
            ("voltage_range_v", self.voltage_range_v.max),
            ("displacement_limits_um", self.displacement_limits_um.min),
            ("displacement_limits_um", self.displacement_limits_um.max),
            ("adc.gain_v_per_code", self.adc.gain_v_per_code),
            ("adc.offset_v", self.adc.offset_v),
            ("dac.gain_codes_per_um", self.dac.gain_codes_per_um),
            ("dac.offset_code", self.dac.offset_code),
            ("train_mae_um", self.provenance.train_mae_um),
            ("validation_mae_um", self.provenance.validation_mae_um.unwrap_or(0.0)),
            ("validation_max_um", self.provenance.validation_max_um.unwrap_or(0.0)),
        ];
        let parameters = match &self.parameters {
            Parameters::Voigt(of) => of.named(),
            // Theirs are checked by `Parameters::fault`.
            _ => VoigtParameters::default().named(),
        };
        match parameters.into_iter().chain(others).find(|(_, x)| !x.is_finite()) {
            Some((field, _)) => Err(TableError::NonFinite { field }),
            None => Ok(()),
        }
    }

    fn check_ranges(&self) -> Result<(), TableError> {
        let ordered = |range: Range| range.min < range.max;
        let limits = self.displacement_limits_um;
        let voltages = self.voltage_range_v;
        let rules: [(&'static str, bool); 13] = [
            ("the parameters must be those of the model", self.parameters.are_of(self.model)),
            (
                "only a model of the Voigt family has a tabulated form and a scheme other than forward-euler",
                self.model.is_voigt() || (self.form == Form::Direct && self.scheme == Scheme::ForwardEuler),
            ),
            ("sample_period_us must lie between 1 and 1000000", (1..=1_000_000).contains(&self.sample_period_us)),
            ("voltage_range_v must be ordered", ordered(voltages)),
            ("voltage_range_v must lie within 100 kV", {
                voltages.min.abs().max(voltages.max.abs()) <= LARGEST_VOLTAGE_V
            }),
            ("error_bound_um must not be negative", !matches!(self.form, Form::Tabulated { error_bound_um: ..0.0 })),
            ("deadband_v must lie between 0 and the voltage range", {
                (0.0..self.voltage_range_v.span()).contains(&self.deadband_v)
            }),
            ("displacement_limits_um must be ordered", ordered(limits)),
            ("displacement_limits_um must lie within a metre", {
                limits.min.abs().max(limits.max.abs()) <= LARGEST_DISPLACEMENT_UM
            }),
            ("adc.gain_v_per_code must be positive", self.adc.gain_v_per_code > 0.0),
            ("adc.full_scale must be at least 3", self.adc.full_scale >= 3),
            ("dac.gain_codes_per_um must not be 0", self.dac.gain_codes_per_um != 0.0),
            ("dac.full_scale must be at least 1", self.dac.full_scale >= 1),
        ];
        let broken = rules.into_iter().find(|&(_, holds)| !holds).map(|(rule, _)| rule);
        let broken = broken.or_else(|| match &self.parameters {
            Parameters::Voigt(of) => voigt_fault(of, self.model),
            others => others.fault(),
        });
        broken.map_or(Ok(()), |rule| Err(TableError::OutOfRange { rule }))
    }
}

/// The rule that parameters of the Voigt family break, if any.
fn voigt_fault(p: &VoigtParameters, model: Model) -> Option<&'static str> {
    let exponent = |x: f32| (0.0..=LARGEST_EXPONENT).contains(&x);
    let rules = [
        ("alpha_um must be positive", p.alpha_um > 0.0),
        ("lambda_per_v must be positive", p.lambda_per_v > 0.0),
        ("b_ohm must be positive", p.b_ohm > 0.0),
        ("p must lie between 0 and 8", exponent(p.p)),
        ("h must lie between 0 and 8", exponent(p.h)),
        ("f must lie between 0 and 8", exponent(p.f)),
        (
            "g_um_per_s and h must be 0 in a model without the voltage-extremum term",
            model.has_voltage_term() || (p.g_um_per_s == 0.0 && p.h == 0.0),
        ),
        (
            "e_m_per_s and f must be 0 in a model without the displacement-extremum term",
            model.has_displacement_term() || (p.e_m_per_s == 0.0 && p.f == 0.0),
        ),
    ];
    rules.into_iter().find(|&(_, holds)| !holds).map(|(rule, _)| rule)
}
