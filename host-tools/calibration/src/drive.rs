//! The DAC as the amplifier's input, and what the amplifier may be driven to.

use crate::span::Span;
use estimator_core::{DriveCalibration, DriveLimits, Range, Table};

/// The DAC as the amplifier's input.
#[derive(Clone, Debug, Default)]
pub struct DriveOptions {
    /// Amplifier voltage at DAC code 0 and at full scale, V; the first larger than the second where the amplifier inverts.
    /// The DAC then drives the amplifier (piezo follow), and never shows a displacement.
    pub drive_span: Option<Span>,
    /// Fastest change of that voltage, V/s.
    pub drive_slew: Option<f64>,
    /// Voltages that it may be driven to, V. Without it, all that the DAC can and the model was identified on.
    pub drive_range: Option<Span>,
    /// Voltages that the amplifier stands, V; the range is no wider where none is said.
    pub drive_within: Option<Span>,
    /// Voltage when nothing is wanted or something is wrong, V. Without it 0, or the voltage nearest to it.
    pub drive_rest: Option<f64>,
}

/// The voltages at the amplifier that a table's model was identified on, V.
pub fn identified_on(table: &Table) -> Range {
    let Range { min, max } = table.voltage_range_v;
    Range { min: min + table.voltage_zero_v, max: max + table.voltage_zero_v }
}

/// Limits within a range, at rest at 0 V or next to it where nothing is said.
pub fn limits(range_v: Range, rest: Option<f64>, slew: f64) -> DriveLimits {
    let rest_v = rest.map_or_else(|| range_v.clamp(0.0), |rest| rest as f32);
    DriveLimits { range_v, rest_v, slew_v_per_s: slew as f32 }
}

/// A range from its ends in either order.
pub fn ordered(span: Span) -> Range {
    Range { min: span.zero.min(span.full) as f32, max: span.zero.max(span.full) as f32 }
}

impl DriveOptions {
    /// Makes a table's DAC drive the amplifier, where that is stated; a drive that the table has is kept, for a DAC that may
    /// have had another full scale, `before`.
    pub fn apply(&self, table: &mut Table, before: u16) {
        if let Some(drive) = &mut table.drive {
            let factor = f64::from(table.dac.full_scale) / f64::from(before);
            drive.gain_codes_per_v = (f64::from(drive.gain_codes_per_v) * factor) as f32;
            drive.offset_code = (f64::from(drive.offset_code) * factor) as f32;
        }
        let (Some(span), Some(slew)) = (self.drive_span, self.drive_slew) else { return };
        let gain = f64::from(table.dac.full_scale) / (span.full - span.zero);
        let (dac, model) = (ordered(span), identified_on(table));
        let most = self.drive_within.map_or(dac, |within| dac.intersection(ordered(within)));
        table.drive = Some(DriveCalibration {
            gain_codes_per_v: gain as f32,
            offset_code: (-span.zero * gain) as f32,
            limits: limits(self.drive_range.map_or(most.intersection(model), ordered), self.drive_rest, slew),
        });
    }
}
