//! The same log in the shapes of other instruments, languages and programs; each holds what [`rows`] holds.

use super::*;

/// The log of [`rows`] at 1 kHz as fields in an order, times factors, in a notation.
fn table(order: &[usize], factors: [f64; 3], separator: &str, decimal: &str) -> String {
    rows(0.001, |t, v, y| {
        let fields = [t * factors[0], v * factors[1], y * factors[2]];
        let field = |at: &usize| format!("{:.7}", fields[*at]).replace('.', decimal);
        order.iter().map(field).collect::<Vec<_>>().join(separator)
    })
}

/// Checks that a file's bytes are read as the log.
fn same(name: &str, bytes: &[u8], options: &ReadOptions) {
    let (recording, period) = match parse(bytes, options) {
        Ok(read) => read,
        Err(PlacedFault(place, fault)) => panic!("{name}{place}: {fault}"),
    };
    assert!((period - 0.001).abs() < 1e-9, "{name}: {period}");
    let reference = parse(format!("t_s,u_V,y_um\n{}", plain()).as_bytes(), &ReadOptions::default()).unwrap().0;
    let near = |a: &[f64], b: &[f64]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-6);
    assert!(near(&recording.voltage, &reference.voltage), "{name}: {:?}", recording.voltage);
    let (found, expected) = (recording.displacement.unwrap(), reference.displacement.unwrap());
    assert!(near(&found, &expected), "{name}: {found:?}");
}

fn plain() -> String {
    table(&[0, 1, 2], [1.0; 3], ",", ".")
}

const SI: [f64; 3] = [1.0; 3];
const MILLI_NANO: [f64; 3] = [1e3, 1e3, 1e3];

#[test]
fn other_languages_separators_and_encodings() {
    let (tab, semicolon) = (table(&[0, 1, 2], SI, "\t", ","), table(&[0, 1, 2], MILLI_NANO, ";", ","));
    let none = ReadOptions::default();
    for (name, text) in [
        ("French", format!("\u{feff}Temps (s)\tTension (V)\tDéplacement (µm)\n{tab}").replace('\n', "\r\n")),
        ("Spanish", format!("Tiempo [ms];Voltaje [mV];Desplazamiento [nm]\n{semicolon}")),
        ("Italian", format!("Tempo / ms;Tensione / mV;Spostamento / nm\n{semicolon}")),
        ("German", format!("Messung 3;;\nPrüfer: Groß;;\nZeit in s\tPiezospannung in V\tStellweg in µm\n{tab}")),
        ("Chinese", format!("时间（s）,电压（V）,位移（μm）\n{}", plain())),
        ("Japanese", format!("時間(秒),印加電圧(V),変位(μm)\n{}", plain())),
        ("pipes", format!("t_s|u_V|y_um\n{}", table(&[0, 1, 2], SI, " | ", "."))),
        ("quoted numbers", format!("t_s,u_V,y_um\n{}", quoted(&table(&[0, 1, 2], SI, "\",\"", ",")))),
    ] {
        same(name, text.as_bytes(), &none);
    }
    same("old Macintosh", format!("t_s,u_V,y_um\n{}", plain()).replace('\n', "\r").as_bytes(), &none);
    let chinese = format!("时间(s),驱动电压(V),位移(μm)\n{}", plain());
    same("GBK", &encoding_rs::GBK.encode(&chinese).0, &none);
    let japanese = format!("時間(s),電圧(V),変位(μm)\n{}", plain());
    same("Shift JIS", &encoding_rs::SHIFT_JIS.encode(&japanese).0, &none);
    let french = format!("Réglage : été\nTemps (s);Tension (V);Déplacement (µm)\n{}", table(&[0, 1, 2], SI, ";", ","));
    same("Windows", &encoding_rs::WINDOWS_1252.encode(&french).0, &none);
}

#[test]
fn a_name_that_its_own_unit_contradicts_is_none() {
    let none = ReadOptions::default();
    let text = table(&[0, 1, 2], MILLI_NANO, ",", ".");
    same("a letter", format!("x (ms),foo (mV),bar (nm)\n{text}").as_bytes(), &none);
    let text = table(&[0, 0, 1, 2], SI, ",", ".");
    same("a word", format!("t (s),Position (s),u (V),bar (um)\n{text}").as_bytes(), &none);
    // Where nothing else can be it, it is asked for.
    let text = format!("t (s),u (V),Position (ms)\n{}", plain());
    assert!(matches!(parse(text.as_bytes(), &none), Err(PlacedFault(_, Fault::WrongDimension { .. }))));
    // A sensor's volts are no contradiction.
    let text = format!("t (s),u (V),x (mV)\n{}", plain());
    assert!(matches!(parse(text.as_bytes(), &none), Err(PlacedFault(_, Fault::NoSensitivity { .. }))));
}

fn quoted(lines: &str) -> String {
    lines.lines().map(|line| format!("\"{line}\"\n")).collect()
}

#[test]
fn other_orders_headers_and_preambles() {
    let (comma, spaces) = (plain(), table(&[0, 1, 2], SI, "  ", "."));
    let long: String = (0..4000).map(|k| format!("Setting {k},{k},on,\"a, b\"\n")).collect();
    let none = ReadOptions::default();
    let swapped = table(&[2, 0, 1], [1e3, 1.0, 1e3], ",", ".");
    let hidden = rows(0.001, |t, v, y| format!("{t:.7},20.5,run 1,{v:.7},{y:.7},{y:.1}"));
    for (name, text) in [
        ("comment header", format!("# rig 3\n# t_s u_V y_um\n{spaces}")),
        ("percent", format!("% made by hand\n%t [s]  U [V]  y [um]\n{spaces}")),
        ("names with spaces", format!("Time (s)   Drive voltage (V)   Stage position (um)\n{spaces}")),
        ("bracketed names", format!("# Time [s] Piezo voltage [V] Position [um]\n{spaces}")),
        ("semicolon comments", format!("; rig 3\n; 2026-11-01\nt_s,u_V,y_um\n{comma}")),
        ("slashes", format!("// rig 3\nt_s,u_V,y_um\n{comma}")),
        ("order", format!("Position (nm),Time (ms),Drive (V)\n{swapped}")),
        ("units alone", format!("A [s],B [V],C [um]\n{comma}")),
        ("more channels", format!("Time (s),Temp (°C),Note,Amplifier (V),Capacitive gauge (um),Setpoint\n{hidden}")),
        ("units row", format!("Time,Voltage,Position\ns,V,µm\n\n{comma}")),
        ("units above", format!("s,V,um\nTime,Voltage,Position\n{comma}")),
        ("pandas", format!(",time_s,voltage_V,displacement_um\n{}", numbered(&comma))),
        ("trailing commas", format!("t_s,u_V,y_um,\n{}", comma.replace('\n', ",\n"))),
        ("long preamble", format!("{long}\nt_s,u_V,y_um\n{comma}")),
        ("footer", format!("t_s,u_V,y_um\n{comma}\nend of recording\n")),
        ("Rohde", format!("in s,C1 in V,C2 in um\n{comma}")),
    ] {
        same(name, text.as_bytes(), &none);
    }
}

fn numbered(lines: &str) -> String {
    lines.lines().enumerate().map(|(k, line)| format!("{k},{line}\n")).collect()
}

#[test]
fn other_ways_to_say_when() {
    let two = table(&[1, 2], SI, ",", ".");
    let stamped = |stamp: fn(u32) -> String| -> String {
        two.lines().zip(0..).map(|(line, k)| format!("{},{line}\n", stamp(k))).collect()
    };
    let none = ReadOptions::default();
    let midnight = |k: u32| {
        let ms = 86_399_990 + k;
        let (s, ms) = (ms / 1000 % 86_400, ms % 1000);
        format!("{:02}:{:02}:{:02}.{ms:03}", s / 3600, s / 60 % 60, s % 60)
    };
    for (name, text) in [
        ("rate", format!("Sampling rate: 1 kHz\nu_V,y_um\n{two}")),
        ("period", format!("Abtastintervall;1 ms\nu_V,y_um\n{two}")),
        ("ISO", format!("timestamp,u_V,y_um\n{}", stamped(|k| format!("2026-11-01T10:00:00.{k:03}Z")))),
        ("German", format!("Zeitstempel,u_V,y_um\n{}", stamped(|k| format!("31.12.2026 23:59:59.{k:03}")))),
        ("American", format!("Date,u_V,y_um\n{}", stamped(|k| format!("11/1/2026 1:00:00.{k:03} PM")))),
        ("midnight", format!("Time,u_V,y_um\n{}", stamped(midnight))),
        ("two clocks", format!("Date,Time (s),u_V,y_um\n{}", dated(&plain()))),
        ("twice", format!("t_s,u_V,t_s,y_um\n{}", table(&[0, 1, 0, 2], SI, ",", "."))),
        ("MATLAB durations", format!("Time,u_V,y_um\n{}", stamped(|k| format!("{} sec", f64::from(k) / 1000.0)))),
        ("Yokogawa", yokogawa(&two)),
        ("LVM without X", lvm("No", &two, "\t")),
        ("LVM with X", lvm("One", &plain(), "")),
    ] {
        same(name, text.as_bytes(), &none);
    }
}

fn dated(lines: &str) -> String {
    lines.lines().map(|line| format!("2026-11-01 10:00:00,{line}\n")).collect()
}

/// A table whose first column is left for the keys of the settings above it.
fn yokogawa(rows: &str) -> String {
    let shifted: String = rows.lines().map(|line| format!(",{line},\n")).collect();
    format!(
        "\"Header Size\",16\n\"TraceName\",\"Voltage\",\"Gauge\"\n\"BlockSize\",20,20\n\"VUnit\",\"V\",\"um\"\n\
         \"HResolution\",0.001,0.001\n\"HUnit\",\"s\",\"s\"\n\"DisplayBlockSize\",20,20\n\n{shifted}"
    )
}

/// A LabVIEW file with decimal commas.
fn lvm(x_columns: &str, rows: &str, before: &str) -> String {
    let tabbed: String =
        rows.lines().map(|line| format!("{before}{}\n", line.replace(',', "\t").replace('.', ","))).collect();
    format!(
        "LabVIEW Measurement\t\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\t{x_columns}\n***End_of_Header***\t\n\t\n\
         Channels\t2\t\nSamples\t20\t20\nY_Unit_Label\tV\tum\nX_Dimension\tTime\tTime\nX0\t0,0E+0\t0,0E+0\n\
         Delta_X\t0,001\t0,001\n***End_of_Header***\t\t\nX_Value\tPiezo voltage\tSensor\tComment\n{tabbed}"
    )
}

#[test]
fn sensors_in_volts_need_one_option() {
    let volts = table(&[0, 1, 2], [1.0, 1.0, -0.4], ",", ".");
    let sensor = ReadOptions { sensor: Some("-2.5um/V".parse().unwrap()), ..ReadOptions::default() };
    for header in [
        "time_s,voltage_V,sensor_V",
        "t (s),Drive (V),LVDT (V)",
        "Zeit [s];Spannung [V];Wegaufnehmer [V]",
        "time_s,voltage_V,position_V",
        "time_s,voltage_V,CH2 (V)",
        "time_s,voltage_V,position",
    ] {
        let separator = if header.contains(';') { ";" } else { "," };
        let text = format!("{header}\n{}", volts.replace(',', separator));
        same(header, text.as_bytes(), &sensor);
        let fault = parse(text.as_bytes(), &ReadOptions::default()).unwrap_err().1;
        let asked = matches!(fault, Fault::NoSensitivity { .. } | Fault::MissingUnit { .. });
        assert!(asked, "{header}: {fault}");
    }
    let scope = format!("Source,CH1,CH2\nSecond,Volt,Volt\n{volts}");
    let stated = options("voltage=2,displacement=3:-2.5um/V", None);
    same("Siglent", scope.as_bytes(), &stated);
    let fault = parse(scope.as_bytes(), &ReadOptions::default()).unwrap_err().1;
    let Fault::Ambiguous { columns, example, .. } = fault else { panic!("{fault}") };
    assert!(columns.starts_with("1 \"Source (Second)\" 0 … 0.019; 2 \"CH1 (Volt)\" "), "{columns}");
    assert_eq!(example, "time=1:s,voltage=2:V,displacement=3:<N>um/V");
    let length = format!("t_s,u_V,y_um\n{}", plain());
    let fault = parse(length.as_bytes(), &sensor).unwrap_err().1;
    assert!(matches!(fault, Fault::SensitivityOfLength { .. }), "{fault}");
}

#[test]
fn what_is_not_stated_is_taken_from_the_file() {
    let text = format!("t_s,CH1_V,CH2_V,y_um\n{}", rows(0.001, |t, v, y| format!("{t},{},{v},{y}", v / 10.0)));
    assert!(matches!(parse(text.as_bytes(), &ReadOptions::default()), Err(PlacedFault(_, Fault::Ambiguous { .. }))));
    same("partial", text.as_bytes(), &options("voltage=3", None));
    let gcs = format!("# SAMPLE_TIME = 1e-3\n# NAME0 = Voltage\n# NAME1 = Position\n{}", table(&[1, 2], SI, " ", "."));
    same("units", gcs.as_bytes(), &options("voltage=1:V,displacement=2:um", None));
    same("and the rate", gcs.as_bytes(), &options("voltage=1:V,displacement=2:um", Some(1000.0)));
    let wrong = parse(gcs.as_bytes(), &options("voltage=1:V,displacement=2:um", Some(2000.0))).unwrap_err();
    assert!(matches!(wrong, PlacedFault(Place::Line(1), Fault::RateContradicted { .. })), "{}", wrong.1);
    let slow = gcs.replace("1e-3", "500");
    let slow = parse(slow.as_bytes(), &options("voltage=1:V,displacement=2:um", None)).unwrap_err();
    assert!(matches!(slow, PlacedFault(Place::Line(1), Fault::ImplausibleSampleTime { .. })), "{}", slow.1);
    let jumping = rows(0.001, |t, v, y| format!("{},{v},{y}", t + 0.0004 * (900.0 * t).sin()));
    let jumping = format!("t_s,u_V,y_um\n{jumping}");
    let Err(PlacedFault(_, Fault::IrregularTime { example, .. })) = parse(jumping.as_bytes(), &options("", None))
    else {
        panic!("an uneven clock is refused");
    };
    let as_told = options(&example, Some(1000.0));
    assert!(parse(jumping.as_bytes(), &as_told).is_ok(), "{example}");
}
