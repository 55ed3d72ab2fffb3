//! The calibration of a target's converters, where it is stated and where it is assumed.

use crate::drive::DriveOptions;
use crate::span::Span;
use estimator_core::{AdcCalibration, AdcCode, DacCalibration, DacCode, Range, Table};

/// Calibration of the converters.
#[derive(Clone, Debug, Default)]
pub struct CalibrationOptions {
    /// Amplifier voltage at ADC code 0 and at full scale, V; the first larger than the second where the divider inverts.
    /// Without it a range a little wider than the logs' is assumed.
    pub adc_span: Option<Span>,
    /// Largest ADC code (with oversampling); 4095 where nothing else is known.
    pub adc_full_scale: Option<u16>,
    /// Displacement at DAC code 0 and at full scale, µm relative to the model's zero. Without it the displacement limits.
    pub dac_span: Option<Span>,
    /// Largest DAC code; 4095 where nothing else is known.
    pub dac_full_scale: Option<u16>,
    /// The DAC as the amplifier's input.
    pub drive: DriveOptions,
}

/// A 12-bit converter.
const FULL_SCALE: u16 = 4095;
/// Assumed room of the ADC beyond the table's voltages, as a fraction of their span.
const ADC_ROOM: f64 = 0.05;

impl CalibrationOptions {
    /// Whether the ADC's span was stated, and what the DAC's codes are.
    pub fn stated(&self) -> bool {
        self.adc_span.is_some() && (self.dac_span.is_some() || self.drive.drive_span.is_some())
    }

    /// The calibration of a new table, assumed where it is not stated. `voltage` is relative to `voltage_zero`.
    pub fn calibration(
        &self,
        voltage: Range<f64>,
        voltage_zero: f64,
        limits: Range<f64>,
    ) -> (AdcCalibration, DacCalibration) {
        let room = ADC_ROOM * voltage.span();
        let adc = self
            .adc_span
            .unwrap_or(Span { zero: voltage_zero + voltage.min - room, full: voltage_zero + voltage.max + room });
        let dac = self.dac_span.unwrap_or(Span { zero: limits.min, full: limits.max });
        (
            adc_calibration(adc, self.adc_full_scale.unwrap_or(FULL_SCALE)),
            dac_calibration(dac, self.dac_full_scale.unwrap_or(FULL_SCALE)),
        )
    }

    /// Changes a table's calibration where something else is stated.
    pub fn apply(&self, table: &mut Table) {
        let scale = table.dac.full_scale;
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
        self.drive.apply(table, scale);
    }
}

/// What does not fit between a table and its converters, in words.
pub fn misfits(table: &Table) -> Vec<String> {
    let mut misfits = Vec::new();
    let volts = |code| table.adc.voltage::<f64>(AdcCode(code)) - f64::from(table.voltage_zero_v);
    let (ends, range) = ([volts(0), volts(table.adc.full_scale)], table.voltage_range_v);
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    if low > f64::from(range.min) || high < f64::from(range.max) {
        misfits.push(format!(
            "the ADC sees {low:.3} … {high:.3} V, the table is for {} … {} V: a wider --adc-span, by another divider",
            range.min, range.max
        ));
    }
    if table.drive.is_some() {
        return misfits;
    }
    if table.dac.saturated(table.dac.code(0.0f64)) {
        misfits.push(
            "displacement 0, where the output goes on a fault, is not within the DAC's range: another --dac-span"
                .to_owned(),
        );
    }
    let um = |code| table.dac.displacement::<f64>(DacCode(code));
    let (ends, limits) = ([um(0), um(table.dac.full_scale)], table.displacement_limits_um);
    let (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    // A calibration that was assumed ends at the limits, to within rounding.
    let room = 1e-4 * f64::from(limits.span());
    if low > f64::from(limits.min) + room || high < f64::from(limits.max) - room {
        misfits.push(format!(
            "the DAC reaches {low:.3} … {high:.3} µm, the table's limits are {} … {} µm: a wider --dac-span",
            limits.min, limits.max
        ));
    }
    misfits
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_reads_as_it_is_written_and_may_be_inverted() {
        let options = CalibrationOptions {
            adc_span: Some("22:-22".parse().unwrap()),
            adc_full_scale: Some(65535),
            dac_span: Some("5:-5".parse().unwrap()),
            ..CalibrationOptions::default()
        };
        let unit = Range { min: -1.0, max: 1.0 };
        let (adc, dac) = options.calibration(unit, 0.0, unit);
        assert!((adc.voltage::<f64>(AdcCode(0)) - 22.0).abs() < 1e-5);
        assert!((adc.voltage::<f64>(AdcCode(65535)) + 22.0).abs() < 1e-4);
        assert_eq!(dac.code(5.0f64), DacCode(0));
        assert_eq!(dac.code(-5.0f64), DacCode(4095));
        assert!(options.stated() && !CalibrationOptions::default().stated());
    }

    #[test]
    fn what_is_assumed_covers_the_table() {
        let (voltage, limits) = (Range { min: -20.0, max: 20.0 }, Range { min: -6.0, max: 7.0 });
        let (adc, dac) = CalibrationOptions::default().calibration(voltage, 50.0, limits);
        assert!(adc.voltage::<f64>(AdcCode(1)) < 30.0 && adc.voltage::<f64>(AdcCode(4094)) > 70.0);
        assert_eq!((dac.code(-6.0f64), dac.code(7.0f64)), (DacCode(0), DacCode(4095)));
    }

    #[test]
    fn converters_that_do_not_fit_are_told() {
        let fits = |adc: (f64, f64), dac: (f64, f64)| {
            let (_, admitted) =
                crate::table_file::TableFile::load("../../tests/data/table/table.toml".as_ref()).unwrap();
            let mut table = *admitted;
            let span = |(zero, full)| Some(Span { zero, full });
            let options = CalibrationOptions { adc_span: span(adc), dac_span: span(dac), ..Default::default() };
            options.apply(&mut table);
            misfits(&table).len()
        };
        assert_eq!(fits((-1.0, 4.0), (-8.0, 52.0)), 0);
        assert_eq!(fits((4.0, -1.0), (52.0, -8.0)), 0, "inverting ones fit as well");
        assert_eq!(fits((0.0, 2.0), (-8.0, 52.0)), 1);
        assert_eq!(fits((-1.0, 4.0), (-1.0, 40.0)), 1);
        assert_eq!(fits((-1.0, 4.0), (10.0, 52.0)), 2, "no safe value, and not all of the limits");
    }
}
