//! Files that are written whole or not at all, and what they are never written over.

use result_files::{FileError, may_be_replaced, writable, write, write_all};
use std::fs;
use std::path::Path;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn files_that_belong_together_are_written_all_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("a"), "old").unwrap();
    fs::create_dir(at("b")).unwrap();
    let FileError::Write { path, .. } = write_all([(at("a"), "new"), (at("b"), "new")]).unwrap_err() else { panic!() };
    assert_eq!(path, at("b"));
    assert_eq!(fs::read_to_string(at("a")).unwrap(), "old");
    assert_eq!(names(folder.path()), ["a", "b"]);
    write_all([(at("a"), "new"), (at("c"), "new")]).unwrap();
    assert_eq!(fs::read_to_string(at("a")).unwrap(), "new");
    assert_eq!(names(folder.path()), ["a", "b", "c"]);
}

#[cfg(unix)]
#[test]
fn links_are_followed_and_permissions_kept() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("real"), "old").unwrap();
    // Wider than a new file's.
    fs::set_permissions(at("real"), fs::Permissions::from_mode(0o666)).unwrap();
    symlink(at("real"), at("link")).unwrap();
    write(&at("link"), "new").unwrap();
    assert!(at("link").is_symlink());
    assert_eq!(fs::read_to_string(at("real")).unwrap(), "new");
    assert_eq!(fs::metadata(at("real")).unwrap().permissions().mode() & 0o777, 0o666);
}

/// Even where the operating system would allow it, as to the superuser.
#[cfg(unix)]
#[test]
fn what_would_be_lost_is_refused_and_stays() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("locked"), "old").unwrap();
    fs::set_permissions(at("locked"), fs::Permissions::from_mode(0o444)).unwrap();
    symlink(at("nowhere"), at("dangling")).unwrap();
    symlink("/dev/null", at("device")).unwrap();
    for name in ["locked", "dangling", "device"] {
        assert!(matches!(write(&at(name), "new"), Err(FileError::Write { .. })), "{name}");
    }
    assert_eq!(fs::read_to_string(at("locked")).unwrap(), "old");
    assert!(fs::metadata("/dev/null").unwrap().file_type().is_char_device());
    assert_eq!(names(folder.path()), ["dangling", "device", "locked"]);
}

#[test]
fn only_what_is_known_as_a_former_result_may_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("ours"), "# A result\n1.0").unwrap();
    fs::write(at("empty"), "").unwrap();
    fs::write(at("strange"), "wages").unwrap();
    fs::write(at("late"), format!("{}# A result", " ".repeat(512))).unwrap();
    let may =
        ["ours", "empty", "missing", "strange", "late"].map(|name| may_be_replaced(&at(name), "# A result").unwrap());
    assert_eq!(may, [true, true, true, false, false]);
}

#[test]
fn a_folder_is_tried_before_it_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let deep = folder.path().join("not/yet");
    writable(&deep).unwrap();
    assert!(names(folder.path()).is_empty());
    fs::write(folder.path().join("not"), "a file").unwrap();
    assert!(matches!(writable(&deep), Err(FileError::Folder { .. })));
}
