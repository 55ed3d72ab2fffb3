//! The inverse for C: the amplifier voltage for a wanted displacement.

use crate::PiezoResult;
use crate::memory::{Out, bytes, get, memory, put};
use crate::result::result;
use estimator_core::{Commanded, DriveLimits, Inverse, Range, Table};

/// Memory of an inverse. Static memory, or `= {0}`; nothing in it is the caller's to read.
#[repr(C)]
pub struct PiezoInverse {
    begun: u32,
    words: [u64; PIEZO_INVERSE_WORDS],
}

/// Words of a `PiezoInverse`.
pub const PIEZO_INVERSE_WORDS: usize = 512;

impl PiezoInverse {
    const WORDS: usize = PIEZO_INVERSE_WORDS;
}

memory!(PiezoInverse of Inverse<f32>);

/// What an amplifier may be driven to.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PiezoDriveLimits {
    /// Least amplifier voltage, V; within those that the model was identified on.
    pub voltage_min_v: f32,
    /// Largest amplifier voltage, V; within those that the model was identified on.
    pub voltage_max_v: f32,
    /// Amplifier voltage when nothing is wanted, V.
    pub rest_v: f32,
    /// Fastest change, V/s.
    pub slew_v_per_s: f32,
}

/// What a tick gives.
#[repr(C)]
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PiezoCommand {
    /// Amplifier voltage from the next tick on, V.
    pub voltage_v: f32,
    /// Displacement that the model reaches with it a tick later, µm relative to its zero.
    pub displacement_um: f32,
    /// Whether that is what was wanted. Where not, a limit of voltage or slew rate keeps it away.
    pub reached: bool,
}

impl From<Commanded<f32>> for PiezoCommand {
    fn from(commanded: Commanded<f32>) -> Self {
        Self { voltage_v: commanded.voltage, displacement_um: commanded.displacement, reached: commanded.reached }
    }
}

/// Begins an inverse with a parameter table, long at rest at the rest voltage. `limits` may be null: then they
/// are the table's own. **The amplifier must stand at the rest voltage**: the first tick goes on from there. Not
/// for an interrupt.
///
/// # Safety
/// `record` points to `length` bytes, `limits` to a structure or is null, and `inverse` to a structure that
/// nobody else uses.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_inverse_begin(
    inverse: *mut PiezoInverse,
    record: *const u8,
    length: usize,
    limits: *const PiezoDriveLimits,
) -> PiezoResult {
    result(|| {
        // SAFETY: as the caller promises.
        let table = Table::parse(unsafe { bytes(record, length) }?)?;
        // SAFETY: as the caller promises.
        let given = unsafe { limits.as_ref() }.map(|limits| DriveLimits {
            range_v: Range { min: limits.voltage_min_v, max: limits.voltage_max_v },
            rest_v: limits.rest_v,
            slew_v_per_s: limits.slew_v_per_s,
        });
        let limits = given.or(table.drive.map(|drive| drive.limits)).ok_or(PiezoResult::NoInverse)?;
        // SAFETY: as the caller promises.
        unsafe { put(inverse, table.inverse(&limits)?) }
    })
}

/// One tick: the voltage for a displacement (µm relative to the model's zero) that is wanted a tick after
/// the voltage stands.
///
/// # Safety
/// `inverse` points to an initialised structure that nobody else uses, and `command` to a structure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_inverse_tick(
    inverse: *mut PiezoInverse,
    displacement_um: f32,
    command: *mut PiezoCommand,
) -> PiezoResult {
    result(|| {
        crate::estimator::finite(displacement_um)?;
        let out = Out::of(command)?;
        // SAFETY: as the caller promises.
        let commanded = unsafe { get(inverse) }?.tick(displacement_um);
        // SAFETY: as the caller promises.
        unsafe { out.write(commanded.into()) };
        Ok(())
    })
}

/// One tick towards the rest voltage, as fast as the limits allow: the way out of every mode, for it cannot jump.
///
/// # Safety
/// As `piezo_inverse_tick`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn piezo_inverse_release(inverse: *mut PiezoInverse, command: *mut PiezoCommand) -> PiezoResult {
    result(|| {
        let out = Out::of(command)?;
        // SAFETY: as the caller promises.
        let commanded = unsafe { get(inverse) }?.release();
        // SAFETY: as the caller promises.
        unsafe { out.write(commanded.into()) };
        Ok(())
    })
}
