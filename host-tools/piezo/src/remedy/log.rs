//! What is wrong with a log or with how it is prepared.

use super::paste;
use recordings::log::{Fault, LogError, Quantity, Unit};
use recordings::prepare::PrepareError;
use std::error::Error;
use std::path::Path;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    if let Some(LogError { path, place, fault: found }) = error.downcast_ref() {
        return Some(format!("{}{place}: {}", path.display(), fault(found, path)));
    }
    error.downcast_ref().map(prepare)
}

/// A place for the number that only the user knows.
const RATE: (&str, &str) = ("--fs", "<HZ>");
const SENSOR: (&str, &str) = ("--sensor", "<N>um/V");

fn fault(fault: &Fault, path: &Path) -> String {
    let with = |options: &[(&str, &str)]| paste::with(path, options);
    let line = |example: &str, rate_needed: bool| match rate_needed {
        true => with(&[("--columns", example), RATE]),
        false => with(&[("--columns", example)]),
    };
    let columns = |example: &str| with(&[("--columns", example)]);
    match fault {
        Fault::SampleRate(rate) => {
            format!("{rate} Hz is not a sample rate: state what the recorder was set to, in Hz, by --fs <HZ>")
        }
        Fault::NoHeader { example, rate_needed, .. } => {
            format!(
                "{fault}: say which is which; if the first ones are meant in these units{}",
                line(example, *rate_needed)
            )
        }
        Fault::NoTime { .. } => format!(
            "{fault}: state the sample rate that the recorder was set to, in Hz, or add time=N:s to --columns{}",
            with(&[RATE])
        ),
        Fault::NoColumn { example, with_sensor, rate_needed, .. } => {
            let in_volts = with_sensor.as_ref().map(|example| {
                let sensor = line(example, *rate_needed);
                format!("\nor, if that column is the sensor's output in volts, with its scale for <N>{sensor}")
            });
            let line = line(example, *rate_needed);
            let open = if example.contains('<') { ", with its number and its unit in the brackets' place" } else { "" };
            format!("{fault}: name it; if these are meant{open}{line}{}", in_volts.unwrap_or_default())
        }
        Fault::Ambiguous { example, .. } => {
            let scale =
                if example.contains('<') { " (for <N> the sensor's scale: how many µm a volt is)" } else { "" };
            format!("{fault}: say which is which; if these are meant{scale}{}", columns(example))
        }
        Fault::NoSensitivity { .. } => {
            format!("{fault}: state it, with the sensor's number for <N>{}", with(&[SENSOR]))
        }
        Fault::SensitivityOfLength { .. } => format!("{fault}: leave --sensor out"),
        Fault::RateContradicted { .. } => format!("{fault}: leave --fs out; if the file is wrong, correct it there"),
        Fault::TwoClaims { example, .. } => format!("{fault}: choose one, as in{}", columns(example)),
        Fault::MissingUnit { example, .. } => {
            format!("{fault}: state it; if these units are right{}", columns(example))
        }
        Fault::UnknownUnit { example, .. } => format!("{fault}; or state the unit, as in{}", columns(example)),
        Fault::WrongDimension { quantity: Quantity::Displacement, unit: Unit::Volt | Unit::Millivolt, .. } => {
            format!("{fault}: if it is a displacement sensor's output, state its scale{}", with(&[SENSOR]))
        }
        Fault::WrongDimension { example, .. } => {
            format!("{fault}: correct the header, or say which is which, as in{}", columns(example))
        }
        Fault::NoSuchColumn { wanted, columns } => {
            format!("--columns asks for column {wanted} and the columns are {columns}: choose among these")
        }
        Fault::IrregularTime { example, .. } => format!("{fault}{}", line(example, true)),
        Fault::ImplausiblePeriod { example, .. } => {
            format!("{fault}: if it is another, state it, as in{}", columns(example))
        }
        Fault::RateDisagrees { stated, found, unit, .. } => format!(
            "--fs {stated} disagrees with the time column ({found} Hz, taken to be in {unit}): leave --fs out, or state the \
             column's unit in --columns as well{}",
            with(&[("--fs", "")])
        ),
        Fault::Constant { example, .. } => {
            format!("{fault}: choose another column than in{}\nor record a moving actuator", columns(example))
        }
        Fault::ImplausibleSpan { example, .. } => {
            format!("{fault}: if that is wrong, state its unit, as in{}", columns(example))
        }
        Fault::FewRows { rows: 0, .. } => {
            "holds no rows of numbers: it must be a table of a row a line, with comma, semicolon, tab or spaces between its \
             fields"
                .to_owned()
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
        assert!(three.ends_with(" --columns time=1:s,voltage=2:V,displacement=3:um"), "{three}");
        let two = refused("5 1\n3 2\n".repeat(10).as_str(), "", None);
        assert!(two.ends_with(" --columns voltage=1:V,displacement=2:um --fs '<HZ>'"), "{two}");
        let measured = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/picma-p885-1hz/measured.dat");
        let text = sentence(&read(&measured, &ReadOptions::default()).unwrap_err());
        assert!(text.contains("names the 7 columns") && text.contains(" --columns voltage="), "{text}");
        let no_time = refused(&table(3), "voltage=1,displacement=2", None);
        assert!(no_time.ends_with(" --fs '<HZ>'"), "{no_time}");
    }

    #[test]
    fn a_unit_that_is_not_stated_is_asked_for() {
        let rows: String = (0..20).map(|k| format!("{},{k},{k}\n", f64::from(k) * 1e-3)).collect();
        let text = refused(&("# log\ntime,u_V,y_um\n".to_owned() + &rows), "", None);
        assert!(text.contains(":2: column \"time\" states no unit: state it"), "{text}");
        assert!(text.ends_with(" --columns time=1:s,voltage=2:V,displacement=3:um"), "{text}");
    }

    #[test]
    fn no_remedy_names_a_number_that_it_was_not_given() {
        let gcs = "# SAMPLE_TIME = 5e-3\n# NAME0 = Voltage\n# NAME1 = Position\n";
        let two = "5.5 1.25\n3.5 2.25\n".repeat(10);
        let volts = "t_s,CH1_V,CH2_V\n".to_owned() + &table(3).replace(' ', ",");
        let sensor = "t_s,u_V,sensor_V\n".to_owned() + &table(3).replace(' ', ",");
        for (text, columns, rate) in [
            (&*two, "", None),
            (&(gcs.to_owned() + &two), "", None),
            (&(gcs.to_owned() + &two), "voltage=1:V,displacement=2:um", Some(750.0)),
            (&volts, "", None),
            (&sensor, "", None),
            (&sensor, "displacement=3", None),
        ] {
            let told = refused(text, columns, rate);
            let remedy = told.rsplit_once(": ").map_or(&*told, |(_, remedy)| remedy);
            for option in ["--fs ", "--sensor "] {
                let given = remedy.split(option).skip(1).all(|after| after.starts_with(['<', '\'', 'o']));
                assert!(given, "{told}");
            }
            assert!(!told.contains("2000"), "{told}");
        }
        let contradicted = refused(&(gcs.to_owned() + &two), "voltage=1:V,displacement=2:um", Some(750.0));
        assert!(
            contradicted.contains(":1: a rate of 750 Hz disagrees with the file's \"SAMPLE_TIME\""),
            "{contradicted}"
        );
    }
}
