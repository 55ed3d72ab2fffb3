//! What a C program must know of a parameter table before it begins with it.

use crate::PiezoResult;
use crate::memory::{Out, bytes};
use crate::result::result;
use core::fmt::{self, Write};
use core::slice;
use estimator_core::Table;

/// Bytes of stack that `piezo_table_read` and the functions that begin take at most.
pub const PIEZO_BEGIN_STACK_BYTES: usize = 24_576;

/// What a table says of itself.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PiezoTable {
    /// Time between two ticks, µs; 500 is 2 kHz. Ticks at another rate give other numbers.
    pub sample_period_us: u32,
    /// Amplifier voltages that the model was identified on, V. Beyond, the estimate stands still and says so.
    pub voltage_min_v: f32,
    /// The upper end of them, V.
    pub voltage_max_v: f32,
    /// The estimate never leaves these but by what it was told, µm relative to the model's zero.
    pub displacement_min_um: f32,
    /// The upper end of them, µm.
    pub displacement_max_um: f32,
    /// Reading of the sensor that the model calls 0, µm.
    pub displacement_zero_um: f32,
    /// Whether it states limits within which an amplifier may be driven.
    pub has_drive: bool,
    /// Whether it states how far the estimate may be off.
    pub has_interval: bool,
}

/// Reads and checks a parameter table: the bytes of `table.bin`, with or without others behind them.
///
/// `reason` takes what is wrong, in English, cut to `size` bytes with its final NUL, and "" where nothing is; it
/// may be null.
///
/// # Safety
/// `record` points to `length` bytes, no more than a signed `ptrdiff_t` counts, `table` to a structure or is null, and
/// `reason` to `size` bytes or is null, none of which are the record's.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_table_read(
    record: *const u8,
    length: usize,
    table: *mut PiezoTable,
    reason: *mut u8,
    size: usize,
) -> PiezoResult {
    // SAFETY: as the caller promises. The bytes may be uninitialised: they become zeros before anything reads them.
    let reason = unsafe {
        if reason.is_null() || size == 0 {
            &mut []
        } else {
            reason.write_bytes(0, size);
            slice::from_raw_parts_mut(reason, size)
        }
    };
    result(|| {
        // SAFETY: as the caller promises.
        let record = unsafe { bytes(record, length) }.inspect_err(|_| {
            let _ = write!(Text(reason), "the record's pointer is null");
        })?;
        let admitted = Table::parse(record).inspect_err(|error| {
            // Text that does not fit is cut.
            let _ = write!(Text(reason), "{error}");
        })?;
        let zero = admitted.voltage_zero_v;
        let facts = PiezoTable {
            sample_period_us: admitted.sample_period_us,
            voltage_min_v: admitted.voltage_range_v.min + zero,
            voltage_max_v: admitted.voltage_range_v.max + zero,
            displacement_min_um: admitted.displacement_limits_um.min,
            displacement_max_um: admitted.displacement_limits_um.max,
            displacement_zero_um: admitted.displacement_zero_um,
            has_drive: admitted.drive.is_some(),
            has_interval: admitted.interval.is_some(),
        };
        if let Ok(out) = Out::of(table) {
            // SAFETY: as the caller promises.
            unsafe { out.write(facts) };
        }
        Ok(())
    })
}

/// A buffer for text; its last byte stays 0.
struct Text<'a>(&'a mut [u8]);

impl Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let capacity = self.0.len().saturating_sub(1);
        // No character is cut in two.
        let fits = (0..=text.len().min(capacity)).rev().find(|&end| text.is_char_boundary(end)).unwrap_or(0);
        let (here, rest) = core::mem::take(&mut self.0).split_at_mut(fits);
        here.copy_from_slice(&text.as_bytes()[..fits]);
        self.0 = rest;
        if fits == text.len() { Ok(()) } else { Err(fmt::Error) }
    }
}
