//! Text of any encoding as a stream of lines.
//!
//! A byte order mark says which; else UTF-16 shows by its zero bytes, UTF-8 by being valid, and what is neither is
//! guessed as a browser does. Only the file's start is looked at.

use std::io::{BufRead, BufReader, Read};

use chardetng::{EncodingDetector, Iso2022JpDetection, Utf8Detection};
use encoding_rs::{Encoding, UTF_8, UTF_16BE, UTF_16LE, WINDOWS_1252};
use encoding_rs_io::DecodeReaderBytesBuilder;

use crate::fault::Fault;

/// How much of a file is looked at for its encoding, bytes.
const LOOKED_AT: u64 = 1 << 16;
/// Longest line, bytes: longer is no table.
const LONGEST: u64 = 1 << 20;

/// The lines of a text.
pub(crate) struct Lines<'a> {
    text: Box<dyn BufRead + 'a>,
    /// What ends a line: a line feed, or of some old programs a carriage return alone.
    end: u8,
    bytes: Vec<u8>,
}

impl<'a> Lines<'a> {
    /// The lines of a stream that has not been read from.
    pub fn new(mut stream: Box<dyn BufRead + 'a>) -> Result<Self, Fault> {
        let mut start = Vec::new();
        stream.by_ref().take(LOOKED_AT).read_to_end(&mut start).map_err(Fault::unreadable)?;
        let encoding = encoding(&start);
        let is_control = |b: &u8| (*b < b' ' && !b"\t\n\r\x0c\x1a".contains(b)) || *b == 0x7f;
        let wide = [UTF_16LE, UTF_16BE].contains(&encoding);
        if !wide && start.iter().any(is_control) {
            return Err(Fault::Binary { what: "binary" });
        }
        let end = if start.contains(&b'\n') || !start.contains(&b'\r') { b'\n' } else { b'\r' };
        let whole = std::io::Cursor::new(start).chain(stream);
        let decoded = DecodeReaderBytesBuilder::new()
            .encoding((encoding != UTF_8).then_some(encoding))
            .bom_override(true)
            .strip_bom(true)
            .utf8_passthru(true)
            .build(whole);
        Ok(Self { text: Box::new(BufReader::with_capacity(1 << 16, decoded)), end, bytes: Vec::new() })
    }

    /// Reads the next line into `line`, without what ends it; whether there was one.
    pub fn next_into(&mut self, line: &mut String) -> Result<bool, Fault> {
        self.bytes.clear();
        let read = self.text.by_ref().take(LONGEST).read_until(self.end, &mut self.bytes).map_err(Fault::unreadable)?;
        if read as u64 == LONGEST {
            return Err(Fault::Binary { what: "text with a line of more than a megabyte" });
        }
        while let [rest @ .., b'\n' | b'\r'] = self.bytes.as_slice() {
            let length = rest.len();
            self.bytes.truncate(length);
        }
        line.clear();
        line.push_str(&String::from_utf8_lossy(&self.bytes));
        Ok(read > 0)
    }
}

/// The encoding of a text that begins with `start`.
fn encoding(start: &[u8]) -> &'static Encoding {
    if let Some((encoding, _)) = Encoding::for_bom(start) {
        return encoding;
    }
    let zeros = |parity: usize| start.iter().skip(parity).step_by(2).filter(|&&b| b == 0).count();
    // Digits and separators have a zero byte each in UTF-16.
    let many = |zeros: usize| start.len() >= 16 && zeros * 4 > start.len();
    match (many(zeros(0)), many(zeros(1))) {
        (true, false) => return UTF_16BE,
        (false, true) => return UTF_16LE,
        _ => {}
    }
    let valid = match std::str::from_utf8(start) {
        Ok(_) => true,
        Err(error) => error.error_len().is_none(),
    };
    if valid {
        return UTF_8;
    }
    // A micro sign before its unit: to a detector that expects words, part of a Chinese character.
    let is_micro = |bytes: &[u8]| {
        matches!(bytes, [b'[' | b'(' | b'_' | b'/' | b' ' | b',' | b';' | b'\t' | b'\n', 0xb5, b'm' | b's' | b'V'])
    };
    if start.windows(3).any(is_micro) {
        return WINDOWS_1252;
    }
    let mut detector = EncodingDetector::new(Iso2022JpDetection::Deny);
    detector.feed(start, true);
    detector.guess(None, Utf8Detection::Deny)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(bytes: &[u8]) -> Vec<String> {
        let mut lines = Lines::new(Box::new(bytes)).unwrap();
        let (mut all, mut line) = (Vec::new(), String::new());
        while lines.next_into(&mut line).unwrap() {
            all.push(line.clone());
        }
        all
    }

    #[test]
    fn every_encoding_gives_the_same_lines() {
        let text = "Zeit [s];Spannung [V];Auslenkung [µm]\r\n0,5;1,5;2,5\r\n";
        let wide = |bytes: fn(u16) -> [u8; 2], bom: bool| -> Vec<u8> {
            let mark = bom.then_some(0xfeff);
            mark.into_iter().chain(text.encode_utf16()).flat_map(bytes).collect()
        };
        let expected: Vec<&str> = text.lines().collect();
        for bytes in [
            text.as_bytes().to_vec(),
            format!("\u{feff}{text}").into_bytes(),
            wide(u16::to_le_bytes, true),
            wide(u16::to_be_bytes, true),
            wide(u16::to_le_bytes, false),
            wide(u16::to_be_bytes, false),
            WINDOWS_1252.encode(text).0.into_owned(),
        ] {
            assert_eq!(lines(&bytes), expected);
        }
    }

    #[test]
    fn every_end_of_a_line_ends_one() {
        for text in ["a\nb\n", "a\r\nb\r\n", "a\rb\r", "a\nb"] {
            assert_eq!(lines(text.as_bytes()), ["a", "b"], "{text:?}");
        }
    }

    #[test]
    fn legacy_encodings_are_guessed() {
        let cases: [(&'static Encoding, &str); 8] = [
            (WINDOWS_1252, "Temps (s),Tension (V),Déplacement (µm)"),
            (WINDOWS_1252, "Time (s),Voltage (V),Position (µm)"),
            (WINDOWS_1252, "t / s\tU / V\ty / µm"),
            (WINDOWS_1252, "t (s),Spannung (V),Größe (µm),Temperatur (°C)"),
            (WINDOWS_1252, "t (s),Spannung (V),Weg (nm),Temperatur (°C)"),
            (encoding_rs::GBK, "时间(s),电压(V),位移(μm)"),
            (encoding_rs::SHIFT_JIS, "時間(s),電圧(V),変位(μm)"),
            (WINDOWS_1252, "tiempo_s;tensión_V;posición_µm"),
        ];
        for (encoding, header) in cases {
            let text = format!("{header}\n0.0,1.5,2.5\n0.1,1.6,2.7\n0.2,1.7,2.9\n");
            assert_eq!(lines(&encoding.encode(&text).0)[0], header, "{}", encoding.name());
        }
    }
}
