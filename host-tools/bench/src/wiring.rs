//! A board that is wired to be driven beside a sensor: everything that a session must know of it.

use crate::board_file::BoardFacts;
use ::calibration::CalibrationOptions;
use device_link::sensor::Sensor;
use estimator_core::{
    AdcCalibration, Admitted, DacCalibration, Digest, DriveCalibration, List, Parameters, PrandtlIshlinskiiParameters,
    Provenance, Range, Scheme, Table, TableError,
};
use excitation::Request;

/// Everything of a board that a session must know.
#[derive(Clone, PartialEq, Debug)]
pub struct Wiring {
    /// What the file says.
    pub facts: BoardFacts,
    /// The sensor on the second channel.
    pub sensor: Sensor,
    line: Admitted,
    drive: DriveCalibration,
}

/// Why a board cannot be driven beside a sensor by what is known of it.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
pub enum WiringError {
    /// Something is not said.
    #[error("it does not say {field}, {what}")]
    Missing {
        /// The field of `board.toml` that is missing.
        field: &'static str,
        /// What the field says of the bench, for the message.
        what: &'static str,
    },
    /// The numbers do not fit each other.
    #[error("its spans and limits do not fit each other")]
    Refused(#[from] TableError),
    /// A session was to go farther than the amplifier may.
    #[error("{min_v} … {max_v} V are not within drive_range, {} … {} V", allowed.min, allowed.max)]
    BeyondRange {
        /// Lowest voltage that was asked for, V.
        min_v: f64,
        /// Highest voltage that was asked for, V.
        max_v: f64,
        /// What the file allows, V.
        allowed: Range,
    },
}

impl Wiring {
    /// Of a board of this tick, µs.
    ///
    /// # Errors
    /// The file does not say all that is needed, or its numbers do not fit each other.
    pub fn new(facts: &BoardFacts, tick_us: u32) -> Result<Self, WiringError> {
        let missing = |field, what| WiringError::Missing { field, what };
        let adc = facts.adc_span.ok_or(missing("adc_span", "the volts at ADC code 0 and at full scale"))?;
        let full_scale = facts.adc_full_scale.ok_or(missing("adc_full_scale", "the largest ADC code"))?;
        let dac_full_scale = facts.dac_full_scale.ok_or(missing("dac_full_scale", "the largest DAC code"))?;
        facts.drive_span.ok_or(missing("drive_span", "the volts at DAC code 0 and at full scale"))?;
        facts.drive_range.ok_or(missing("drive_range", "the volts that the amplifier may be driven to"))?;
        facts.drive_rest.ok_or(missing("drive_rest", "the volts when nothing is wanted"))?;
        facts.drive_slew.ok_or(missing("drive_slew", "the fastest change in V/s"))?;
        let (zero_um, full_um) =
            facts.sensor_span.ok_or(missing("sensor_span", "the µm at the sensor's code 0 and at full scale"))?;
        let line = straight_line(facts, adc, full_scale, dac_full_scale, tick_us)?;
        // It was just made with one.
        let drive = line.drive.ok_or(missing("drive_span", "the volts at DAC code 0 and at full scale"))?;
        Ok(Self { facts: *facts, sensor: Sensor { zero_um, full_um, full_scale }, line, drive })
    }

    /// A table whose estimate is the amplifier's voltage above its rest, 1 µm a V: no model of any actuator, but with
    /// the board's converters and limits, so that the board can be driven before there is one.
    pub fn line(&self) -> &Admitted {
        &self.line
    }

    /// What the ADC's codes stand for.
    pub fn adc(&self) -> AdcCalibration {
        self.line.adc
    }

    /// What the DAC's codes stand for, and the limits.
    pub fn drive(&self) -> DriveCalibration {
        self.drive
    }

    /// A drive within `range` (V), else within all that the amplifier may be driven to.
    ///
    /// # Errors
    /// The range is wider than that.
    pub fn request(
        &self,
        range: Option<(f64, f64)>,
        up_to_hz: f64,
        duration_s: f64,
        seed: u64,
    ) -> Result<Request, WiringError> {
        let limits = self.drive.limits;
        let allowed = limits.range_v;
        let (min_v, max_v) = range.unwrap_or((allowed.min.into(), allowed.max.into()));
        let (min_v, max_v) = (min_v.min(max_v), min_v.max(max_v));
        if !(allowed.contains(min_v as f32) && allowed.contains(max_v as f32)) {
            return Err(WiringError::BeyondRange { min_v, max_v, allowed });
        }
        let (slew_v_per_s, tick_s) = (f64::from(limits.slew_v_per_s), self.line.sample_period());
        Ok(Request { min_v, max_v, rest_v: limits.rest_v.into(), slew_v_per_s, up_to_hz, duration_s, tick_s, seed })
    }
}

/// What is said of a straight line in use.
pub const NO_MODEL: &str = "no model: a straight line for measuring, its µm are volts above the rest";

/// The table in use is the straight line's.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[error("the device has {NO_MODEL}")]
pub struct NoModel;

/// Whether a table is the straight line of [`Wiring::line`], no model: it was made from no log by no version of a tool.
pub fn is_line(table: &Table) -> bool {
    let Provenance { logs, tool_version, .. } = table.provenance;
    logs == Digest::default() && tool_version == [0; 3]
}

/// Refuses the straight line where a displacement is wanted.
///
/// # Errors
/// The table is the straight line's.
pub fn require_model(table: &Table) -> Result<(), NoModel> {
    if is_line(table) { Err(NoModel) } else { Ok(()) }
}

fn straight_line(
    facts: &BoardFacts,
    adc: (f64, f64),
    adc_full_scale: u16,
    dac_full_scale: u16,
    tick_us: u32,
) -> Result<Admitted, WiringError> {
    let rest = facts.drive_rest.unwrap_or(0.0);
    let all = Range { min: (adc.0.min(adc.1) - rest) as f32, max: (adc.0.max(adc.1) - rest) as f32 };
    let mut table = Table {
        sample_period_us: tick_us,
        scheme: Scheme::ForwardEuler,
        deadband_v: 0.0,
        voltage_zero_v: rest as f32,
        displacement_zero_um: 0.0,
        voltage_range_v: all,
        displacement_limits_um: Range { min: 1.1 * all.min - 1.0, max: 1.1 * all.max + 1.0 },
        parameters: Parameters::PrandtlIshlinskii(PrandtlIshlinskiiParameters {
            lag_s: 0.0,
            thresholds_v: List::of([0.0]),
            weights_um_per_v: List::of([1.0]),
            offset_um: 0.0,
            dead_zones_um: List::of([]),
            dead_zone_slopes: List::of([]),
            memory_v: all,
        }),
        remanence_um: [0.0; 2],
        adc: AdcCalibration { gain_v_per_code: 1.0, offset_v: 0.0, invert: false, full_scale: adc_full_scale },
        amplifier_slew_v_per_s: None,
        dac: DacCalibration { gain_codes_per_um: 1.0, offset_code: 0.0, full_scale: dac_full_scale },
        drive: None,
        interval: None,
        provenance: Provenance {
            logs: Digest::default(),
            seed: 0,
            tool_version: [0; 3],
            train_mae_um: 0.0,
            validation_mae_um: None,
            validation_max_um: None,
        },
    };
    // What a set-point wants is µm, which this table knows nothing of.
    let facts = BoardFacts { setpoint_span: None, linearise: None, ..*facts };
    facts.calibration(&CalibrationOptions::default()).apply(&mut table);
    Ok(table.admit()?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::FACTS;
    use estimator_core::Estimator;

    #[test]
    fn its_line_says_volts_and_has_the_board_s_limits() {
        let wiring = Wiring::new(&FACTS, 500).unwrap();
        let mut estimator = Estimator::<f32>::new(wiring.line());
        for volts in [0.0f32, 40.0, -7.5, 100.0] {
            let said = estimator.tick(wiring.adc().code(volts)).displacement;
            assert!((said - volts).abs() < 5e-3, "{volts} V: {said}");
        }
        assert!(is_line(wiring.line()) && !is_line(&emulator::TABLE));
        let controlled = BoardFacts { setpoint_span: Some((-1.0, 16.0)), linearise: Some(true), ..FACTS };
        assert_eq!(Wiring::new(&controlled, 500).unwrap().drive().setpoint, None, "its µm are volts");
        let limits = wiring.drive().limits;
        assert_eq!((limits.range_v, limits.rest_v, limits.slew_v_per_s), (Range { min: 0.0, max: 100.0 }, 0.0, 500.0));
    }

    #[test]
    fn what_is_missing_or_does_not_fit_is_named() {
        let refused = |facts: BoardFacts| Wiring::new(&facts, 500).unwrap_err().to_string();
        assert!(refused(BoardFacts { sensor_span: None, ..FACTS }).contains("sensor_span, the µm"));
        assert!(refused(BoardFacts { drive_slew: None, ..FACTS }).contains("drive_slew"));
        let inadmissible = Wiring::new(&BoardFacts { drive_rest: Some(120.0), ..FACTS }, 500).unwrap_err();
        assert!(matches!(inadmissible, WiringError::Refused(_)), "{inadmissible}");
        let wide = Wiring::new(&FACTS, 500).unwrap().request(Some((0.0, 101.0)), 20.0, 10.0, 1).unwrap_err();
        assert!(wide.to_string().contains("0 … 101 V are not within drive_range, 0 … 100 V"), "{wide}");
    }
}
