//! Text tables: CSV with a header, and tables of numbers without one.
//!
//! Comma, semicolon, tab or white space between the fields, whichever the first line shows; comment lines (`#` or `%`)
//! may stand before it, and a line of units after the header. Every further line is a row.

use std::borrow::Cow;

use super::channels::{self, Channel, Channels};
use super::delimiter::{Delimiter, is_number, without_brackets};
use super::error::{Place, PlacedFault};
use super::fault::Fault;
use super::label::Label;
use super::number::excerpt;
use super::read_options::ReadOptions;
use super::recording::{Origin, Recording};
use super::units::{Quantity, Unit};

/// Reads a text table; `file` is its name for messages.
pub(super) fn read(bytes: &[u8], file: &str, options: &ReadOptions) -> Result<Recording, PlacedFault> {
    let text = decode(bytes)?;
    let mut lines = text
        .lines()
        .zip(1..)
        .skip_while(|(line, _)| line.trim().is_empty() || line.trim_start().starts_with(['#', '%']))
        .peekable();
    let &(first, first_line) = lines.peek().ok_or(Fault::Empty)?;
    let delimiter = Delimiter::of(first);
    let count = delimiter.split(first).count();

    let labels = if delimiter.split(first).any(is_number) {
        None
    } else {
        lines.next();
        let mut names = delimiter.header(first);
        if let Some((units, _)) = lines.next_if(|(line, _)| delimiter.all_units(line)) {
            for (name, unit) in names.iter_mut().zip(delimiter.split(units)) {
                if !unit.is_empty() {
                    *name = format!("{name} ({})", without_brackets(unit));
                }
            }
        }
        Some(names.iter().map(|n| Label::new(n)).collect::<Vec<_>>())
    };
    let count = labels.as_ref().map_or(count, Vec::len);
    let channels =
        choose(labels.as_deref(), count, file, options).map_err(|fault| fault.at(Place::Line(first_line)))?;

    let first_row = lines.peek().map_or(first_line, |&(_, line)| line);
    let mut rows = Rows::new(&channels);
    let mut fields = Vec::with_capacity(count);
    while let Some((line, number)) = lines.next() {
        let here = |fault: Fault| fault.at(Place::Line(number));
        if line.trim().is_empty() {
            if lines.all(|(line, _)| line.trim().is_empty()) {
                break;
            }
            return Err(here(Fault::EmptyLine));
        }
        fields.clear();
        fields.extend(delimiter.split(line));
        if fields.len() != count {
            return Err(here(Fault::UnevenRow { found: fields.len(), expected: count }));
        }
        rows.push(&fields).map_err(here)?;
    }
    Ok(rows.recording(channels, Origin::Line(first_row)))
}

/// UTF-8 with or without a byte order mark, or else Latin-1, in which older programs write µ.
fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, Fault> {
    let binary = |what| Err(Fault::Binary { what });
    if bytes.starts_with(b"PK\x03\x04") {
        return binary("a workbook or zip archive");
    }
    if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
        return binary("UTF-16 (save it as UTF-8)");
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let is_control = |b: &u8| (*b < b' ' && !b"\t\n\r\x0c\x1a".contains(b)) || *b == 0x7f;
    if bytes.iter().any(is_control) {
        return binary("binary");
    }
    Ok(match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&b| char::from(b)).collect()),
    })
}

/// Columns as stated, else from the header.
fn choose(labels: Option<&[Label]>, count: usize, file: &str, options: &ReadOptions) -> Result<Channels, Fault> {
    let mut channels = match (&options.columns, labels) {
        (Some(columns), labels) => channels::from_columns(columns, count, labels)?,
        (None, Some(labels)) => channels::from_header(labels)?,
        (None, None) => {
            let example = Channels::in_order(count).to_string();
            return Err(Fault::NoHeader { count, file: file.to_owned(), example });
        }
    };
    channels.check_complete(count, labels, file, options)?;
    channels.displacement_estimated = labels
        .zip(channels.displacement)
        .is_some_and(|(labels, displacement)| labels[displacement.index].says_estimated());
    Ok(channels)
}

/// The rows read so far, in s, V and µm.
struct Rows {
    channels: [(Quantity, Option<Channel>); 3],
    values: [Vec<f64>; 3],
}

impl Rows {
    fn new(channels: &Channels) -> Self {
        let all = [Quantity::Time, Quantity::Voltage, Quantity::Displacement];
        Self { channels: all.map(|quantity| (quantity, channels.get(quantity))), values: Default::default() }
    }

    fn push(&mut self, fields: &[&str]) -> Result<(), Fault> {
        for ((quantity, channel), values) in self.channels.iter().zip(&mut self.values) {
            if let Some(Channel { index, unit }) = *channel {
                values.push(value(fields[index], *quantity, unit)?);
            }
        }
        Ok(())
    }

    fn recording(self, channels: Channels, origin: Origin) -> Recording {
        let [time, voltage, displacement] = self.values;
        Recording {
            time: channels.time.map(|_| time),
            voltage,
            displacement: channels.displacement.map(|_| displacement),
            channels,
            origin,
        }
    }
}

fn value(field: &str, quantity: Quantity, unit: Unit) -> Result<f64, Fault> {
    if field.is_empty() {
        return Err(Fault::MissingField { quantity });
    }
    let Ok(written) = field.parse::<f64>() else {
        let decimal_comma = field.contains(',') && is_number(&field.replace(',', "."));
        return Err(Fault::NotANumber {
            quantity,
            value: excerpt(field),
            remedy: if decimal_comma {
                "write a decimal point instead of the comma"
            } else {
                "correct the value, or delete the rows before or after it"
            },
        });
    };
    let value = unit.to_base(written);
    if !value.is_finite() {
        return Err(Fault::NotFinite { quantity, value: excerpt(field) });
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::super::tests::{options, parsed, refused, rows};
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
        let log = read(&latin1, "a.csv", &options("", None)).unwrap();
        assert_eq!(Some(log.displacement), Some(reference.displacement));
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
        let Fault::NoHeader { file, example, .. } = fault else { panic!("{fault}") };
        assert_eq!((&*file, &*example), ("log.csv", "time=1:s,voltage=2:V,displacement=3:um"));
        let two = rows(0.5, |_, v, y| format!("{v} {y}"));
        let (_, fault) = refused(&two, &options("", None));
        assert!(
            matches!(fault, Fault::NoHeader { count: 2, example, .. } if example == "voltage=1:V,displacement=2:um")
        );
        let (_, fault) = refused(&two, &options("voltage=1,displacement=3", Some(2e3)));
        assert!(matches!(fault, Fault::NoSuchColumn { .. }), "{fault}");
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
    fn decimal_commas_are_named() {
        let text = csv("t_s;u_V;y_um\n", 0.001, ";").replace('.', ",");
        let (place, fault) = refused(&text, &options("", None));
        assert_eq!(place, Place::Line(2));
        assert!(fault.to_string().contains("decimal point"), "{fault}");
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
        let utf16 = read(b"\xff\xfet\0_\0", "a.csv", &none).unwrap_err();
        assert!(utf16.1.to_string().contains("UTF-16"));
    }

    #[test]
    fn header_faults_stand_at_the_header() {
        let text = csv("# log\ntime,u_V,y_um\n", 0.001, ",");
        let (place, fault) = refused(&text, &options("", None));
        assert_eq!(place, Place::Line(2));
        let Fault::MissingUnit { column, example } = fault else { panic!("{fault}") };
        assert_eq!((&*column, &*example), ("time", "time=1:s,voltage=2:V,displacement=3:um"));
        let stated = options("time=1,voltage=2,displacement=3", None);
        assert_eq!(parsed(&text, &stated).unwrap().sample_period, 0.001);
        let stated = options("time=time:ms,voltage=u,displacement=Y", None);
        assert_eq!(parsed(&text, &stated).unwrap().sample_period, 1e-6);
    }
}
