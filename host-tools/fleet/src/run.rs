//! The run of one unit, and the file that says what came of it.

use crate::asked::{Asked, hexadecimal};
use crate::error::UnitError;
use crate::unit::{Ended, Found, Identified, UNIT, Unit, UnitName, VERSION};
use result_files::FileError;
use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// No file of a result is longer than this.
const MOST_BYTES: u64 = 64 << 20;

/// One run, in a folder that is its own meanwhile.
#[derive(Debug)]
pub struct Run {
    folder: PathBuf,
    unit: UnitName,
    tool: String,
    begun: Instant,
    found: Option<(Asked, Found, BTreeMap<String, String>)>,
}

/// Why a folder's result is not that of what is asked, and has to be searched.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Changed {
    /// There is none that can be read.
    Nothing,
    /// It is another unit's.
    Unit(UnitName),
    /// The run before found no table, or has not ended.
    NoTable,
    /// These are other than before.
    Asked(Vec<&'static str>),
    /// A file of it is no longer as it was written, or gone.
    File(String),
}

impl fmt::Display for Changed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "there is no result yet"),
            Self::Unit(unit) => write!(f, "the result is that of {unit}"),
            Self::NoTable => write!(f, "the run before found no table"),
            Self::Asked(parts) => write!(f, "{} changed", parts.join(" and ")),
            Self::File(name) => write!(f, "{name} is not as it was written"),
        }
    }
}

/// SHA-256 of files, by name.
pub fn digests<'n>(files: impl IntoIterator<Item = (&'n str, impl AsRef<[u8]>)>) -> BTreeMap<String, String> {
    files.into_iter().map(|(name, contents)| (name.to_owned(), hexadecimal(contents.as_ref()))).collect()
}

/// Whether a file of the folder itself is as its digest says. A name that leads elsewhere is no result's.
fn as_written(folder: &Path, name: &str, digest: &str, most_bytes: u64) -> bool {
    let plain = Path::new(name).file_name().is_some_and(|plain| plain == name);
    plain && result_files::read(&folder.join(name), most_bytes).is_ok_and(|bytes| hexadecimal(&bytes) == digest)
}

impl Run {
    /// The run of a unit by a program, whose results go into a folder.
    pub fn new(folder: &Path, unit: UnitName, tool: String) -> Self {
        Self { folder: folder.to_owned(), unit, tool, begun: Instant::now(), found: None }
    }

    /// What is other than where the folder's result was made; `None` where the same would be found again.
    pub fn changed(&self, asked: &Asked) -> Option<Changed> {
        let Ok(before) = Unit::read(&self.folder.join(UNIT.0)) else { return Some(Changed::Nothing) };
        if before.unit != self.unit {
            return Some(Changed::Unit(before.unit));
        }
        let Some(Identified { asked: of_before, files, .. }) = before.identified() else {
            return Some(Changed::NoTable);
        };
        let differs = asked.differs(of_before);
        if !differs.is_empty() {
            return Some(Changed::Asked(differs));
        }
        let other = files.iter().find(|(name, digest)| !as_written(&self.folder, name, digest, MOST_BYTES));
        other.map(|(name, _)| Changed::File(name.clone()))
    }

    /// Says that the search has begun: what is killed is then seen to have not ended.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn begin(&self) -> Result<(), FileError> {
        self.write(Ended::Begun)
    }

    /// Leaves the folder's result as it is, and says what it is.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn keep(&self) -> Result<Unit, UnitError> {
        Unit::read(&self.folder.join(UNIT.0))
    }

    /// Keeps what was found, until the end.
    pub fn found(&mut self, asked: Asked, found: Found, files: BTreeMap<String, String>) {
        self.found = Some((asked, found, files));
    }

    /// Says how it ended: with the error, or with what was found; nothing where nothing was searched.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end(self, exit_code: u8, error: Option<String>) -> Result<(), FileError> {
        let seconds = self.begun.elapsed().as_secs_f64();
        let ended = match (&self.found, error) {
            (_, Some(error)) => {
                Ended::Failed { exit_code, error, seconds, table_before: table_files::former(&self.folder) }
            }
            (Some((asked, found, files)), None) => {
                let (asked, found, files) = (asked.clone(), found.clone(), files.clone());
                Ended::Identified(Box::new(Identified { exit_code, seconds, asked, found, files }))
            }
            (None, None) => return Ok(()),
        };
        self.write(ended)
    }

    fn write(&self, ended: Ended) -> Result<(), FileError> {
        let unit = Unit { piezo_unit: VERSION, unit: self.unit.clone(), tool: self.tool.clone(), ended };
        let path = self.folder.join(UNIT.0);
        let text = serde_json::to_string_pretty(&unit)
            .map_err(|error| FileError::Write { path: path.clone(), source: error.into() })?;
        result_files::write(&path, text + "\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::unit::tests::identified;
    use std::fs;

    fn asked(logs: &str) -> Asked {
        Asked { inputs: logs.to_owned(), options: "o".to_owned(), program: "p".to_owned() }
    }

    fn run(folder: &Path, unit: &str) -> Run {
        Run::new(folder, unit.parse().unwrap(), "piezo 0.0.0".to_owned())
    }

    /// A folder with a result of SN042 on the logs `a`.
    fn result() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        let files = [("table.toml", "a table"), ("report.html", "a page")];
        files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
        let mut run = run(folder.path(), "SN042");
        let found = identified("SN042", 0.2, 2.0).identified().unwrap().found.clone();
        run.found(asked("a"), found, digests(files));
        run.end(0, None).unwrap();
        folder
    }

    #[test]
    fn a_result_is_that_of_what_is_asked_until_something_of_it_is_another() {
        let folder = result();
        let changed = |unit: &str, logs: &str| run(folder.path(), unit).changed(&asked(logs));
        assert_eq!(changed("SN042", "a"), None);
        assert_eq!(changed("SN042", "b"), Some(Changed::Asked(vec!["the logs"])));
        assert_eq!(changed("SN043", "a"), Some(Changed::Unit("SN042".parse().unwrap())));
        let table = folder.path().join("table.toml");
        // The same bytes once more, later, are the same file.
        fs::write(&table, "a table").unwrap();
        assert_eq!(changed("SN042", "a"), None);
        fs::write(&table, "a table of another").unwrap();
        assert_eq!(changed("SN042", "a"), Some(Changed::File("table.toml".to_owned())));
        fs::remove_file(&table).unwrap();
        assert_eq!(changed("SN042", "a"), Some(Changed::File("table.toml".to_owned())));
        fs::write(folder.path().join("unit.json"), "{}").unwrap();
        assert_eq!(changed("SN042", "a"), Some(Changed::Nothing));
    }

    #[test]
    fn a_file_elsewhere_or_longer_than_any_is_none_of_a_result() {
        let folder = result();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        let digest = hexadecimal(b"a table");
        let is = |name: &str, most| as_written(folder.path(), name, &digest, most);
        assert!(is("table.toml", 7) && !is("table.toml", 6));
        assert!(!as_written(&inner, "../table.toml", &digest, 7));
        let absolute = folder.path().join("table.toml");
        for name in ["./table.toml", "inner/../table.toml", absolute.to_str().unwrap(), "..", "", "inner"] {
            assert!(!is(name, 7), "{name}");
        }
    }

    #[test]
    fn what_is_left_as_it_is_is_not_written_anew_and_what_ends_with_an_error_is() {
        let folder = result();
        let path = folder.path().join("unit.json");
        let before = fs::read(&path).unwrap();
        let again = run(folder.path(), "SN042");
        assert_eq!(again.keep().unwrap(), Unit::read(&path).unwrap());
        again.end(0, None).unwrap();
        assert_eq!(fs::read(&path).unwrap(), before);
        let mut found = run(folder.path(), "SN042");
        found.found(asked("a"), identified("SN042", 0.2, 2.0).identified().unwrap().found.clone(), BTreeMap::new());
        found.end(2, Some("no memory".to_owned())).unwrap();
        assert!(matches!(Unit::read(&path).unwrap().ended, Ended::Failed { error, .. } if error == "no memory"));
    }

    #[test]
    fn what_failed_or_was_killed_is_searched_again() {
        let folder = result();
        let changed = || run(folder.path(), "SN042").changed(&asked("a"));
        run(folder.path(), "SN042").begin().unwrap();
        assert_eq!(changed(), Some(Changed::NoTable));
        run(folder.path(), "SN042").end(2, Some("no log".to_owned())).unwrap();
        assert_eq!(changed(), Some(Changed::NoTable));
        let Ended::Failed { exit_code, error, .. } = Unit::read(&folder.path().join("unit.json")).unwrap().ended else {
            panic!("it failed");
        };
        assert_eq!((exit_code, error.as_str()), (2, "no log"));
    }
}
