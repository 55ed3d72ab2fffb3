//! What the functions of C refuse, and with which word.

use piezo_estimator::*;
use std::mem::MaybeUninit;
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};

fn data(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/data/table").join(path)
}

/// Records as they are beside their tables: Miri would take minutes to read the tables themselves.
fn voigt() -> Vec<u8> {
    std::fs::read(data("table.bin")).unwrap()
}

fn generalised() -> Vec<u8> {
    std::fs::read(data("generalised-prandtl-ishlinskii/table.bin")).unwrap()
}

/// A structure of C as static memory has it.
trait Zeros: Sized {
    fn zeros() -> Box<Self> {
        // SAFETY: the structures below are integers, of which zeros are a value.
        unsafe { Box::new(MaybeUninit::zeroed().assume_init()) }
    }
}

impl Zeros for PiezoEstimator {}
impl Zeros for PiezoInverse {}

const NOTHING: PiezoEstimate = PiezoEstimate { displacement_um: 0.0, half_width_um: 0.0, dac_code: 0, status: 0 };

/// The result of a check, and the reason in words, in a buffer of this size.
fn read(record: &[u8], size: usize) -> (PiezoResult, String) {
    let mut reason = vec![b'?'; size];
    // SAFETY: the pointers are those of slices.
    let result =
        unsafe { piezo_table_read(record.as_ptr(), record.len(), null_mut(), reason.as_mut_ptr(), reason.len()) };
    let end = reason.iter().position(|&byte| byte == 0);
    (result, end.map_or_else(String::new, |end| String::from_utf8(reason[..end].to_vec()).unwrap()))
}

#[test]
fn a_record_is_refused_with_the_reason() {
    let good = voigt();
    let flipped = |at: usize| {
        let mut record = good.clone();
        record[at] ^= 1;
        record
    };
    assert_eq!(read(&good, 80), (PiezoResult::Ok, String::new()));
    assert_eq!(read(&[good.clone(), vec![0xff; 100]].concat(), 80), (PiezoResult::Ok, String::new()));
    for (record, result, reason) in [
        (good[..20].to_vec(), PiezoResult::Truncated, "truncated: 20 of"),
        (vec![0xff; 2048], PiezoResult::NotATable, "not a parameter table"),
        (flipped(4), PiezoResult::Version, "format version"),
        (flipped(30), PiezoResult::Checksum, "corrupt: checksum"),
    ] {
        let (found, words) = read(&record, 200);
        assert_eq!(found, result);
        assert!(words.contains(reason), "{words}");
        let mut estimator = PiezoEstimator::zeros();
        // SAFETY: the pointers are those of a slice and of a box.
        assert_eq!(unsafe { piezo_estimator_begin(&mut *estimator, record.as_ptr(), record.len()) }, result);
        let mut estimate = NOTHING;
        // SAFETY: as above.
        assert_eq!(unsafe { piezo_estimator_tick(&mut *estimator, 1, &mut estimate) }, PiezoResult::NotBegun);
        assert_eq!(estimate, NOTHING);
    }
}

#[test]
fn a_reason_is_cut_to_its_room() {
    assert_eq!(read(&[], 10), (PiezoResult::Truncated, "truncated".into()));
    assert_eq!(read(&[], 1), (PiezoResult::Truncated, String::new()));
    assert_eq!(read(&[], 0), (PiezoResult::Truncated, String::new()));
}

#[test]
fn null_is_refused() {
    let record = voigt();
    let (start, length) = (record.as_ptr(), record.len());
    let (mut estimator, mut inverse) = (PiezoEstimator::zeros(), PiezoInverse::zeros());
    // SAFETY: the pointers are those of a slice, of boxes, or null, which the functions take.
    unsafe {
        assert_eq!(piezo_table_read(null(), 0, null_mut(), null_mut(), 0), PiezoResult::Null);
        assert_eq!(piezo_estimator_begin(null_mut(), start, length), PiezoResult::Null);
        assert_eq!(piezo_estimator_begin(&mut *estimator, null(), length), PiezoResult::Null);
        assert_eq!(piezo_inverse_begin(null_mut(), start, length, null()), PiezoResult::NoInverse);
        assert_eq!(piezo_inverse_begin(&mut *inverse, null(), length, null()), PiezoResult::Null);
        assert_eq!(piezo_estimator_begin(&mut *estimator, start, length), PiezoResult::Ok);
        let mut twin = PiezoEstimator::zeros();
        assert_eq!(piezo_estimator_begin(&mut *twin, start, length), PiezoResult::Ok);
        assert_eq!(piezo_estimator_tick(&mut *estimator, 1, null_mut()), PiezoResult::Null);
        let (mut after, mut alone) = (NOTHING, NOTHING);
        assert_eq!(piezo_estimator_tick(&mut *estimator, 9000, &mut after), PiezoResult::Ok);
        assert_eq!(piezo_estimator_tick(&mut *twin, 9000, &mut alone), PiezoResult::Ok);
        assert_eq!(after.displacement_um, alone.displacement_um, "what is refused is no tick");
        assert_eq!(piezo_estimator_restart(null_mut()), PiezoResult::Null);
    }
}

#[test]
fn no_number_that_is_none_gets_in() {
    let record = generalised();
    let mut estimator = PiezoEstimator::zeros();
    let mut estimate = NOTHING;
    // SAFETY: the pointers are those of a slice and of a box.
    unsafe {
        assert_eq!(piezo_estimator_begin(&mut *estimator, record.as_ptr(), record.len()), PiezoResult::Ok);
        assert_eq!(piezo_estimator_set_zero(&mut *estimator, 0.0), PiezoResult::TooSoon);
        assert_eq!(piezo_estimator_tick_volts(&mut *estimator, f32::NAN, &mut estimate), PiezoResult::NotFinite);
        assert_eq!(piezo_estimator_start_at(&mut *estimator, f32::INFINITY), PiezoResult::NotFinite);
        assert_eq!(estimate, NOTHING);
        assert_eq!(piezo_estimator_tick_volts(&mut *estimator, 1.0, &mut estimate), PiezoResult::Ok);
    }
    assert!(estimate.displacement_um.is_finite() && estimate.half_width_um.is_nan());
}

#[test]
fn an_inverse_needs_limits_that_keep_their_rules() {
    // Tables without limits of a drive.
    let [gpi, narx] = ["generalised-prandtl-ishlinskii", "narx"].map(|model| {
        let (_, table) = table_files::TableFile::load(&data(&format!("models/{model}.toml"))).unwrap();
        table_files::record(&table)
    });
    let limits = PiezoDriveLimits { voltage_min_v: 0.0, voltage_max_v: 3.0, rest_v: 0.0, slew_v_per_s: 100.0 };
    let mut inverse = PiezoInverse::zeros();
    let mut begin = |record: &[u8], limits: Option<PiezoDriveLimits>| {
        let limits = limits.as_ref().map_or(null(), std::ptr::from_ref);
        // SAFETY: the pointers are those of a slice, of a box, of a reference, or null, which the function takes.
        unsafe { piezo_inverse_begin(&mut *inverse, record.as_ptr(), record.len(), limits) }
    };
    assert_eq!(begin(&gpi, None), PiezoResult::NoInverse);
    assert_eq!(begin(&gpi, Some(limits)), PiezoResult::Ok);
    assert_eq!(begin(&gpi, Some(PiezoDriveLimits { voltage_max_v: 150.0, ..limits })), PiezoResult::Limits);
    assert_eq!(begin(&gpi, Some(PiezoDriveLimits { slew_v_per_s: f32::NAN, ..limits })), PiezoResult::Limits);
    assert_eq!(begin(&narx, Some(limits)), PiezoResult::NoInverse);
}
