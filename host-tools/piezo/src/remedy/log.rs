//! What is wrong with a log or with how it is prepared.

use recordings::log::{Fault, LogError};
use recordings::prepare::PrepareError;
use std::error::Error;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(LogError { path, place, fault: found }) = error.downcast_ref() {
        return Some(format!("{}{place}: {}", path.display(), fault(found)));
    }
    error.downcast_ref().map(prepare)
}

fn fault(fault: &Fault) -> String {
    match fault {
        Fault::SampleRate(rate) => format!("--fs {rate} is not a sample rate: state it in Hz, as in --fs 2000"),
        Fault::NoHeader { count, file, example } => {
            let rate = if *count < 3 { " --fs 2000" } else { "" };
            format!(
                "{fault}: say which is which, as in `{file} --columns {example}{rate}` (numbers from 1 to {count}; a header \
                 behind a # is not read)"
            )
        }
        Fault::NoTime { file } => format!(
            "{fault}: state the sample rate in Hz, as in `{file} --fs 2000`, or the time column, by adding time=N:s to \
             --columns"
        ),
        Fault::NoColumn { file, example, .. } => format!("{fault}: name it, as in `{file} --columns {example}`"),
        Fault::TwoClaims { example, .. } => format!("{fault}: choose one, as in --columns {example}"),
        Fault::MissingUnit { example, .. } => format!("{fault}: state it, as in --columns {example}"),
        Fault::UnknownUnit { example, .. } => format!("{fault}; or state the unit, as in --columns {example}"),
        Fault::WrongDimension { example, .. } => {
            format!("{fault}: correct the header, or say which is which, as in --columns {example}")
        }
        Fault::NoSuchColumn { wanted, columns } => {
            format!("--columns asks for column {wanted} and the columns are {columns}: choose among these")
        }
        Fault::IrregularTime { .. } => format!("{fault} with --fs"),
        Fault::ImplausiblePeriod { example, .. } => format!("{fault}: state its unit, as in --columns {example}"),
        Fault::RateDisagrees { stated, found, unit, example } => format!(
            "--fs {stated} disagrees with the time column ({found} Hz, taken to be in {unit}): leave --fs out, or state the \
             column's unit, as in --columns {example}"
        ),
        Fault::Constant { example, .. } => {
            format!("{fault}: choose another column, as in --columns {example}, or record a moving actuator")
        }
        Fault::ImplausibleSpan { example, .. } => {
            format!("{fault}: if that is wrong, state its unit, as in --columns {example}")
        }
        fault => fault.to_string(),
    }
}

/// A log that cannot be brought to the tick.
pub fn prepare(error: &PrepareError) -> String {
    match error {
        PrepareError::TooShort { log, left, need } => format!(
            "{log}: only {left} measured samples are left at the tick, after what --skip-start, --skip-end, --hold-out, \
             decimation and --delay take; at least {need} are needed (is the sample rate right?)"
        ),
        PrepareError::NotAMultiple { log, log_hz, tick_hz } => format!(
            "{log}: {log_hz} Hz is no multiple of the tick rate, {tick_hz} Hz: use --decimate interpolate, or another \
             --tick-us"
        ),
        PrepareError::TooLong { log, ticks, tick_us, most } => format!(
            "{log}: {ticks:.0} ticks of {tick_us} µs, more than {most:.0}: is the sample rate right? Else use a longer \
             --tick-us"
        ),
        PrepareError::NoDisplacement { .. } => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sentence;
    use recordings::log::{ReadOptions, read};
    use std::path::Path;

    /// The sentence about a log of this text, read as stated.
    fn refused(text: &str, columns: &str, sample_rate: Option<f64>) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        std::fs::write(&path, text).unwrap();
        let columns = (!columns.is_empty()).then(|| columns.parse().unwrap());
        let options = ReadOptions { columns, sample_rate, ..ReadOptions::default() };
        sentence(&read(&path, &options).unwrap_err())
    }

    fn table(columns: usize) -> String {
        let row = |k: i32| (0..columns).map(|c| format!("{}", k * (c as i32 + 1))).collect::<Vec<_>>().join(" ");
        (0..20).map(|k| row(k) + "\n").collect()
    }

    #[test]
    fn a_log_without_a_header_is_told_the_options_that_read_it() {
        let three = refused(&table(3), "", None);
        assert!(three.contains("`log.csv --columns time=1:s,voltage=2:V,displacement=3:um`"), "{three}");
        let two = refused(&table(2), "", None);
        assert!(two.contains("`log.csv --columns voltage=1:V,displacement=2:um --fs 2000`"), "{two}");
        let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/picma-p885-1hz/measured.dat");
        let text = sentence(&read(&measured, &ReadOptions::default()).unwrap_err());
        assert!(text.contains("names the 7 columns") && text.contains("`measured.dat --columns "), "{text}");
        let no_time = refused(&table(3), "voltage=1,displacement=2", None);
        assert!(no_time.contains("--fs 2000"), "{no_time}");
    }

    #[test]
    fn a_unit_that_is_not_stated_is_asked_for() {
        let rows: String = (0..20).map(|k| format!("{},{k},{k}\n", f64::from(k) * 1e-3)).collect();
        let text = refused(&("# log\ntime,u_V,y_um\n".to_owned() + &rows), "", None);
        assert!(text.contains(":2: column \"time\" states no unit: state it, as in --columns time=1:s,"), "{text}");
    }
}
