//! The faces of a table in one folder: they are of one table, or are refused; and one run at a time writes there.

use super::{MEASURED, data, piezo, refused, text};
use estimator_core::record::checksum;
use result_files::Held;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use table_files::{TableFile, agree, name};

/// Tables of two actuators.
const TABLES: [&str; 2] = ["table/table.toml", "table/generalised-prandtl-ishlinskii/table.toml"];
const FACES: [&str; 3] = ["table.toml", "table.rs", "table.bin"];

fn emit(table: &str, folder: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_piezo"));
    command.arg("emit").arg(data(table)).arg("--out").arg(folder).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn emitted(table: &str, folder: &Path) -> PathBuf {
    assert!(emit(table, folder).status().unwrap().success());
    folder.to_owned()
}

/// Moments of a run that takes so long, at random, a little beyond its end too.
pub struct Moments {
    whole: Duration,
    state: u32,
}

impl Moments {
    pub fn of(whole: Duration) -> Self {
        Self { whole, state: 2_463_534_242 }
    }

    /// Lets a run go on to one of them, and kills it there.
    pub fn kill(&mut self, mut run: Child) {
        // Marsaglia's xorshift.
        self.state ^= self.state << 13;
        self.state ^= self.state >> 17;
        self.state ^= self.state << 5;
        std::thread::sleep(self.whole.mul_f64(1.3 * f64::from(self.state) / f64::from(u32::MAX)));
        // One that has ended is none to be killed.
        let _ = run.kill();
        run.wait().unwrap();
    }
}

/// What each face says that its table is, read without the code under test; none where there is no such face.
pub fn said(folder: &Path) -> Vec<String> {
    let toml = TableFile::load(&folder.join("table.toml")).ok().map(|(_, table)| name(&table));
    let rust = fs::read_to_string(folder.join("table.rs")).ok();
    let rust = rust.map(|text| text.split("// Checksum ").nth(1).unwrap()[..8].to_owned());
    let record = fs::read(folder.join("table.bin")).ok().map(|bytes| format!("{:08x}", checksum(&bytes).unwrap()));
    [toml, rust, record].into_iter().flatten().collect()
}

fn is_accepted(folder: &Path, face: &str) -> bool {
    let flash = piezo().args(["flash", "--dry-run", "--table"]).arg(folder.join(face)).output().unwrap();
    let refused = String::from_utf8_lossy(&flash.stderr).contains("is the table of checksum");
    // Another table's is refused at once; what is left is that of its doubts nobody can be asked.
    assert_eq!(flash.status.code(), Some(if refused { 2 } else { 1 }), "{flash:?}");
    !refused
}

#[test]
fn a_face_beside_one_of_another_table_is_refused_with_what_to_type() {
    let folders = tempfile::tempdir().unwrap();
    // Both fit the NUCLEO-G474RE, which `flash` asks.
    let [one, other] = [("one", "-8:52"), ("other", "-9:53")].map(|(folder, span)| {
        let folder = folders.path().join(folder);
        let options = ["--adc-full-scale", "65520", "--dac-span", span];
        assert!(emit(TABLES[0], &folder).args(options).status().unwrap().success());
        folder
    });
    for named in ["table.toml", "table.bin"] {
        assert!(is_accepted(&one, named));
    }
    for (replaced, named) in [
        ("table.toml", "table.bin"),
        ("table.rs", "table.bin"),
        ("table.bin", "table.toml"),
        ("table.rs", "table.toml"),
    ] {
        let kept = fs::read(one.join(replaced)).unwrap();
        fs::copy(other.join(replaced), one.join(replaced)).unwrap();
        assert!(!is_accepted(&one, named), "{replaced} beside {named}");
        fs::write(one.join(replaced), kept).unwrap();
    }
    fs::copy(other.join("table.bin"), one.join("table.bin")).unwrap();
    let (toml, bin) = (one.join("table.toml"), one.join("table.bin"));
    let again = format!("piezo emit {} --out {}", text(&toml), text(&one));
    // Before anything is asked of a device.
    let port = ["--port", "tcp:127.0.0.1:9"];
    refused(&[&["push", text(&toml)], &port[..]].concat(), &[text(&toml), text(&bin), &again]);
    refused(&[&["push", text(&bin)], &port[..]].concat(), &[text(&toml), text(&bin), &again]);
    refused(&[&["install", text(&one), "--board", "none.toml"], &port[..]].concat(), &[text(&bin), &again]);
    let looked = piezo().args(["validate", text(&toml), MEASURED]).assert().success().get_output().stderr.clone();
    assert!(String::from_utf8_lossy(&looked).contains("careful: "));
    let remedied =
        piezo().args(["emit", text(&toml), "--out", text(&one)]).assert().success().get_output().stderr.clone();
    assert!(remedied.is_empty() && is_accepted(&one, "table.bin"));
    // An edit of one face is no other case; a stranger's file of such a name is none.
    let edited = fs::read_to_string(&toml).unwrap().replacen("train_mae_um = 0.3", "train_mae_um = 0.4", 1);
    fs::write(&toml, edited).unwrap();
    assert!(!is_accepted(&one, "table.toml"));
    fs::remove_file(&bin).unwrap();
    fs::write(one.join("table.rs"), "pub fn of_a_stranger() {}\n").unwrap();
    assert!(is_accepted(&one, "table.toml"));
}

/// Killed at any moment, a set is of one table, or is seen not to be; leftovers are swept.
#[test]
fn a_killed_emit_leaves_no_set_that_is_accepted_and_mixed() {
    let folders = tempfile::tempdir().unwrap();
    let folder = emitted(TABLES[0], &folders.path().join("con"));
    // What the folder is in between the renames, whether a kill comes there or not.
    let other = emitted(TABLES[1], &folders.path().join("other"));
    for renamed in 1..3 {
        emitted(TABLES[0], &folder);
        FACES[..renamed].iter().for_each(|face| assert!(fs::copy(other.join(face), folder.join(face)).is_ok()));
        let (_, table) = TableFile::load(&folder.join("table.toml")).unwrap();
        assert!(agree(&folder.join("table.toml"), &table).is_err(), "after {renamed} renames");
    }
    let begun = Instant::now();
    emitted(TABLES[0], &folder);
    let (mut moments, mut kills) = (Moments::of(begun.elapsed()), 0);
    while begun.elapsed() < Duration::from_secs(6) {
        moments.kill(emit(TABLES[kills % 2], &folder).spawn().unwrap());
        kills += 1;
        let faces = said(&folder);
        let mixed = faces.iter().any(|face| *face != faces[0]);
        let (_, table) = TableFile::load(&folder.join("table.toml")).expect("old or new, never half");
        assert_eq!(agree(&folder.join("table.toml"), &table).is_err(), mixed, "{faces:?}");
    }
    assert!(kills > 20, "{kills} kills are too few to say anything");
    emitted(TABLES[0], &folder);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), FACES.len(), "leftovers are swept");
}

#[test]
fn one_run_at_a_time_writes_into_a_folder() {
    let folders = tempfile::tempdir().unwrap();
    let folder = folders.path().join("con");
    let held = Held::of(&folder).unwrap();
    let begun = Instant::now();
    let table = text(&data(TABLES[0])).to_owned();
    for command in [&["identify", MEASURED][..], &["emit", &table], &["compare", MEASURED]] {
        refused(&[command, &["--out", text(&folder)]].concat(), &[text(&folder), "another program", "--out"]);
    }
    assert!(begun.elapsed() < Duration::from_secs(5), "before a search, not after it");
    drop(held);
    assert!(!folder.exists(), "what nothing was written into is not left behind");
    for round in 0..10 {
        let runs: Vec<_> = (0..4).map(|k| emit(TABLES[(round + k) % 2], &folder).spawn().unwrap()).collect();
        let codes: Vec<_> = runs.into_iter().map(|mut run| run.wait().unwrap().code()).collect();
        assert!(codes.contains(&Some(0)) && codes.iter().all(|code| [Some(0), Some(2)].contains(code)), "{codes:?}");
        let faces = said(&folder);
        assert!(faces.len() == 3 && faces.iter().all(|face| *face == faces[0]), "{faces:?}");
    }
}

/// A file that no run has written is not written over, unless that is said.
#[test]
fn a_stranger_s_file_and_an_input_are_not_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let table = text(&data(TABLES[0])).to_owned();
    let validate = |out: &Path, more: &[&str]| {
        let words = ["validate", &table, MEASURED, "--to", "20", "--out", text(out)];
        piezo().args(words).args(more).output().unwrap()
    };
    fs::write(at("notes.csv"), "of three weeks\n").unwrap();
    let kept = validate(&at("notes.csv"), &[]);
    assert!(kept.status.code() == Some(2) && String::from_utf8_lossy(&kept.stderr).contains("--force"), "{kept:?}");
    assert_eq!(fs::read_to_string(at("notes.csv")).unwrap(), "of three weeks\n");
    assert!(validate(&at("notes.csv"), &["--force"]).status.success());
    assert!(validate(&at("notes.csv"), &[]).status.success(), "a former result of this kind is replaced");
    // A measured log is no estimates.
    fs::copy(data("picma-p885-session2.csv"), at("log.csv")).unwrap();
    assert_eq!(validate(&at("log.csv"), &[]).status.code(), Some(2));
    for name in ["table.toml", "table.rs", "table.bin"] {
        let target = at("set");
        fs::create_dir_all(&target).unwrap();
        fs::write(target.join(name), "a stranger's\n").unwrap();
        let says = [name, "--force"];
        refused(&["emit", &table, "--out", text(&target)], &says);
        refused(&["identify", MEASURED, "--out", text(&target)], &says);
        assert_eq!(fs::read_dir(&target).unwrap().count(), 1, "nothing else is written");
        fs::remove_dir_all(&target).unwrap();
    }
    // An input is none to be written over, whatever is said.
    fs::copy(data("../data/picma-p885-1hz.csv"), at("table.rs")).unwrap();
    refused(&["identify", text(&at("table.rs")), "--out", text(folder.path()), "--force"], &["table.rs", "is read"]);
}

/// Neither a pipe that nobody writes into nor a device without an end is waited for.
#[cfg(unix)]
#[test]
fn a_table_or_board_that_is_no_regular_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.toml");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let begun = Instant::now();
    let table = text(&data(TABLES[0])).to_owned();
    for file in [text(&pipe), "/dev/zero"] {
        refused(&["validate", file, MEASURED], &[file, "no regular file"]);
        refused(&["push", file, "--port", "tcp:127.0.0.1:9"], &[file, "no regular file"]);
        refused(&["install", &table, "--board", file, "--port", "tcp:127.0.0.1:9"], &[file, "no regular file"]);
    }
    let large = folder.path().join("large.toml");
    fs::File::create(&large).unwrap().set_len(1 << 40).unwrap();
    let message = refused(&["validate", text(&large), MEASURED], &["large.toml", "longer than"]);
    assert!(!message.contains("permissions"), "{message}");
    assert!(begun.elapsed() < Duration::from_secs(5));
}
