//! Writes what the fuzzer begins with into a folder, one folder a target: tables of every model, messages of every
//! kind, the logs of `tests/data`, shortened.

#[path = "../../../estimator-core/tests/library/common/mod.rs"]
#[allow(dead_code, unused_imports, reason = "the core's tests use the rest")]
mod common;

use estimator_core::{Model, Table};
use fuzzed::precision::tables;
use protocol::frame::MAX_FRAME;
use protocol::{Mode, Request, ToDevice, encode};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

/// No more of a log than this is kept, bytes; a binary one is kept whole.
const LONGEST: usize = 3_000;
const LONGEST_BINARY: usize = 40_000;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args_os().nth(1).ok_or("say into which folder")?);
    let write = |target: &str, name: &str, bytes: &[u8]| -> Result<(), Box<dyn Error>> {
        let folder = folder.join(target);
        fs::create_dir_all(&folder)?;
        Ok(fs::write(folder.join(name), bytes)?)
    };
    // Jumps, dwells, numbers that are none, a bias, a start, wishes: some of every event.
    let events: Vec<u8> = (0..=255).cycle().take(600).map(|k: u8| k.wrapping_mul(37)).collect();
    let long = Model::ALL.map(common::models::table_of);
    for (k, table) in long.iter().chain(tables()).enumerate() {
        for (name, table) in [("plain", *table), ("interval", Table { interval: Some(common::interval()), ..*table })] {
            let payload = postcard_bytes(&table)?;
            write("record", &format!("{k}-{name}"), &[&payload[..], &events].concat())?;
        }
    }
    for (model, converter) in
        (0..Model::ALL.len() as u8).flat_map(|model| [0, 1, 7, 0x65, 0xE4].map(|converter| (model, converter)))
    {
        write("precision", &format!("{model}-{converter}"), &[&[model, converter, 80, 40], &events[..]].concat())?;
    }
    for k in 0..8 {
        write("store", &k.to_string(), &events[31 * k..])?;
        write("link", &k.to_string(), &events[37 * k..])?;
    }
    // Longer than a frame may be.
    write("frame", "overlong", &[1; 2_000])?;
    // The power fails between the two pages of an erase.
    let records = [[&pick(0, 3)[..], &[200, 0, 7, 0]].concat(), [&pick(0, 3)[..], &[90, 1, 8, 0]].concat()].concat();
    for after in 0..3 {
        let erase = [&pick(1, 3)[..], &[1, after, 0, 0, 0, 0, 0]].concat();
        write("store", &format!("erase-{after}"), &[&records[..], &erase].concat())?;
    }
    for (table, mode) in [(1, 3), (1, 4), (2, 5), (1, 6)] {
        write("link", &format!("driving-{table}-{mode}"), &driving(table, mode))?;
    }
    for (k, mode) in (0..).map_while(Mode::from_number).enumerate() {
        let message = ToDevice { sequence: 7, request: Request::SetMode(mode) };
        let frame = encode(&message, &mut [0; MAX_FRAME]).ok_or("a request fits a frame")?.to_vec();
        write("frame", &format!("frame-{k}"), &frame)?;
        write("frame", &format!("content-{k}"), &postcard::to_slice(&message, &mut [0; 20])?[..])?;
    }
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
    for folder in ["formats", "instruments", "."] {
        for file in fs::read_dir(data.join(folder))? {
            let path = file?.path();
            let binary = path.extension().is_some_and(|of| of == "mat" || of == "tdms" || of == "gz");
            if path.is_file() && path.extension().is_none_or(|of| of != "md") {
                let mut bytes = fs::read(&path)?;
                bytes.truncate(if binary { LONGEST_BINARY } else { LONGEST });
                let name = path.file_name().ok_or("a file has a name")?.to_string_lossy().into_owned();
                write("log", &name, &[&[0], &bytes[..]].concat())?;
            }
        }
    }
    for file in fs::read_dir(data.join("table/models"))? {
        let path = file?.path();
        let name = path.file_name().ok_or("a file has a name")?.to_string_lossy().into_owned();
        write("table", &name, &fs::read(&path)?)?;
    }
    Ok(())
}

/// A device is given a table that drives, starts with it, follows references, a set-point or a waveform, loses its
/// amplifier, and is asked how it is, in the words of `fuzzed::link`.
fn driving(table: u8, mode: u8) -> Vec<u8> {
    let ask = |which, fields: &[u8]| [&pick(0, 8)[..], &[7], &pick(which, 15), fields].concat();
    let ticks = [&pick(4, 8)[..], &[250, 0]].concat();
    let floats = [5.0f32, 0.5].map(f32::to_le_bytes).concat();
    let load = ask(13, &[&[0, 0][..], &floats, &[40]].concat());
    let play = ask(14, &[&floats[..], &[40, 3, 0, 2, 0]].concat());
    let waveform = if mode == 6 { [load, play].concat() } else { Vec::new() };
    [
        ask(4, &[table, 0, 1, 1]),
        ask(12, &[]),
        ask(6, &[1]),
        ask(9, &[mode]),
        ask(11, &[&[0][..], &floats, &[40, 1, 0]].concat()),
        waveform,
        [&pick(5, 8)[..], &[0, 1, 0, 0x80]].concat(),
        [&ticks[..]; 20].concat(),
        ask(7, &floats[..4]),
        [&pick(5, 8)[..], &[1, 0xF0, 0xFF, 0]].concat(),
        [&ticks[..]; 4].concat(),
        ask(1, &[]),
        ask(12, &[]),
        ask(5, &[1, 1]),
    ]
    .concat()
}

/// What makes an enum of so many variants this one.
fn pick(which: u64, of: u64) -> [u8; 4] {
    ((which << 32).div_ceil(of) as u32).to_le_bytes()
}

fn postcard_bytes(table: &Table) -> Result<Vec<u8>, Box<dyn Error>> {
    let mut buffer = [0; 2 * estimator_core::record::MAX_LENGTH];
    Ok(postcard::to_slice(table, &mut buffer)?.to_vec())
}
