//! Devices that answer over their sockets.

use emulator::{EmulatedDevice, Emulator, TABLE};
use estimator_core::record::MAX_LENGTH;
use parameter_store::RamFlash;
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, Mode, Record, Reply, Request, TableSource, ToDevice, ToHost, encode};
use std::io::{ErrorKind, Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// A host on a device's line.
struct Host {
    line: TcpStream,
    deframer: Deframer,
    samples: u32,
}

impl Host {
    fn on(device: &EmulatedDevice) -> Self {
        let line = TcpStream::connect(device.address()).unwrap();
        line.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        Self { line, deframer: Deframer::new(), samples: 0 }
    }

    fn ask(&mut self, request: Request) -> Reply {
        let message = ToDevice { sequence: 7, request };
        self.line.write_all(encode(&message, &mut [0; MAX_FRAME]).unwrap()).unwrap();
        self.hear().expect("a reply")
    }

    /// The next reply, if one comes within some seconds; samples are counted.
    fn hear(&mut self) -> Option<Reply> {
        let (start, mut bytes) = (Instant::now(), [0; 4096]);
        while start.elapsed() < Duration::from_secs(10) {
            let length = match self.line.read(&mut bytes) {
                Ok(0) => panic!("the device has hung up"),
                Ok(length) => length,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
                Err(error) => panic!("{error}"),
            };
            for &byte in &bytes[..length] {
                match self.deframer.push(byte) {
                    Some(Ok(ToHost::Reply { reply, .. })) => return Some(reply),
                    Some(Ok(ToHost::Samples(batch))) => self.samples += batch.samples.len() as u32,
                    Some(Err(error)) => panic!("{error}"),
                    None => {}
                }
            }
        }
        None
    }

    fn ticks(&mut self) -> u32 {
        match self.ask(Request::Health) {
            Reply::Health(health) => health.ticks,
            other => panic!("{other:?}"),
        }
    }

    fn source(&mut self) -> TableSource {
        match self.ask(Request::Identify) {
            Reply::Identity(identity) => identity.source,
            other => panic!("{other:?}"),
        }
    }
}

/// The record of the image's table.
fn record() -> Record {
    let mut buffer = [0; MAX_LENGTH];
    let length = TABLE.admit().unwrap().encode(&mut buffer).unwrap();
    Record::from_slice(&buffer[..length]).unwrap()
}

#[test]
fn a_stored_table_is_used_after_the_restart_and_every_device_has_its_own() {
    let (one, other) = (Emulator::new().speed(8.0).start().unwrap(), Emulator::new().speed(8.0).start().unwrap());
    let (mut host, mut neighbour) = (Host::on(&one), Host::on(&other));
    assert_eq!(host.ask(Request::SetMode(Mode::Pause)), Reply::Done);
    let push = Request::Push { record: record(), while_estimating: false, rewired: false };
    assert_eq!(host.ask(push), Reply::Done);
    assert_eq!(host.ask(Request::Reset), Reply::Resetting { in_ms: 0 });
    assert_eq!(host.source(), TableSource::Stored);
    assert!(matches!(neighbour.source(), TableSource::Compiled { .. }), "the other device's flash is its own");
}

#[test]
fn it_ticks_at_its_pace_and_streams_without_a_gap() {
    let device = Emulator::new().speed(4.0).start().unwrap();
    let mut host = Host::on(&device);
    let (start, before) = (Instant::now(), host.ticks());
    assert_eq!(host.ask(Request::Stream(true)), Reply::Done);
    while host.samples < 4_000 {
        host.ticks();
    }
    let (ticks, elapsed) = (host.ticks() - before, start.elapsed().as_secs_f64());
    // A busy machine makes it slower, nothing makes it faster.
    assert!(f64::from(ticks) <= 8_000.0 * elapsed + 200.0, "{ticks} ticks in {elapsed} s");
    match host.ask(Request::Health) {
        Reply::Health(health) => assert_eq!((health.samples_dropped, health.missed), (0, 0)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_host_that_leaves_makes_room_for_the_next_and_a_device_switched_off_is_gone() {
    let device = Emulator::new().start().unwrap();
    for _ in 0..3 {
        assert!(matches!(Host::on(&device).ask(Request::Identify), Reply::Identity(_)));
    }
    let address = device.address();
    device.shutdown();
    assert_eq!(TcpStream::connect(address).err().map(|error| error.kind()), Some(ErrorKind::ConnectionRefused));
}

#[test]
fn a_flash_of_one_page_is_refused() {
    let refused = Emulator::new().flash(RamFlash::new(vec![0xFF; 2048])).start().err().unwrap().to_string();
    assert!(refused.contains("pages do not fit"), "{refused}");
}
