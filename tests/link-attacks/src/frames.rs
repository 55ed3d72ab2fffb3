//! Frames that end in their middle, come twice, or in another order.

use std::{
    io::{ErrorKind, Read, Write},
    net::TcpStream,
    time::{Duration, Instant},
};

use device_link::{Client, WriteConsent};
use emulator::{Direction, Fault, FaultyLine, faults::decode};
use protocol::{Deframer, Mode, Reply, Request, TableSource, ToDevice, ToHost, encode, frame::MAX_FRAME};
use recordings::log::{ReadOptions, read};

use crate::{Attacked, IN_TIME, table_of};

/// Batches of samples, of up to 32, that come in order: enough for a log, and less than a second.
const IN_ORDER: u32 = 40;
/// How many bytes further into the frame each host leaves than the one before.
const STRIDE: usize = 7;

/// Every request and every reply comes twice.
fn twice(_: Direction, frame: &mut Vec<u8>) {
    if !matches!(decode(frame), Some(ToHost::Samples(_))) {
        frame.extend(frame.clone());
    }
}

/// From [`IN_ORDER`] on every second batch comes before the one that was before it.
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

/// A host that puts bytes on the line itself.
struct Host {
    line: TcpStream,
    deframer: Deframer,
}

impl Host {
    /// As every host does, it begins with a delimiter, since it cannot know what was on the line.
    fn on(device: std::net::SocketAddr) -> Self {
        let mut line = TcpStream::connect(device).unwrap();
        line.set_read_timeout(Some(Duration::from_millis(50))).unwrap();
        line.write_all(&[0]).unwrap();
        Self { line, deframer: Deframer::new() }
    }

    fn ask(&mut self, request: Request) -> Reply {
        let mut buffer = [0; MAX_FRAME];
        self.line.write_all(encode(&ToDevice { sequence: 9, request }, &mut buffer).unwrap()).unwrap();
        let (start, mut bytes) = (Instant::now(), [0; 256]);
        loop {
            let length = match self.line.read(&mut bytes) {
                Ok(0) => panic!("the device has closed the line"),
                Ok(length) => length,
                Err(error) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => 0,
                Err(error) => panic!("the line: {error}"),
            };
            for message in bytes[..length].iter().filter_map(|&byte| self.deframer.push::<ToHost>(byte)) {
                if let ToHost::Reply { to: 9, reply } = message.expect("whole frames") {
                    return reply;
                }
            }
            assert!(start.elapsed() < IN_TIME, "no reply");
        }
    }
}

impl Attacked<'_> {
    /// Hosts leave after some bytes of a push, each with more of them: it costs that frame, and the next
    /// host is answered.
    ///
    /// # Panics
    /// It costs more, or something is stored.
    pub fn hosts_leave_in_mid_frame(&self) {
        let device = (self.power_on)();
        let push = Request::Push { record: table_of(device.address()), while_estimating: true, rewired: true };
        let mut buffer = [0; MAX_FRAME];
        let frame = encode(&ToDevice { sequence: 7, request: push }, &mut buffer).unwrap().to_vec();
        let mut refused = 0;
        // Without its delimiter alone it would be whole: the next host's ends it.
        for sent in (1..frame.len() - 1).step_by(STRIDE) {
            let mut leaving = TcpStream::connect(device.address()).unwrap();
            leaving.write_all(&frame[..sent]).unwrap();
            drop(leaving);
            refused += 1;
            match Host::on(device.address()).ask(Request::Health) {
                Reply::Health(health) => {
                    assert_eq!((health.frames_refused, health.missed), (refused, 0), "{sent} bytes");
                }
                other => panic!("{other:?}"),
            }
        }
        let (mut last, _) = Client::connect(&device.address().into()).unwrap();
        assert!(matches!(last.restart().unwrap().source, TableSource::Compiled { .. }), "something was stored");
    }

    /// Every frame comes twice: it is done and answered as if it had come once.
    ///
    /// # Panics
    /// It is not.
    pub fn frames_come_twice(&self) {
        let device = (self.power_on)();
        let line = FaultyLine::to(device.address(), twice).unwrap();
        let table = table_of(device.address());
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        client.set_mode(Mode::Pause).unwrap();
        client.push(table.clone(), WriteConsent::default()).unwrap();
        assert_eq!(client.health().unwrap().mode, Mode::Pause);
        assert_eq!(client.restart().unwrap().source, TableSource::Stored);
        assert!(client.pull().unwrap() == table, "another table");
        client.set_zero(1.0).unwrap();
        let health = client.health().unwrap();
        assert_eq!((health.mode, health.missed, client.damaged()), (Mode::Estimate, 0, 0));
        drop(client);
        let mut pil = self.host(&["pil", "LOG", "--limit", "300"], self.folder, line.address());
        let pil = pil.stdout(std::process::Stdio::piped()).output().unwrap();
        let said = format!("{}{}", String::from_utf8_lossy(&pil.stdout), String::from_utf8_lossy(&pil.stderr));
        // Codes that were fed twice give too many samples; where just enough come first, their bits are not the log's.
        match pil.status.code() {
            Some(2) => assert!(said.contains("the device gave more samples than the"), "{said}"),
            code => assert!(code == Some(1) && said.contains("of 300 ticks differ, by at most"), "{code:?}: {said}"),
        }
        let (mut after, _) = Client::connect(&device.address().into()).unwrap();
        assert_eq!(after.health().unwrap().mode, Mode::Estimate);
    }

    /// Samples come in another order: a recording ends where they begin to.
    ///
    /// # Panics
    /// It does not, or says something else.
    pub fn samples_come_in_another_order(&self) {
        let (device, folder) = ((self.power_on)(), tempfile::tempdir().unwrap());
        let line = FaultyLine::to(device.address(), swapped()).unwrap();
        let record = ["record", "--out", "FOLDER/log.csv", "--seconds", "1"];
        let done = self.host(&record, folder.path(), line.address()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        assert_eq!(done.status.code(), Some(1), "{said}");
        assert!(said.contains("samples before"), "{said}");
        // A gap would be refused.
        let log = read(&folder.path().join("log.csv"), &ReadOptions::default()).unwrap();
        assert!((log.sample_period - 5e-4).abs() < 1e-9 && log.voltage.len() < 2_000, "{}", log.voltage.len());
    }
}
