//! The DAC as the amplifier's input, and what the amplifier may be driven to.

use crate::span::Span;
use estimator_core::{DriveCalibration, DriveLimits, Range, SetpointCalibration, Table};

/// The DAC as the amplifier's input.
#[derive(Clone, Debug, Default)]
pub struct DriveOptions {
    /// Amplifier voltage at DAC code 0 and at full scale, V; the first larger than the second where the amplifier
    /// inverts. The DAC then drives the amplifier (piezo follow), and never shows a displacement.
    pub drive_span: Option<Span>,
    /// Fastest change of that voltage, V/s.
    pub drive_slew: Option<f64>,
    /// Voltages that it may be driven to, V. Without it, all that the DAC can and the model was identified on.
    pub drive_range: Option<Span>,
    /// Voltages that the amplifier stands, V; the range is no wider where none is said.
    pub drive_within: Option<Span>,
    /// Voltage when nothing is wanted or something is wrong, V. Without it 0, or the voltage nearest to it.
    pub drive_rest: Option<f64>,
    /// Displacement that a controller wants by the set-point's code 0 and by its full scale, µm relative to
    /// the model's zero.
    pub setpoint_span: Option<Span>,
    /// Whether the device follows the set-point of itself after a start; where that is not said, it is as it was.
    pub linearise: Option<bool>,
}

/// The voltages at the amplifier that a table's model was identified on, V.
pub fn identified_on(table: &Table) -> Range {
    let Range { min, max } = table.voltage_range_v;
    Range { min: min + table.voltage_zero_v, max: max + table.voltage_zero_v }
}

/// Margin beyond the training's voltages that a table still covers at either end, as a fraction of their span.
pub const RANGE_MARGIN: f64 = 0.05;

/// The voltages at the amplifier that the training of a table's model went over, V: what it was identified on
/// without the margin.
pub fn trained_on(table: &Table) -> Range {
    let Range { min, max } = identified_on(table);
    let margin = (max - min) * (RANGE_MARGIN / (1.0 + 2.0 * RANGE_MARGIN)) as f32;
    Range { min: min + margin, max: max - margin }
}

/// Limits within a range, at rest at 0 V or next to it where nothing is said.
pub fn limits(range_v: Range, rest: Option<f64>, slew: f64) -> DriveLimits {
    let rest_v = rest.map_or_else(|| range_v.clamp(0.0), |rest| rest as f32);
    DriveLimits { range_v, rest_v, slew_v_per_s: slew as f32 }
}

/// The limits that a plan keeps: what is stated, else the table's drive's, else what its training went over, with a
/// rest that is stated within the margin of that; at rest at 0 V or next to it. `None` where nobody says how fast the
/// voltage may change, V/s.
pub fn planned(table: &Table, range: Option<Span>, rest: Option<f64>, slew: Option<f64>) -> Option<DriveLimits> {
    let drive = table.drive.map(|drive| drive.limits);
    let taught = || match rest.map(|rest| rest as f32).filter(|&rest| identified_on(table).contains(rest)) {
        Some(rest) => trained_on(table).include(rest),
        None => trained_on(table),
    };
    let range = range.map(ordered).or(drive.map(|drive| drive.range_v)).unwrap_or_else(taught);
    let rest = rest.or(drive.map(|drive| range.clamp(drive.rest_v).into()));
    Some(limits(range, rest, slew.or(drive.map(|drive| drive.slew_v_per_s.into()))?))
}

/// A range from its ends in either order.
pub fn ordered(span: Span) -> Range {
    Range { min: span.zero.min(span.full) as f32, max: span.zero.max(span.full) as f32 }
}

/// The largest codes of a table's converters.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FullScales {
    /// The ADC's largest code.
    pub adc: u16,
    /// The DAC's largest code.
    pub dac: u16,
}

impl FullScales {
    /// Those of a table as it is.
    pub fn of(table: &Table) -> Self {
        Self { adc: table.adc.full_scale, dac: table.dac.full_scale }
    }
}

/// Why a table cannot be driven by a set-point.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum SetpointMismatch {
    /// The DAC shows the displacement.
    #[error("a set-point is followed by a DAC that drives the amplifier, and by this table it does not")]
    NoDrive,
    /// Nobody said which displacements its codes stand for.
    #[error("nothing says which displacements a set-point wants")]
    NoSpan,
}

impl DriveOptions {
    /// Makes a table's DAC drive the amplifier, and by a set-point, where that is stated; a drive or a set-point that
    /// the table has is kept, for converters that may have had other full scales, `before`.
    pub fn apply(&self, table: &mut Table, before: FullScales) {
        let now = FullScales::of(table);
        if let Some(drive) = &mut table.drive {
            let factor = f64::from(now.dac) / f64::from(before.dac);
            drive.gain_codes_per_v = (f64::from(drive.gain_codes_per_v) * factor) as f32;
            drive.offset_code = (f64::from(drive.offset_code) * factor) as f32;
            if let Some(setpoint) = &mut drive.setpoint {
                let factor = f64::from(before.adc) / f64::from(now.adc);
                setpoint.gain_um_per_code = (f64::from(setpoint.gain_um_per_code) * factor) as f32;
            }
        }
        if let (Some(span), Some(slew)) = (self.drive_span, self.drive_slew) {
            self.drive(table, span, slew);
        }
        let Some(drive) = &mut table.drive else { return };
        if let Some(span) = self.setpoint_span {
            drive.setpoint = Some(SetpointCalibration {
                gain_um_per_code: ((span.full - span.zero) / f64::from(now.adc)) as f32,
                offset_um: span.zero as f32,
                at_start: drive.setpoint.is_some_and(|before| before.at_start),
            });
        }
        if let (Some(at_start), Some(setpoint)) = (self.linearise, &mut drive.setpoint) {
            setpoint.at_start = at_start;
        }
    }

    /// Refuses what is stated of a set-point where it is nothing to a table, of which is said whether it drives the
    /// amplifier and whether it says what a set-point wants.
    ///
    /// # Errors
    /// Which of the two is missing.
    pub fn require(&self, drives: bool, has_setpoint: bool) -> Result<(), SetpointMismatch> {
        let linearises = self.linearise == Some(true);
        if (linearises || self.setpoint_span.is_some()) && !drives {
            return Err(SetpointMismatch::NoDrive);
        }
        if linearises && !has_setpoint { Err(SetpointMismatch::NoSpan) } else { Ok(()) }
    }

    fn drive(&self, table: &mut Table, span: Span, slew: f64) {
        let gain = f64::from(table.dac.full_scale) / (span.full - span.zero);
        let (dac, model) = (ordered(span), identified_on(table));
        let most = self.drive_within.map_or(dac, |within| dac.intersection(ordered(within)));
        table.drive = Some(DriveCalibration {
            gain_codes_per_v: gain as f32,
            offset_code: (-span.zero * gain) as f32,
            limits: limits(self.drive_range.map_or(most.intersection(model), ordered), self.drive_rest, slew),
            setpoint: table.drive.and_then(|drive| drive.setpoint),
        });
    }
}
