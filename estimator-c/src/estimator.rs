//! The estimator for C.

use crate::PiezoResult;
use crate::memory::{Out, bytes, get, memory, put};
use crate::result::result;
use estimator_core::{AdcCode, Estimate, Estimator, Status, Table};

/// Bits of `PiezoEstimate.status`: the ADC stands at an end of its range.
pub const PIEZO_ADC_SATURATED: u8 = 1;
/// The voltage is beyond those the model was identified on; the nearest was taken.
pub const PIEZO_VOLTAGE_OUT_OF_RANGE: u8 = 2;
/// The displacement was clamped to the table's limits.
pub const PIEZO_CLAMPED: u8 = 4;
/// The DAC's code stands at an end of its range.
pub const PIEZO_DAC_SATURATED: u8 = 8;
/// The estimate still depends on where it was assumed to start, or on voltages beyond the table's range since.
pub const PIEZO_NOT_SETTLED: u8 = 16;
/// The voltage has gone as it never went in the training.
pub const PIEZO_UNTRAINED: u8 = 64;

const _: () = {
    assert!(PIEZO_ADC_SATURATED == Status::ADC_SATURATED.bits());
    assert!(PIEZO_VOLTAGE_OUT_OF_RANGE == Status::VOLTAGE_OUT_OF_RANGE.bits());
    assert!(PIEZO_CLAMPED == Status::CLAMPED.bits());
    assert!(PIEZO_DAC_SATURATED == Status::DAC_SATURATED.bits());
    assert!(PIEZO_NOT_SETTLED == Status::NOT_SETTLED.bits());
    assert!(PIEZO_UNTRAINED == Status::UNTRAINED.bits());
};

/// Memory of an estimator. Static memory, or `= {0}`; nothing in it is the caller's to read.
#[repr(C)]
pub struct PiezoEstimator {
    begun: u32,
    words: [u64; PIEZO_ESTIMATOR_WORDS],
}

/// Words of a `PiezoEstimator`.
pub const PIEZO_ESTIMATOR_WORDS: usize = 1024;

impl PiezoEstimator {
    const WORDS: usize = PIEZO_ESTIMATOR_WORDS;
}

memory!(PiezoEstimator of Estimator<f32>);

/// What a tick gives.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PiezoEstimate {
    /// Displacement at the next tick, µm.
    pub displacement_um: f32,
    /// Half the width of its 95 % interval, µm; NaN where the table has none, the displacement was never told, or the
    /// voltage is beyond the table's range or at an end of the ADC's.
    pub half_width_um: f32,
    /// The displacement as a DAC with the table's calibration takes it, right-aligned.
    pub dac_code: u16,
    /// `PIEZO_ADC_SATURATED` and the others; 0 where there is nothing to report.
    pub status: u8,
}

impl From<Estimate<f32>> for PiezoEstimate {
    fn from(estimate: Estimate<f32>) -> Self {
        Self {
            displacement_um: estimate.displacement,
            half_width_um: estimate.half_width.unwrap_or(f32::NAN),
            dac_code: estimate.dac.0,
            status: estimate.status.bits(),
        }
    }
}

/// Begins an estimator with a parameter table, the bytes of `table.bin`; they are not needed afterwards. The actuator
/// is assumed to have rested at the first tick's voltage. A table that is refused leaves the structure as it was. Not
/// for an interrupt: it checks the whole table.
///
/// # Safety
/// `record` points to `length` bytes, and `estimator` to a structure that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_begin(
    estimator: *mut PiezoEstimator,
    record: *const u8,
    length: usize,
) -> PiezoResult {
    result(|| {
        // SAFETY: as the caller promises.
        let table = Table::parse(unsafe { bytes(record, length) }?)?;
        // SAFETY: as the caller promises.
        unsafe { put(estimator, Estimator::new(&table)) }
    })
}

/// One tick with the code of an ADC with the table's calibration. May be called from an
/// interrupt.
///
/// # Safety
/// `estimator` points to an initialised structure that nobody else uses, and `estimate` to a structure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_tick(
    estimator: *mut PiezoEstimator,
    adc_code: u16,
    estimate: *mut PiezoEstimate,
) -> PiezoResult {
    result(|| {
        let out = Out::of(estimate)?;
        // SAFETY: as the caller promises.
        let given = unsafe { get(estimator) }?.tick(AdcCode(adc_code));
        // SAFETY: as the caller promises.
        unsafe { out.write(given.into()) };
        Ok(())
    })
}

/// One tick with the amplifier's voltage, V, for an ADC that is not the table's.
///
/// # Safety
/// As `piezo_estimator_tick`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_tick_volts(
    estimator: *mut PiezoEstimator,
    voltage_v: f32,
    estimate: *mut PiezoEstimate,
) -> PiezoResult {
    result(|| {
        finite(voltage_v)?;
        let out = Out::of(estimate)?;
        // SAFETY: as the caller promises.
        let given = unsafe { get(estimator) }?.tick_volts(voltage_v);
        // SAFETY: as the caller promises.
        unsafe { out.write(given.into()) };
        Ok(())
    })
}

/// Starts anew, from rest at the next tick's voltage; what was told is forgotten.
///
/// # Safety
/// `estimator` points to an initialised structure that nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_restart(estimator: *mut PiezoEstimator) -> PiezoResult {
    result(|| {
        // SAFETY: as the caller promises.
        unsafe { get(estimator) }?.restart();
        Ok(())
    })
}

/// Starts anew from a known displacement, µm relative to the model's zero. One beyond the table's limits
/// becomes the nearest.
///
/// # Safety
/// As `piezo_estimator_restart`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_start_at(estimator: *mut PiezoEstimator, displacement_um: f32) -> PiezoResult {
    result(|| {
        finite(displacement_um)?;
        // SAFETY: as the caller promises.
        unsafe { get(estimator) }?.start_at(displacement_um);
        Ok(())
    })
}

/// Calls the displacement of now `at_um`, where a stop, a gauge or rest tells it; the interval is relative to it.
/// `PIEZO_RESULT_TOO_SOON` where it may not be told yet.
///
/// # Safety
/// As `piezo_estimator_restart`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_estimator_set_zero(estimator: *mut PiezoEstimator, at_um: f32) -> PiezoResult {
    result(|| {
        finite(at_um)?;
        // SAFETY: as the caller promises.
        let told = unsafe { get(estimator) }?.set_zero(at_um);
        if told { Ok(()) } else { Err(PiezoResult::TooSoon) }
    })
}

pub(crate) fn finite(number: f32) -> Result<(), PiezoResult> {
    if number.is_finite() { Ok(()) } else { Err(PiezoResult::NotFinite) }
}
