//! A line on which frames come twice, or in another order.

use super::{MEASURED, piezo, text};
use device_link::table::to_record;
use device_link::{Client, WriteConsent};
use emulator::faults::decode;
use emulator::{Direction, EmulatedDevice, Emulator, Fault, FaultyLine, TABLE};
use protocol::{Mode, TableSource, ToHost};
use recordings::log::{ReadOptions, read};

fn device() -> EmulatedDevice {
    Emulator::new().speed(8.0).start().unwrap()
}

fn client(line: &FaultyLine) -> Client {
    Client::connect(&line.address().into()).unwrap().0
}

/// Every request and every reply comes twice.
fn twice(_: Direction, frame: &mut Vec<u8>) {
    if !matches!(decode(frame), Some(ToHost::Samples(_))) {
        frame.extend(frame.clone());
    }
}

/// Batches of samples, of up to 32, that come in order: enough for a log, and less than a second.
const IN_ORDER: u32 = 40;

/// From then on every second batch comes before the one that was before it.
fn swapped() -> impl Fault {
    let (mut batches, mut held) = (0, None::<Vec<u8>>);
    move |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToHost && matches!(decode(frame), Some(ToHost::Samples(_))) {
            batches += 1;
            match held.take() {
                _ if batches <= IN_ORDER => {}
                Some(earlier) => frame.extend(earlier),
                None => held = Some(std::mem::take(frame)),
            }
        }
    }
}

#[test]
fn what_comes_twice_is_done_and_answered_as_if_it_had_come_once() {
    let device = device();
    let line = FaultyLine::to(device.address(), twice).unwrap();
    let mut client = client(&line);
    client.set_mode(Mode::Pause).unwrap();
    client.push(to_record(&TABLE.admit().unwrap()), WriteConsent::default()).unwrap();
    assert_eq!(client.health().unwrap().mode, Mode::Pause);
    assert_eq!(client.restart().unwrap().source, TableSource::Stored);
    assert_eq!(client.pull().unwrap(), to_record(&TABLE.admit().unwrap()));
    client.set_zero(1.0).unwrap();
    let health = client.health().unwrap();
    assert_eq!((health.mode, health.missed, client.damaged()), (Mode::Estimate, 0, 0));
    // Codes that were fed twice give too many samples; where just enough come first, their bits are not the log's.
    let port = format!("tcp:{}", line.address());
    drop(client);
    let pil = piezo().args(["pil", MEASURED, "--limit", "300", "--port", &port]).output().unwrap();
    let said = format!("{}{}", String::from_utf8_lossy(&pil.stdout), String::from_utf8_lossy(&pil.stderr));
    match pil.status.code() {
        Some(2) => assert!(said.contains("the device gave more samples than the"), "{said}"),
        code => assert!(code == Some(1) && said.contains("of 300 ticks differ, by at most"), "{code:?}: {said}"),
    }
    let (mut after, _) = Client::connect(&device.address().into()).unwrap();
    assert_eq!(after.health().unwrap().mode, Mode::Estimate);
}

#[test]
fn samples_in_another_order_end_a_recording_where_they_begin_to() {
    let (device, folder) = (device(), tempfile::tempdir().unwrap());
    let line = FaultyLine::to(device.address(), swapped()).unwrap();
    let (log, port) = (folder.path().join("log.csv"), format!("tcp:{}", line.address()));
    let done = piezo().args(["record", "--out", text(&log), "--seconds", "1", "--port", &port]).output().unwrap();
    let said = String::from_utf8_lossy(&done.stderr);
    assert_eq!(done.status.code(), Some(1), "{said}");
    assert!(said.contains("samples before"), "{said}");
    // A gap would be refused.
    let log = read(&log, &ReadOptions::default()).unwrap();
    assert!((log.sample_period - 5e-4).abs() < 1e-9 && log.voltage.len() < 2_000, "{}", log.voltage.len());
}
