//! A measurement that grows beside its place: what a killed program leaves, and what becomes of it where the
//! place is taken.

use result_files::{FileError, Replacement, partial};
use std::fs;
use std::io::{self, Write};
use std::path::Path;

/// What it holds that grew beside `log.csv`, where that takes no place: its error names it.
fn kept(log: &Path, error: &io::Error) -> String {
    let named = format!("what was written is kept in {}", partial(log).display());
    assert!(error.to_string().ends_with(&named), "{error}");
    fs::read_to_string(partial(log)).unwrap()
}

#[test]
fn what_a_killed_program_has_measured_is_found_named_and_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let left = partial(&log);
    assert_eq!(left, folder.path().join("log.csv.partial"));
    fs::write(&left, "1,2\n").unwrap();
    // Neither of these sweeps it.
    Replacement::of(&folder.path().join("table.bin")).unwrap().commit().unwrap();
    assert!(matches!(Replacement::growing(&log), Err(FileError::Left { path }) if path == left));
    assert_eq!(fs::read_to_string(&left).unwrap(), "1,2\n");
    fs::rename(&left, folder.path().join("of-before.csv")).unwrap();
    Replacement::growing(&log).unwrap().commit_measured(false).unwrap();
    assert!(log.exists() && !left.exists());
}

#[test]
fn what_was_measured_stays_where_its_place_was_taken_meanwhile() {
    for over in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let log = folder.path().join("log.csv");
        let begun = || {
            let mut growing = Replacement::growing(&log).unwrap();
            growing.write_all(b"1,2\n").unwrap();
            growing
        };
        let growing = begun();
        fs::create_dir(&log).unwrap();
        assert_eq!(kept(&log, &growing.commit_measured(over).unwrap_err()), "1,2\n");
        fs::remove_dir(&log).unwrap();
        fs::remove_file(partial(&log)).unwrap();
        let growing = begun();
        fs::write(&log, "another's").unwrap();
        match growing.commit_measured(over) {
            Ok(()) => assert!(over && fs::read_to_string(&log).unwrap() == "1,2\n"),
            Err(error) => {
                assert_eq!(kept(&log, &error), "1,2\n");
                assert!(!over && fs::read_to_string(&log).unwrap() == "another's");
                fs::remove_file(partial(&log)).unwrap();
                // An empty file is nobody's measurement.
                fs::write(&log, "").unwrap();
                begun().commit_measured(over).unwrap();
                assert_eq!(fs::read_to_string(&log).unwrap(), "1,2\n");
            }
        }
    }
}

#[test]
fn what_grows_is_there_by_its_name_and_is_one_program_s() {
    let folder = tempfile::tempdir().unwrap();
    let log = folder.path().join("log.csv");
    let mut growing = Replacement::growing(&log).unwrap();
    growing.write_all(b"1,2\n3,").unwrap();
    assert_eq!(fs::read_to_string(partial(&log)).unwrap(), "1,2\n3,");
    assert!(matches!(Replacement::growing(&log), Err(FileError::Growing { .. })));
    let kept = growing.keep_lines().unwrap().unwrap();
    assert_eq!((&kept, &*fs::read_to_string(&kept).unwrap()), (&partial(&log), "1,2\n"));
    fs::remove_file(kept).unwrap();
    drop(Replacement::growing(&log).unwrap());
    assert_eq!(Replacement::growing(&log).unwrap().keep_lines().unwrap(), None);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "dropped, it leaves nothing");
}
