//! Whole files through [`super::read`], and properties that hold for any bytes.

mod text;
mod variants;

use std::fs;
use std::path::{Path, PathBuf};

use proptest::prelude::*;

use super::*;

pub(super) fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name)
}

pub(super) fn options(columns: &str, sample_rate: Option<f64>) -> ReadOptions {
    ReadOptions {
        columns: (!columns.is_empty()).then(|| columns.parse().unwrap()),
        sample_rate,
        ..ReadOptions::default()
    }
}

/// Twenty rows of `time voltage displacement` at `period`, by the given row format.
pub(super) fn rows(period: f64, row: impl Fn(f64, f64, f64) -> String) -> String {
    (0..20)
        .map(|k| {
            let k = f64::from(k);
            row(k * period, 20.0 * (0.3 * k).sin(), 4.0 * (0.3 * k - 0.2).sin()) + "\n"
        })
        .collect()
}

pub(super) fn parsed(text: &str, options: &ReadOptions) -> Result<Log, LogError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("log.csv");
    fs::write(&path, text).unwrap();
    read(&path, options)
}

/// Place and fault of a refused text.
pub(super) fn refused(text: &str, options: &ReadOptions) -> (Place, Fault) {
    let error = parsed(text, options).unwrap_err();
    (error.place, error.fault)
}

#[test]
fn the_measured_log_reads_the_same_from_table_and_csv() {
    let table = read(&data("picma-p885-1hz/measured.dat"), &options("voltage=1,displacement=5", Some(200.0))).unwrap();
    let csv = read(&data("picma-p885-1hz.csv"), &ReadOptions::default()).unwrap();
    assert_eq!(csv.voltage.len(), 8027);
    assert_eq!(csv.voltage, table.voltage);
    assert_eq!(csv.displacement, table.displacement);
    assert_eq!(csv.sample_period, 0.005);
    assert_eq!(csv.sample_period, table.sample_period);
    assert_eq!(csv.name, "picma-p885-1hz");
    assert_eq!(csv.voltage[1], 1.856539);
    assert_eq!(csv.displacement.unwrap()[8026], -82.099966);
}

#[test]
fn the_table_without_options_says_which_to_add() {
    let path = data("picma-p885-1hz/measured.dat");
    let error = read(&path, &ReadOptions::default()).unwrap_err();
    assert_eq!(error.place, Place::Line(1));
    let text = error.fault.to_string();
    assert!(text.contains("names the 7 columns"), "{text}");
    assert!(matches!(error.fault, Fault::NoHeader { rate_needed: true, .. }));
    let error = read(&path, &options("voltage=1,displacement=5", None)).unwrap_err();
    assert!(matches!(error.fault, Fault::NoTime { .. }));
    let error = read(&path, &options("voltage=1", Some(200.0))).unwrap_err();
    assert!(matches!(error.fault, Fault::NoColumn { .. }), "{error}");
}

#[test]
fn an_estimate_is_known_however_its_column_was_chosen() {
    let estimated = |header: &str, columns: &str| {
        let text = header.to_owned() + &rows(0.001, |t, v, y| format!("{t},{v},{y},{y}"));
        parsed(&text, &options(columns, None)).unwrap().displacement_estimated
    };
    let recorded = "time_s,voltage_V,estimated_displacement_um,n\n";
    assert!(estimated(recorded, ""));
    assert!(estimated(recorded, "time=1,voltage=2,displacement=3"));
    assert!(!estimated("time_s,voltage_V,displacement_um,n\n", ""));
    let both = "time_s,voltage_V,estimated_displacement_um,sensor_um\n";
    assert!(!estimated(both, "time=1,voltage=2,displacement=sensor"), "the sensor's column was chosen");
    assert!(!estimated("", "time=1,voltage=2,displacement=3"), "nothing names it");
}

#[test]
fn hash_and_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sine.10hz.csv");
    let text = rows(0.001, |t, v, y| format!("{t},{v},{y}"));
    fs::write(&path, format!("t_s,u_V,y_um\n{text}")).unwrap();
    let log = read(&path, &ReadOptions::default()).unwrap();
    assert_eq!(log.name, "sine.10hz");
    assert_eq!(log.path, path);

    let log = read(&data("formats/rows.mat"), &ReadOptions::default()).unwrap();
    assert_eq!(log.sha256, "edb73ec81c8b8a9b5cbe893295c1a4342f0dfcd2cda6d0ab7f1026aa9a841e49");
}

#[test]
fn refuses_what_is_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path| read(path, &ReadOptions::default()).unwrap_err();
    assert!(matches!(refused(folder.path()).fault, Fault::Directory));
    let missing = refused(&folder.path().join("missing.csv"));
    assert!(matches!(missing.fault, Fault::NotFound));
    assert!(missing.to_string().contains("missing.csv: no such file"));
    let empty = folder.path().join("empty.csv");
    fs::write(&empty, "").unwrap();
    assert!(matches!(refused(&empty).fault, Fault::Empty));
    #[cfg(unix)]
    assert!(matches!(refused(Path::new("/dev/null")).fault, Fault::NotRegular));
}

#[test]
fn a_log_without_displacement_where_the_caller_allows_it() {
    let text = format!("t_s,u_V\n{}", rows(0.001, |t, v, _| format!("{t},{v}")));
    let needing = |displacement| ReadOptions { displacement, ..ReadOptions::default() };
    assert_eq!(parsed(&text, &needing(Need::Optional)).unwrap().displacement, None);
    // Nor does a sensor that was off spoil the voltage beside it.
    let off = format!("t_s,u_V,y_um\n{}", rows(0.001, |t, v, _| format!("{t},{v},nan")));
    let read = parsed(&off, &needing(Need::Ignored)).unwrap();
    assert_eq!(
        (read.displacement, read.voltage.len()),
        (None, parsed(&text, &needing(Need::Ignored)).unwrap().voltage.len())
    );
    assert!(matches!(refused(&off, &needing(Need::Optional)).1, Fault::NotFinite { .. }));
    for sensors in ["displacement_V", "displacement", "a_um,b_um"] {
        let more = if sensors.contains(',') { ",2" } else { "" };
        let odd = format!("t_s,u_V,{sensors}\n{}", rows(0.001, |t, v, _| format!("{t},{v},1{more}")));
        assert_eq!(parsed(&odd, &needing(Need::Ignored)).unwrap().displacement, None, "{sensors}");
    }
    // No scale is asked for of a sensor that is not read.
    let twice = format!("t_s,a_V,b_V\n{}", rows(0.001, |t, v, _| format!("{t},{v},1")));
    let (_, fault) = refused(&twice, &needing(Need::Ignored));
    assert!(matches!(fault, Fault::Ambiguous { example, .. } if example == "time=1:s,voltage=2:V"));
    let (_, fault) = refused(&rows(0.001, |t, v, _| format!("{t},{v}")), &needing(Need::Ignored));
    assert!(matches!(fault, Fault::NoHeader { example, .. } if example == "time=1:s,voltage=2:V"));
    let (place, fault) = refused(&text, &ReadOptions::default());
    assert_eq!(place, Place::Line(1));
    assert!(matches!(fault, Fault::NoColumn { quantity: Quantity::Displacement, .. }));
}

#[test]
fn stated_rates_must_be_rates() {
    let text = rows(0.001, |_, v, y| format!("{v} {y}"));
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e9, 1e-300] {
        let (_, fault) = refused(&text, &options("voltage=1,displacement=2", Some(rate)));
        assert!(matches!(fault, Fault::SampleRate(_)), "{rate}");
    }
}

fn seeds() -> Vec<(&'static str, Vec<u8>)> {
    let mut seeds: Vec<_> = ["rows", "columns", "single", "big_endian", "two_logs"]
        .into_iter()
        .map(|name| ("log.mat", fs::read(data(&format!("formats/{name}.mat"))).unwrap()))
        .collect();
    let csv = rows(0.0005, |t, v, y| format!("{t:.4},{v},{y}"));
    let header = "# note\ntime (ms),voltage_V,y [\u{b5}m]\n";
    for name in ["labview.tdms", "v73.mat", "struct73.mat", "gzip.csv.gz", "labview.lvm"] {
        seeds.push((name, fs::read(data(&format!("instruments/{name}"))).unwrap()));
    }
    seeds.push(("log.csv", format!("{header}{csv}").into_bytes()));
    let table = rows(0.0005, |t, v, y| format!("{t:e}\t{v} {y}"));
    seeds.push(("log.dat", table.into_bytes()));
    seeds
}

fn any_options() -> impl Strategy<Value = ReadOptions> {
    let columns = prop::sample::select(vec![
        "",
        "time=1,voltage=2:mV,displacement=3",
        "voltage=2,displacement=1",
        "voltage=voltage",
    ]);
    let rate = prop::option::of(prop_oneof![Just(2000.0), any::<f64>()]);
    let needs = prop::sample::select(vec![Need::Required, Need::Optional, Need::Ignored]);
    (columns, rate, needs).prop_map(|(columns, rate, displacement)| ReadOptions {
        displacement,
        voltage_required: true,
        ..options(columns, rate)
    })
}

/// What every accepted log promises.
fn check_promises(result: Result<(Recording, f64), PlacedFault>) {
    if let Ok((recording, period)) = result {
        let rows = recording.voltage.len();
        assert!(rows >= MINIMUM_ROWS);
        assert!(period.is_finite() && period > 0.0);
        assert!(recording.voltage.iter().all(|v| v.is_finite()));
        if let Some(y) = recording.displacement {
            assert!(y.len() == rows && y.iter().all(|y| y.is_finite()));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_bytes_do_not_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..600),
        options in any_options(),
    ) {
        check_promises(parse(&bytes, &options));
        let mut mat = fs::read(data("formats/rows.mat")).unwrap();
        mat.truncate(128);
        mat.extend(bytes);
        check_promises(parse(&mat, &options));
    }

    #[test]
    fn random_tables_do_not_panic(
        text in "[-0-9eE.,;\t \n#nN\"a]{0,400}",
        tail in "(([-+]?[0-9]{1,3}(\\.[0-9]{0,3})?(e[0-9]{1,3})?[ ,]){2}[0-9]{1,3}\n){0,40}",
        options in any_options(),
    ) {
        check_promises(parse(text.as_bytes(), &options));
        check_promises(parse(tail.as_bytes(), &options));
    }

    #[test]
    fn any_time_column_gets_an_answer(
        time in prop::collection::vec(
            prop_oneof![any::<f64>(), -1e3..1e3, (0_i32..40).prop_map(f64::from)], 16..60),
        sorted in any::<bool>(),
    ) {
        let mut time = time;
        if sorted {
            time.sort_by(f64::total_cmp);
        }
        let table: String = time
            .iter()
            .enumerate()
            .map(|(k, t)| format!("{t:e} {k} {}\n", k * k))
            .collect();
        let options = options("time=1,voltage=2,displacement=3", None);
        check_promises(parse(table.as_bytes(), &options));
    }

    #[test]
    fn damaged_files_do_not_panic(
        seed in 0_usize..12,
        damage in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in prop::option::of(any::<prop::sample::Index>()),
        options in any_options(),
    ) {
        let (_, mut bytes) = seeds().swap_remove(seed);
        for (at, value) in damage {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        check_promises(parse(&bytes, &options));
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn written_logs_read_back(
        rate in prop_oneof![(1_u32..1_000_000).prop_map(f64::from), 0.2..1e6],
        samples in prop::collection::vec((-200.0..200.0, -50.0..50.0), 16..200),
    ) {
        let ends = [(-1.0, 2.0), (1.0, 3.0)];
        let (voltage, displacement): (Vec<f64>, Vec<f64>) =
            samples.into_iter().chain(ends).unzip();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.csv");
        let period = 1.0 / rate;
        csv_beside(&path, period, &voltage, &displacement, Displacement::Measured).unwrap().commit().unwrap();
        let log = read(&path, &ReadOptions::default()).unwrap();
        prop_assert_eq!(log.voltage, voltage);
        prop_assert_eq!(log.displacement, Some(displacement));
        if rate.fract() == 0.0 {
            prop_assert_eq!(log.sample_period, period);
        } else {
            prop_assert!((log.sample_period / period - 1.0).abs() < 1e-8);
        }
    }
}
