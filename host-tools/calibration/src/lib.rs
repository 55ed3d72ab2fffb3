//! The calibration of a target's converters, where it is stated and where it is assumed.

pub mod drive;
pub mod span;

use crate::drive::{DriveOptions, FullScales, trained_on};
use crate::span::Span;
use estimator_core::{AdcCalibration, AdcCode, DacCalibration, DacCode, Range, Table};
use serde::Serialize;

/// A converter, or both, whose calibration is a placeholder.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Assumed {
    /// The ADC's, for a range a little wider than the logs'.
    Adc,
    /// The DAC's, for the displacement limits.
    Dac,
    /// The ADC's and the DAC's.
    Both,
}

/// Calibration of the converters.
#[derive(Clone, Debug, Default)]
pub struct CalibrationOptions {
    /// Amplifier voltage at ADC code 0 and at full scale, V; the first larger than the second where the divider
    /// inverts. Without it a range a little wider than the logs' is assumed.
    pub adc_span: Option<Span>,
    /// Largest ADC code (with oversampling); 4095 where nothing else is known.
    pub adc_full_scale: Option<u16>,
    /// Fastest change of the amplifier's output, V/s; nothing is checked where it is not stated.
    pub amplifier_slew: Option<f64>,
    /// Displacement at DAC code 0 and at full scale, µm relative to the model's zero. Without it
    /// the displacement limits.
    pub dac_span: Option<Span>,
    /// Largest DAC code; 4095 where nothing else is known.
    pub dac_full_scale: Option<u16>,
    /// The DAC as the amplifier's input.
    pub drive: DriveOptions,
}

/// A 12-bit converter.
const FULL_SCALE: u16 = 4095;
/// Assumed margin of the ADC beyond the table's voltages, as a fraction of their span.
const ADC_MARGIN: f64 = 0.05;

impl CalibrationOptions {
    /// Of which converters nobody says what their codes are; `None` where both are stated.
    pub fn assumed(&self) -> Option<Assumed> {
        match (self.adc_span.is_some(), self.dac_span.is_some() || self.drive.drive_span.is_some()) {
            (true, true) => None,
            (true, false) => Some(Assumed::Dac),
            (false, true) => Some(Assumed::Adc),
            (false, false) => Some(Assumed::Both),
        }
    }

    /// The calibration of a new table, assumed where it is not stated. `voltage` is relative to `voltage_zero`.
    pub fn calibration(
        &self,
        voltage: Range<f64>,
        voltage_zero: f64,
        limits: Range<f64>,
    ) -> (AdcCalibration, DacCalibration) {
        let margin = ADC_MARGIN * voltage.span();
        let adc = self
            .adc_span
            .unwrap_or(Span { zero: voltage_zero + voltage.min - margin, full: voltage_zero + voltage.max + margin });
        let dac = self.dac_span.unwrap_or(Span { zero: limits.min, full: limits.max });
        (
            adc_calibration(adc, self.adc_full_scale.unwrap_or(FULL_SCALE)),
            dac_calibration(dac, self.dac_full_scale.unwrap_or(FULL_SCALE)),
        )
    }

    /// Changes a table's calibration where something else is stated.
    pub fn apply(&self, table: &mut Table) {
        let before = FullScales::of(table);
        let adc_span = self.adc_span.unwrap_or_else(|| {
            let voltage = |code| table.adc.voltage(AdcCode(code));
            Span { zero: voltage(0), full: voltage(table.adc.full_scale) }
        });
        let dac_span = self.dac_span.unwrap_or_else(|| {
            let displacement = |code| table.dac.displacement(DacCode(code));
            Span { zero: displacement(0), full: displacement(table.dac.full_scale) }
        });
        if self.adc_span.is_some() || self.adc_full_scale.is_some() {
            table.adc = adc_calibration(adc_span, self.adc_full_scale.unwrap_or(table.adc.full_scale));
        }
        if self.dac_span.is_some() || self.dac_full_scale.is_some() {
            table.dac = dac_calibration(dac_span, self.dac_full_scale.unwrap_or(table.dac.full_scale));
        }
        table.amplifier_slew_v_per_s = self.amplifier_slew().or(table.amplifier_slew_v_per_s);
        self.drive.apply(table, before);
    }

    /// Fastest change of the amplifier's output as a table has it, V/s.
    pub fn amplifier_slew(&self) -> Option<f32> {
        self.amplifier_slew.map(|slew| slew as f32)
    }
}

/// What does not fit between a table and its converters.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum ConverterMismatch {
    /// The ADC does not see all voltages of the table's training.
    #[error(
        "the ADC sees {:.3} … {:.3} V, the table's training went from {:.3} to {:.3} V", sees.min, sees.max, trained.min, trained.max
    )]
    Adc {
        /// What the ADC sees, V at the amplifier.
        sees: Range<f64>,
        /// What the training went over, V at the amplifier.
        trained: Range,
    },
    /// The DAC has no code for displacement 0.
    #[error("displacement 0, where the output goes on a fault, is not within the DAC's range")]
    SafeOutput,
    /// The DAC does not reach the table's limits.
    #[error("the DAC reaches {:.3} … {:.3} µm, the table's limits are {} … {} µm", reaches.min, reaches.max, table.min, table.max)]
    Dac {
        /// What the DAC reaches, µm.
        reaches: Range<f64>,
        /// The table's limits, µm.
        table: Range,
    },
}

/// Everything that does not fit between a table and its converters.
pub fn converter_mismatches(table: &Table) -> Vec<ConverterMismatch> {
    let mut mismatches = Vec::new();
    let between = |one: f64, other: f64| Range { min: one.min(other), max: one.max(other) };
    let volts = |code| table.adc.voltage::<f64>(AdcCode(code));
    let (sees, trained) = (between(volts(0), volts(table.adc.full_scale)), trained_on(table));
    // The margin was put on and taken off again by rounded numbers.
    let code = f64::from(table.adc.gain_v_per_code.abs());
    if sees.min > f64::from(trained.min) + code || sees.max < f64::from(trained.max) - code {
        mismatches.push(ConverterMismatch::Adc { sees, trained });
    }
    if table.drive.is_some() {
        return mismatches;
    }
    if table.dac.saturated(table.dac.code(0.0f64)) {
        mismatches.push(ConverterMismatch::SafeOutput);
    }
    let um = |code| table.dac.displacement::<f64>(DacCode(code));
    let (reaches, limits) = (between(um(0), um(table.dac.full_scale)), table.displacement_limits_um);
    // A calibration that was assumed ends at the limits, to within rounding.
    let margin = 1e-4 * f64::from(limits.span());
    if reaches.min > f64::from(limits.min) + margin || reaches.max < f64::from(limits.max) - margin {
        mismatches.push(ConverterMismatch::Dac { reaches, table: limits });
    }
    mismatches
}

fn adc_calibration(span: Span, full_scale: u16) -> AdcCalibration {
    AdcCalibration {
        gain_v_per_code: ((span.full - span.zero).abs() / f64::from(full_scale)) as f32,
        offset_v: span.zero as f32,
        invert: span.full < span.zero,
        full_scale,
    }
}

fn dac_calibration(span: Span, full_scale: u16) -> DacCalibration {
    let gain = f64::from(full_scale) / (span.full - span.zero);
    DacCalibration { gain_codes_per_um: gain as f32, offset_code: (-span.zero * gain) as f32, full_scale }
}
