//! The client against a device and a line that lose, damage and refuse.

use super::{Client, LinkError};
use crate::WriteConsent;
use emulator::faults::{damage, lose_replies, replies};
use emulator::{Direction, EmulatedDevice, Emulator, Fault, FaultyLine};
use protocol::{Identity, Mode, Record, Refusal, Request, TableSource};
use std::time::{Duration, Instant};

/// Requests that connecting takes: the stream is stopped, and the device identified.
const CONNECTING: u32 = 2;
/// A frame of protocol version 13 with nothing in it, and the checksum that it needs.
const VERSION_13: [u8; 7] = [6, 13, 0x30, 0x93, 0xB3, 0xAC, 0];

fn device() -> EmulatedDevice {
    Emulator::new().speed(8.0).start().unwrap()
}

fn line(device: &EmulatedDevice, fault: impl Fault) -> FaultyLine {
    FaultyLine::to(device.address(), fault).unwrap()
}

fn connect(address: std::net::SocketAddr) -> (Client, Identity) {
    Client::connect(&address.into()).unwrap()
}

/// The record of the table that the device has without a stored one.
fn record() -> Record {
    crate::table::to_record(&emulator::TABLE.admit().unwrap())
}

#[test]
fn lost_and_damaged_replies_are_asked_for_again() {
    let device = device();
    let fault = replies(|number, _, frame| match number {
        0 => frame.clear(),
        _ if number == CONNECTING + 1 => frame.clear(),
        _ if [CONNECTING + 3, CONNECTING + 4].contains(&number) => damage(frame),
        _ => {}
    });
    let line = line(&device, fault);
    let (mut client, identity) = connect(line.address());
    assert_eq!(identity.board, "emulated");
    client.health().unwrap();
    assert_eq!(client.pull().unwrap(), record());
    client.health().unwrap();
    assert_eq!(client.damaged(), 2);
}

#[test]
fn three_lost_replies_are_silence_and_the_next_request_is_answered() {
    let device = device();
    let line = line(&device, lose_replies(CONNECTING..CONNECTING + 3));
    let (mut client, _) = connect(line.address());
    assert!(matches!(client.health(), Err(LinkError::Silent { .. })));
    client.health().unwrap();
}

#[test]
fn what_does_more_the_second_time_is_asked_once() {
    let device = device();
    let line = line(&device, lose_replies([CONNECTING, CONNECTING + 1]));
    let (mut client, _) = connect(line.address());
    assert!(matches!(client.set_zero(1.0), Err(LinkError::Unknown { .. })));
    assert!(matches!(client.shift_bias(1.0), Err(LinkError::Unknown { .. })));
    assert!(client.health().unwrap().bias_age_ticks.is_some(), "it was done, once");
}

#[test]
fn a_bias_that_is_told_is_added_and_its_age_is_known() {
    let device = device();
    let (mut client, _) = connect(device.address());
    assert_eq!(client.health().unwrap().bias_age_ticks, None);
    client.shift_bias(2.0).unwrap();
    client.shift_bias(-0.5).unwrap();
    std::thread::sleep(Duration::from_millis(100));
    let health = client.health().unwrap();
    assert!(health.bias_um == 1.5 && health.bias_age_ticks.is_some(), "{health:?}");
    let Err(LinkError::Refused { refusal, .. }) = client.set_zero(1e6) else { panic!() };
    assert!(matches!(*refusal, Refusal::BeyondSpan { span_um } if span_um > 0.0), "{refusal}");
    for (mode, bias_um) in [(Mode::Estimate, 1.5), (Mode::Pause, 0.0)] {
        client.set_mode(mode).unwrap();
        let health = client.health().unwrap();
        assert_eq!((health.bias_um, health.bias_age_ticks.is_some()), (bias_um, bias_um > 0.0), "{mode:?}");
    }
}

#[test]
fn a_device_that_streams_already_does_not_confuse() {
    let device = device();
    connect(device.address()).0.stream(true).unwrap();
    // The host comes in the middle of a frame.
    let mut whole = false;
    let line = line(&device, move |direction, frame: &mut Vec<u8>| {
        if direction == Direction::ToHost && !std::mem::replace(&mut whole, true) {
            frame.drain(..frame.len() / 2);
        }
    });
    let (mut client, _) = connect(line.address());
    assert_eq!(client.damaged(), 0, "what was cut by opening the port was not damaged under way");
    assert_eq!(client.samples(Duration::from_millis(100)).unwrap(), None, "the stream was stopped");
}

#[test]
fn samples_that_come_between_request_and_reply_are_kept() {
    let device = device();
    let (mut client, _) = connect(device.address());
    client.stream(true).unwrap();
    let (mut next, start) = (None, Instant::now());
    for requests in 0.. {
        // Enough requests, and at least one batch of samples.
        if requests >= 20 && next.is_some() || start.elapsed() > Duration::from_secs(10) {
            break;
        }
        client.health().unwrap();
        while let Some(samples) = client.samples(Duration::ZERO).unwrap() {
            assert!(next.is_none_or(|next| next == samples.first), "{next:?} {}", samples.first);
            next = Some(samples.first + samples.samples.len() as u32);
        }
    }
    assert!(next.is_some());
}

#[test]
fn another_version_is_named_and_which_side_is_older() {
    let device = device();
    let line = line(&device, replies(|_, _, frame| *frame = VERSION_13.to_vec()));
    let error = Client::connect(&line.address().into()).err().unwrap().to_string();
    assert!(error.contains("version 12") && error.contains("this program is older"), "{error}");
}

#[test]
fn refusals_say_why() {
    let device = device();
    let (mut client, _) = connect(device.address());
    let refusal = |error: LinkError| match error {
        LinkError::Refused { refusal, .. } => *refusal,
        other => panic!("{other}"),
    };
    assert_eq!(refusal(client.push(record(), WriteConsent::default()).unwrap_err()), Refusal::Estimating);
    let corrupt = Record::from_slice(&[0; 100]).unwrap();
    assert!(matches!(
        refusal(client.push(corrupt, WriteConsent { while_estimating: true, rewired: false }).unwrap_err()),
        Refusal::Table(_)
    ));
    assert_eq!(refusal(client.request(Request::Feed(Default::default())).unwrap_err()), Refusal::NotPil);
}

#[test]
fn a_pushed_table_is_in_use_after_the_restart() {
    let device = device();
    let (mut client, identity) = connect(device.address());
    assert!(matches!(identity.source, TableSource::Compiled { .. }));
    client.set_mode(Mode::Pause).unwrap();
    client.push(record(), WriteConsent::default()).unwrap();
    assert_eq!(client.restart().unwrap().source, TableSource::Stored);
    assert_eq!(client.health().unwrap().mode, Mode::Estimate);
}
