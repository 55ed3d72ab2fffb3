//! Text tables of every dialect, and what is wrong with them.

use super::*;

fn csv(header: &str, period: f64, separator: &str) -> String {
    let row = |t: f64, v: f64, y: f64| [t, v, y].map(|x| x.to_string()).join(separator);
    header.to_owned() + &rows(period, row)
}

#[test]
fn delimiters_comments_line_ends_and_byte_order_mark() {
    let reference = parsed(&csv("t_s,u_V,y_um\n", 0.001, ","), &options("", None)).unwrap();
    assert_eq!(reference.sample_period, 0.001);
    let comma = csv("# rig 3\n% run 1\n\n\"time, s\",u_V,y_um\n", 0.001, " , ");
    for text in [
        csv("time (s);voltage (V);displacement (\u{b5}m)\n", 0.001, ";"),
        csv("t / s\tU / V\ty / \u{3bc}m\n", 0.001, "\t"),
        csv("t_s u_V y_um\n", 0.001, "   "),
        csv("time,voltage,displacement\n(s),(V),(um)\n", 0.001, ","),
        comma.replace('\n', "\r\n"),
        "\u{feff}".to_owned() + &comma + "\n\n",
    ] {
        let log = parsed(&text, &options("", None)).unwrap();
        assert_eq!(log.voltage, reference.voltage, "{text}");
        assert_eq!(log.displacement, reference.displacement);
        assert_eq!(log.sample_period, 0.001);
    }
    let latin1 = csv("t_s;u_V;y (?m)\n", 0.001, ";");
    let latin1: Vec<u8> = latin1.bytes().map(|b| if b == b'?' { 0xb5 } else { b }).collect();
    let (recording, _) = parse(&latin1, &options("", None)).unwrap();
    assert_eq!(recording.displacement, reference.displacement);
}

#[test]
fn units_are_converted() {
    let text = rows(0.5, |t, v, y| format!("{},{t},{},-", y * 1e3, v * 1e3));
    let header = "y_nm,time (ms),Voltage [mV],note\n";
    let log = parsed(&(header.to_owned() + &text), &options("", None)).unwrap();
    assert_eq!(log.sample_period, 0.0005);
    assert!((log.voltage[3] - 20.0 * 0.9_f64.sin()).abs() < 1e-12);
    assert!((log.displacement.unwrap()[3] - 4.0 * 0.7_f64.sin()).abs() < 1e-12);
}

#[test]
fn tables_without_a_header() {
    let stated = options("time=1:ms,voltage=2,displacement=3", None);
    for separator in [" ", "\t", "  \t ", ", ", ";"] {
        let log = parsed(&csv("", 0.5, separator), &stated).unwrap();
        assert_eq!(log.sample_period, 0.0005, "{separator:?}");
    }
    let (place, fault) = refused(&csv("", 0.5, " "), &options("", None));
    assert_eq!(place, Place::Line(1));
    let Fault::NoHeader { example, rate_needed, .. } = fault else { panic!("{fault}") };
    assert_eq!((rate_needed, &*example), (false, "time=1:s,voltage=2:V,displacement=3:um"));
    let two = rows(0.5, |_, v, y| format!("{v} {y}"));
    let (_, fault) = refused(&two, &options("", None));
    assert!(matches!(fault, Fault::NoHeader { count: 2, example, .. } if example == "voltage=1:V,displacement=2:um"));
    let (_, fault) = refused(&two, &options("voltage=1,displacement=3", Some(2e3)));
    assert!(matches!(fault, Fault::NoSuchColumn { .. }), "{fault}");
}

#[test]
fn a_number_of_the_row_is_not_offered_as_a_displacement() {
    let text: String = (0..300).map(|row| format!("{row},{}\n", (f64::from(row) * 0.1).sin())).collect();
    let (_, fault) = refused(&format!("X,CH1\nSequence,Volt\n{text}"), &options("", Some(2e3)));
    let Fault::NoColumn { quantity: Quantity::Displacement, example, .. } = fault else { panic!("{fault}") };
    assert_eq!(example, "voltage=2:V,displacement=<COLUMN>:<UNIT>");
}

/// `text` with `from` replaced by `to` in the row at line 10 of a file whose header is line 2.
fn with_line_10(to: &str) -> String {
    let text = csv("# log\nt_s,u_V,y_um\n", 0.001, ",");
    let mut lines: Vec<&str> = text.lines().collect();
    lines[9] = to;
    lines.join("\n")
}

#[test]
fn bad_fields_are_named_with_their_line() {
    let line_10 = |row: &str| {
        let (place, fault) = refused(&with_line_10(row), &options("", None));
        assert_eq!(place, Place::Line(10), "{fault}");
        fault
    };
    let fault = line_10("0.007,12V,1");
    assert!(fault.to_string().starts_with("the voltage is not a number (\"12V\")"));
    assert!(matches!(line_10("0.007,nan,1"), Fault::NotFinite { .. }));
    assert!(matches!(line_10("0.007,1,-inf"), Fault::NotFinite { .. }));
    assert!(matches!(line_10("0.007,1e999,1"), Fault::NotFinite { .. }));
    assert!(matches!(line_10("0.007,,1"), Fault::MissingField { .. }));
    assert!(matches!(line_10("0.007,1"), Fault::UnevenRow { found: 2, expected: 3 }));
    assert!(matches!(line_10("0.007,1,2,3"), Fault::UnevenRow { .. }));
    assert!(matches!(line_10(""), Fault::EmptyLine));
    assert!(matches!(line_10("# pause"), Fault::UnevenRow { .. }));
}

#[test]
fn decimal_commas_are_read() {
    let point = csv("t_s;u_V;y_um\n", 0.001, ";");
    let reference = parsed(&point, &options("", None)).unwrap();
    let comma = parsed(&point.replace('.', ","), &options("", None)).unwrap();
    assert_eq!((comma.voltage, comma.displacement), (reference.voltage, reference.displacement));
}

#[test]
fn short_empty_and_binary_files() {
    let none = options("", None);
    assert!(matches!(refused("# only this\n\n", &none).1, Fault::Empty));
    let header_only = refused("t_s,u_V,y_um\n", &none).1;
    assert!(matches!(header_only, Fault::FewRows { rows: 0, .. }));
    let short = "t_s,u_V,y_um\n0,1,2\n1,2,3\n";
    assert!(matches!(refused(short, &none).1, Fault::FewRows { rows: 2, .. }));
    for text in ["PK\u{3}\u{4}...", "a\0b", "\u{1b}[0m"] {
        let fault = refused(text, &none).1;
        assert!(matches!(fault, Fault::Binary { .. }), "{fault}");
    }
}

#[test]
fn header_faults_stand_at_the_header() {
    let text = csv("# log\ntime,u_V,y_um\n", 0.001, ",");
    let (place, fault) = refused(&text, &options("", None));
    assert_eq!(place, Place::Line(2));
    let Fault::MissingUnit { column, example, with_sensor: None } = fault else { panic!("{fault}") };
    assert_eq!((&*column, &*example), ("time", "time=1:s,voltage=2:V,displacement=3:um"));
    let stated = options("time=1,voltage=2,displacement=3", None);
    assert_eq!(parsed(&text, &stated).unwrap().sample_period, 0.001);
    let stated = options("time=time:ms,voltage=u,displacement=Y", None);
    assert_eq!(parsed(&text, &stated).unwrap().sample_period, 1e-6);
}

#[test]
fn a_stated_unit_does_not_overrule_what_the_column_measures() {
    let text = csv("time_s,displacement_um,voltage_V\n", 0.001, ",");
    for stated in ["time=1:s,voltage=2:V,displacement=3:um", "voltage=2:mV", "displacement=voltage_V:um"] {
        let (place, fault) = refused(&text, &options(stated, None));
        assert_eq!(place, Place::Line(1), "{stated}");
        assert!(matches!(fault, Fault::WrongDimension { .. }), "{stated}: {fault}");
    }
    assert!(parsed(&text, &options("voltage=3:mV,displacement=2:nm", None)).is_ok());
}

#[test]
fn a_named_column_of_text_is_refused_with_its_text() {
    for (text, value, separators) in [
        (rows(0.001, |t, v, y| format!("{t};50,{v};{y}")), "50,0", true),
        (rows(0.001, |t, _, y| format!("{t};off;{y}")), "off", false),
        (rows(0.001, |t, _, y| format!("{t};1,234.5;{y}")), "1,234.5", true),
        (rows(0.001, |t, _, y| format!("{t};47!523;{y}")).replace('.', ",").replace('!', "."), "47.523", true),
    ] {
        let text = format!("time_s;voltage_mV;displacement_um\n{text}");
        let (place, fault) = refused(&text, &options("", None));
        let Fault::TextColumn { quantity, value: found, remedy, .. } = &fault else { panic!("{value}: {fault}") };
        assert_eq!((*quantity, found.as_str(), place), (Quantity::Voltage, value, Place::Line(1)));
        assert_eq!(remedy.contains("thousands"), separators, "{value}");
    }
}

#[test]
fn errors_targets_and_supplies_are_not_taken_by_their_units() {
    for name in [
        "position error (um)",
        "Sollposition [\u{b5}m]",
        "target position (um)",
        "laser wavelength (nm)",
        "set point (um)",
    ] {
        let text = csv(&format!("t (s),drive voltage (V),{name}\n"), 0.001, ",");
        let (_, fault) = refused(&text, &options("", None));
        let Fault::NoColumn { quantity: Quantity::Displacement, columns, example, .. } = &fault else {
            panic!("{name}: {fault}")
        };
        assert!(columns.contains(name) && example.ends_with("displacement=<COLUMN>:<UNIT>"), "{columns} {example}");
        assert!(parsed(&text, &options("displacement=3", None)).is_ok(), "{name}");
    }
    for name in ["Supply (V)", "voltage setpoint (V)"] {
        let text = csv(&format!("t (s),{name},position (um)\n"), 0.001, ",");
        let (_, fault) = refused(&text, &options("", None));
        assert!(matches!(fault, Fault::NoColumn { quantity: Quantity::Voltage, .. }), "{name}: {fault}");
    }
    let both = rows(0.001, |t, v, y| format!("{t},{v},{},{y}", 9.0 * y));
    let log = parsed(&format!("t (s),U (V),target (um),CH2 (um)\n{both}"), &options("", None)).unwrap();
    assert!((log.displacement.unwrap()[3] - 4.0 * 0.7_f64.sin()).abs() < 1e-12);
}

#[test]
fn a_value_that_is_no_number_is_a_hole_where_that_is_asked_for() {
    let line = |t: f64, v: f64, y: f64| match (t * 1000.0).round() as u32 {
        // Rows 3 and 4 miss one value each, row 10 the sensor's, the last one the voltage.
        3 => format!("{t},,{y}"),
        4 => format!("{t},{v},\u{221e}"),
        10 => format!("{t},{v},NaN"),
        19 => format!("{t},overload,{y}"),
        _ => format!("{t},{v},{y}"),
    };
    let text = "t_s,u_V,y_um\n".to_owned() + &rows(0.001, line);
    let (place, fault) = refused(&text, &options("", None));
    assert!(place == Place::Line(5) && matches!(fault, Fault::MissingField { .. }), "{fault}");
    let with_holes = ReadOptions { holes: true, ..options("", None) };
    let log = parsed(&text, &with_holes).unwrap();
    assert_eq!(log.holes, [3..5, 10..11, 19..20]);
    // As instruments that speak SCPI write an overload, and what is no number in single precision.
    let scpi = text.replace("NaN", "-9.9E+37").replace("overload", "9.9100003e37");
    assert_eq!(parsed(&scpi, &with_holes).unwrap().holes, log.holes);
    let displacement = log.displacement.clone().unwrap();
    let between = |values: &[f64], row: usize| (values[row - 1] + values[row + 1]) / 2.0;
    assert_eq!(log.voltage[3], between(&log.voltage, 3));
    assert_eq!(displacement[10], between(&displacement, 10));
    assert_eq!(log.voltage[19], log.voltage[18], "nothing follows");
    assert_eq!(log.split(0.5).1.holes, [0..1, 9..10], "counted from the part's first row");
    // A time is no hole, nor is most of a recording.
    let (_, fault) = refused(&text.replace("0.006,", ","), &with_holes);
    assert!(matches!(fault, Fault::NotFinite { quantity: Quantity::Time, .. }), "{fault}");
    let (_, fault) = refused(&text.replace(".01,", ".01,NaN"), &with_holes);
    assert!(matches!(fault, Fault::NotANumber { .. } | Fault::Holes { .. }), "{fault}");
    let many = "t_s,u_V,y_um\n".to_owned()
        + &rows(0.001, |t, v, y| if t < 0.0055 { format!("{t},{v},-") } else { line(t, v, y) });
    let (_, fault) = refused(&many, &with_holes);
    assert!(matches!(fault, Fault::Holes { missing: 7, rows: 20, .. }), "{fault}");
}

#[test]
fn samples_that_were_lost_are_holes_where_that_is_asked_for() {
    let long = |lost: &dyn Fn(u32) -> bool| {
        let row = |k: u32| format!("{:.4},{},{}\n", f64::from(k) * 5e-4, k % 40, 0.1 * f64::from(k % 40));
        "t_s,u_V,y_um\n".to_owned() + &(0..400).filter(|k| !lost(*k)).map(row).collect::<String>()
    };
    let lost = long(&|k| (100..104).contains(&k) || k == 300);
    let (place, fault) = refused(&lost, &options("", None));
    assert!(place == Place::Line(102) && matches!(fault, Fault::Gap { missing: 4, gaps: 2, few: true, .. }), "{fault}");
    let with_holes = ReadOptions { holes: true, ..options("", None) };
    let log = parsed(&lost, &with_holes).unwrap();
    assert_eq!((log.holes.clone(), log.voltage.len(), log.sample_period), (vec![100..104, 300..301], 400, 5e-4));
    assert_eq!((log.voltage[99], log.voltage[101], log.voltage[104], log.voltage[399]), (19.0, 21.0, 24.0, 39.0));
    // Another fault behind them is placed at the file's line, and too many of them are no holes.
    let late = lost.replace("0.1750,", "0.1753,");
    let (place, fault) = refused(&late, &with_holes);
    assert!(place == Place::Line(347) && matches!(fault, Fault::IrregularTime { .. }), "{place:?} {fault}");
    let (_, fault) = refused(&long(&|k| (100..150).contains(&k)), &with_holes);
    assert!(matches!(fault, Fault::Gap { missing: 50, few: false, .. }), "{fault}");
}
