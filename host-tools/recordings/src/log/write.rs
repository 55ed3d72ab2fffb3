//! Writing a log as the CSV that [`super::read`] reads back.

use std::io::{self, BufWriter, Error, ErrorKind, Write};
use std::path::Path;

use super::clock::whole_rate;
use result_files::Replacement;

/// Whose a displacement is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Displacement {
    /// What a sensor measured.
    Measured,
    /// A model's; the column's name says so.
    Estimated,
}

/// Writes `time_s,voltage_V,displacement_um`, a row a sample, time from 0 at `sample_period` (s), voltage in V and
/// displacement in µm, with the fewest digits that read back as the same numbers.
///
/// The file is written beside `path`, which is never half a log, and not yet in its place: it may belong to others.
///
/// # Errors
/// Series of different lengths, a number that is not finite, a period that is not positive
/// ([`ErrorKind::InvalidInput`]); whatever the file system reports.
pub fn csv_beside(
    path: &Path,
    sample_period: f64,
    voltage: &[f64],
    displacement: &[f64],
    whose: Displacement,
) -> io::Result<Replacement> {
    let invalid = |what: String| Err(Error::new(ErrorKind::InvalidInput, what));
    if voltage.len() != displacement.len() {
        let (v, y) = (voltage.len(), displacement.len());
        return invalid(format!("{v} voltages and {y} displacements make no log"));
    }
    if !(sample_period.is_finite() && sample_period > 0.0) {
        return invalid(format!("{sample_period} s is no sample period"));
    }
    let finite = |(v, y): &(&f64, &f64)| v.is_finite() && y.is_finite();
    if let Some(row) = voltage.iter().zip(displacement).position(|r| !finite(&r)) {
        return invalid(format!("sample {} is not finite", row + 1));
    }

    let mut file = Replacement::of(path)?;
    let mut out = BufWriter::new(&mut file);
    let estimated = if whose == Displacement::Estimated { "estimated_" } else { "" };
    writeln!(out, "time_s,voltage_V,{estimated}displacement_um")?;
    let rate = whole_rate(sample_period, 0.0);
    for (k, (v, y)) in voltage.iter().zip(displacement).enumerate() {
        // k/rate is the double nearest to the true time, and so prints short; k·period is not.
        let time = match rate {
            Some(rate) => k as f64 / rate,
            None => k as f64 * sample_period,
        };
        writeln!(out, "{time},{v},{y}")?;
    }
    out.flush()?;
    drop(out);
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_times_and_ordinary_permissions() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let ramp: Vec<f64> = (0..20).map(f64::from).collect();
        csv_beside(&path, 0.0005, &ramp, &ramp, Displacement::Measured).unwrap().commit().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.lines().nth(8), Some("0.0035,7,7"), "k·period would print 0.0035000000000000005");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = std::fs::metadata(&path).unwrap().permissions().mode();
            assert_eq!(mode & 0o600, 0o600);
        }
    }

    #[test]
    fn refuses_what_makes_no_log() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        for (period, voltage, displacement) in [
            (0.001, vec![1.0], vec![]),
            (0.0, vec![1.0], vec![1.0]),
            (f64::NAN, vec![1.0], vec![1.0]),
            (0.001, vec![f64::NAN], vec![1.0]),
        ] {
            let error = csv_beside(&path, period, &voltage, &displacement, Displacement::Measured).err().unwrap();
            assert_eq!(error.kind(), ErrorKind::InvalidInput);
        }
        assert!(!path.exists());
    }
}
