//! A device and a host that asks anything in any order, between noise and frames of others, while the converter reads
//! what it likes: each sound request has its one answer, nothing else has any, the output of a drive never jumps, and a
//! table is stored or it is not.

use crate::asked::{Asked, record};
use crate::device::{Device, live, tables};
use crate::torn_flash::{Chip, Flash, PAGE};
use arbitrary::{Arbitrary, Unstructured};
use embassy_futures::block_on;
use embassy_time::Duration;
use estimator_core::record::checksum;
use estimator_core::sealed::seal;
use estimator_core::{Admitted, Table};
use parameter_store::ParameterStore;
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, FrameError, Identity, Record, Refusal, Reply, Request, Samples, ToDevice, ToHost, encode};
use std::cell::RefCell;
use std::collections::VecDeque;

/// Most steps of an input, so that each is quick.
const STEPS: usize = 100;

#[derive(Debug, Arbitrary)]
enum Step {
    Ask {
        sequence: u8,
        asked: Asked,
    },
    /// A frame of which a byte has changed.
    Damaged {
        asked: Asked,
        at: u16,
        flip: u8,
    },
    /// A frame of another version.
    Foreign {
        version: u8,
    },
    Noise([u8; 5]),
    Ticks {
        count: u8,
        late: bool,
    },
    Converter {
        monitor: Option<u16>,
        setpoint: Option<u16>,
    },
    Button(bool),
    Wait {
        twentieths_s: u8,
    },
}

/// The host's end of the link, with what it knows of the device.
struct Host<'a> {
    tables: &'a [Admitted],
    chip: &'a RefCell<Chip>,
    /// What the device makes of what is sent.
    sent: Deframer,
    /// What has no reply yet; `None` is a frame of another version.
    open: VecDeque<Option<ToDevice>>,
    received: Deframer,
    /// The record that the store should give.
    stored: Option<Record>,
    /// The table in use.
    used: Admitted,
}

/// Bytes as steps; `advance` lets so much time pass, or, where that would be long, less. Returns whether a device has
/// driven its amplifier.
///
/// # Panics
/// A promise is broken.
pub fn check(bytes: &[u8], advance: &dyn Fn(Duration)) -> bool {
    let mut input = Unstructured::new(bytes);
    let tables = tables();
    let chip = Chip::new();
    let mut host = Host {
        tables: &tables,
        chip: &chip,
        sent: Deframer::new(),
        open: VecDeque::new(),
        received: Deframer::new(),
        stored: None,
        used: tables[0],
    };
    let (mut steps, mut driven) = (0, false);
    while steps < STEPS && !input.is_empty() {
        // Until it is reset.
        let used = host.used;
        live(&chip, &used, advance, |device| {
            host.meet(device);
            while steps < STEPS && !input.is_empty() && !device.ended() {
                let Ok(step) = Step::arbitrary(&mut input) else { return };
                steps += 1;
                host.take(device, step);
                driven |= device.drives();
            }
        });
        host.used = host.stored.as_ref().map_or(tables[0], |record| Table::parse(record).expect("it was taken"));
    }
    driven
}

impl Host<'_> {
    /// The device boots with the table that was stored last.
    fn meet(&mut self, device: &mut Device<'_, '_>) {
        self.sent = Deframer::new();
        self.received = Deframer::new();
        self.ask(device, 1, Request::Identify);
    }

    fn take(&mut self, device: &mut Device<'_, '_>, step: Step) {
        match step {
            Step::Ask { sequence, asked } => self.ask(device, sequence.into(), asked.request(self.tables)),
            Step::Damaged { asked, at, flip } => {
                let mut frame = frame(&ToDevice { sequence: 9, request: asked.request(self.tables) });
                let at = usize::from(at) % frame.len();
                frame[at] ^= flip;
                self.send(device, &frame);
            }
            Step::Foreign { version } => {
                let mut content = [&[version][..], &[7; 9]].concat();
                seal(&mut content, 6).expect("there is room for the checksum");
                let mut frame = vec![0; 16];
                let length = cobs::encode(&content, &mut frame);
                self.send(device, &frame[..=length]);
            }
            Step::Noise(bytes) => self.send(device, &bytes),
            Step::Ticks { count, late } => {
                (0..count).for_each(|k| device.tick(late && k == 0));
                self.send(device, &[]);
            }
            Step::Converter { monitor, setpoint } => (device.monitor, device.setpoint) = (monitor, setpoint),
            Step::Button(held) => device.press(held),
            Step::Wait { twentieths_s } => {
                device.wait(Duration::from_millis(50 * u64::from(twentieths_s)));
                self.send(device, &[]);
            }
        }
    }

    fn ask(&mut self, device: &mut Device<'_, '_>, sequence: u16, request: Request) {
        self.send(device, &frame(&ToDevice { sequence, request }));
    }

    /// Sends bytes, and takes all that comes.
    fn send(&mut self, device: &mut Device<'_, '_>, bytes: &[u8]) {
        for &byte in bytes {
            match self.sent.push(byte) {
                Some(Ok(message)) => self.open.push_back(Some(message)),
                Some(Err(FrameError::Version { .. })) => self.open.push_back(None),
                Some(Err(_)) | None => {}
            }
        }
        for byte in device.send(bytes) {
            match self.received.push::<ToHost>(byte) {
                Some(Ok(ToHost::Reply { to, reply })) => self.hear(to, reply),
                Some(Ok(ToHost::Samples(Samples { samples, .. }))) => {
                    assert!(!samples.is_empty() && samples.iter().all(|sample| sample.displacement.is_finite()));
                }
                Some(Err(error)) => panic!("the device sends {error}"),
                None => {}
            }
        }
        // What comes after a request to start again is lost.
        assert!(self.open.is_empty() || device.ended(), "a request has no answer");
        self.open.clear();
    }

    fn hear(&mut self, to: u16, reply: Reply) {
        let message = match self.open.pop_front() {
            Some(Some(message)) => message,
            Some(None) => return assert_eq!((to, reply), (0, Reply::Refused(Refusal::Version))),
            None => panic!("an answer to nothing: {reply:?}"),
        };
        assert_eq!(to, message.sequence);
        match (message.request, reply) {
            (Request::Identify, Reply::Identity(identity)) => self.recognise(&identity),
            (Request::Health, Reply::Health(health)) => {
                let span = self.used.displacement_limits_um.span();
                // What is told and shifted adds up.
                assert!(health.bias_um.is_finite(), "{} of {span}", health.bias_um);
            }
            (Request::Pull, Reply::Table(table)) => assert_eq!(table, record(&self.used)),
            (Request::Feed(codes), Reply::Fed(count)) => assert!(usize::from(count) <= codes.len()),
            (Request::Push { record, .. }, Reply::Done) => self.store(Some(record)),
            (Request::Erase { .. }, Reply::Done) => self.store(None),
            (Request::Push { .. } | Request::Erase { .. }, Reply::Refused(_)) => self.store(self.stored.clone()),
            (
                Request::Forget
                | Request::Stream(_)
                | Request::SetZero { .. }
                | Request::ShiftBias { .. }
                | Request::SetMode(_)
                | Request::Play(_),
                Reply::Done,
            )
            | (Request::Refer { .. }, Reply::Referred { .. })
            | (Request::Load { .. }, Reply::Loaded(_))
            | (Request::Reset, Reply::Resetting { .. })
            | (
                Request::Feed(_)
                | Request::Refer { .. }
                | Request::SetZero { .. }
                | Request::ShiftBias { .. }
                | Request::SetMode(_)
                | Request::Load { .. }
                | Request::Play(_),
                Reply::Refused(_),
            ) => {}
            (request, reply) => panic!("{reply:?} to {request:?}"),
        }
    }

    fn recognise(&self, identity: &Identity) {
        assert_eq!(identity.table_crc, checksum(&record(&self.used)).expect("a record ends with its checksum"));
    }

    /// The store gives this from now on.
    fn store(&mut self, record: Option<Record>) {
        let mut store = ParameterStore::new(Flash(self.chip), 0..2 * PAGE as u32).expect("the pages fit");
        assert_eq!(block_on(store.load()).expect("the flash reads"), record.as_deref());
        self.stored = record;
    }
}

fn frame(message: &ToDevice) -> Vec<u8> {
    encode(message, &mut [0; MAX_FRAME]).expect("a request fits a frame").to_vec()
}
