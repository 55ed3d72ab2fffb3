//! What becomes of a write when the device estimates, refuses, or falls silent.

use super::*;
use crate::port::PortError;
use crate::table::to_record;
use crate::told;
use crate::{Address, Client, table};
use embassy_futures::block_on;
use embedded_storage_async::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};
use emulator::faults::lose_replies;
use emulator::{Emulator, FaultyLine, TABLE};
use estimator_core::{DriveCalibration, DriveLimits};
use parameter_store::{MAX_RECORD, ParameterStore, RamFlash};
use protocol::{Mode, Refusal, TableSource};
use std::io::ErrorKind;
use std::net::SocketAddr;
use std::ops::Range;

const CAREFUL: Writing = Writing { while_estimating: false, pause: false, reset: false, rewired: false };

const LIMITS: DriveLimits =
    DriveLimits { range_v: estimator_core::Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };

fn erased() -> RamFlash<Vec<u8>> {
    RamFlash::new(vec![0xFF; 4096])
}

/// Pushes the device's own table; returns what the device then does, and where its table comes from after a restart.
fn push(
    options: Writing,
    flash: impl NorFlash + Send + 'static,
) -> (Result<Option<Identity>, WriteError>, TableSource, Mode) {
    let device = Emulator::new().flash(flash).speed(8.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let record = to_record(&TABLE.admit().unwrap());
    let done = options.write(&mut client, |client, consent| client.push(record.clone(), consent));
    let mode = client.health().unwrap().mode;
    (done, client.restart().unwrap().source, mode)
}

/// Flash that can be read and no longer written: not at all, or not at these places in its pages.
struct Worn(RamFlash<Vec<u8>>, Option<Range<u32>>);

impl ErrorType for Worn {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Worn {
    const READ_SIZE: usize = RamFlash::<Vec<u8>>::READ_SIZE;

    async fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        self.0.read(offset, bytes).await.map_err(|_| NorFlashErrorKind::Other)
    }

    fn capacity(&self) -> usize {
        self.0.capacity()
    }
}

impl NorFlash for Worn {
    const WRITE_SIZE: usize = RamFlash::<Vec<u8>>::WRITE_SIZE;
    const ERASE_SIZE: usize = RamFlash::<Vec<u8>>::ERASE_SIZE;

    async fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        if self.1.is_none() {
            return Err(NorFlashErrorKind::Other);
        }
        self.0.erase(from, to).await.map_err(|_| NorFlashErrorKind::Other)
    }

    async fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        if self.1.as_ref().is_none_or(|worn| worn.contains(&(offset % Self::ERASE_SIZE as u32))) {
            return Err(NorFlashErrorKind::Other);
        }
        self.0.write(offset, bytes).await.map_err(|_| NorFlashErrorKind::Other)
    }
}

#[test]
fn a_device_that_estimates_is_left_alone_unless_asked() {
    let (done, source, mode) = push(CAREFUL, erased());
    assert!(matches!(done.unwrap_err(), WriteError::Estimating));
    assert!(source != TableSource::Stored && mode == Mode::Estimate);
    let asked = [
        Writing { pause: true, ..CAREFUL },
        Writing { while_estimating: true, ..CAREFUL },
        Writing { reset: true, ..CAREFUL },
    ];
    for options in asked {
        let (done, source, mode) = push(options, erased());
        assert_eq!(done.unwrap().is_some(), options.reset);
        assert!(source == TableSource::Stored && mode == Mode::Estimate, "{options:?}: {source:?} {mode:?}");
    }
}

#[test]
fn what_would_be_refused_is_known_before() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let drive = DriveCalibration { gain_codes_per_v: 100.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
    let driving = Table { drive: Some(drive), ..TABLE };
    let mut refused = |writing: Writing, table| {
        let refusals = writing.refusals(&mut client, table).unwrap();
        refusals.iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
    };
    assert!(refused(CAREFUL, Some(&TABLE)).contains("is estimating"));
    let reset = Writing { reset: true, ..CAREFUL };
    assert_eq!(refused(reset, Some(&TABLE)), "");
    assert_eq!(refused(reset, None), "");
    assert!(refused(reset, Some(&driving)).contains("the DAC"));
    assert_eq!(refused(Writing { rewired: true, ..reset }, Some(&driving)), "");
}

/// A pause would cost it its zero.
#[test]
fn what_is_refused_is_so_before_the_device_is_paused() {
    let device = Emulator::new().speed(8.0).start().unwrap();
    let (mut client, _) = Client::connect(&device.address().into()).unwrap();
    let drive = DriveCalibration { gain_codes_per_v: 100.0, offset_code: 0.0, limits: LIMITS, setpoint: None };
    let driving = to_record(&Table { drive: Some(drive), ..TABLE }.admit().unwrap());
    told::zero(&mut client, 1.0).unwrap();
    for options in [Writing { pause: true, ..CAREFUL }, Writing { reset: true, ..CAREFUL }] {
        let done = options.write(&mut client, |client, consent| client.push(driving.clone(), consent));
        assert!(matches!(done, Err(WriteError::Link(LinkError::Refused { .. }))), "{done:?}");
        assert!(client.health().unwrap().bias_age_ticks.is_some(), "{options:?}");
    }
}

#[test]
fn where_what_is_stored_is_damaged_nothing_is_written_before_the_dac_is_unplugged() {
    let device = Emulator::new().flash(RamFlash::new(vec![0; 4096])).speed(8.0).start().unwrap();
    let (mut client, identity) = Client::connect(&device.address().into()).unwrap();
    let TableSource::Compiled { reason } = identity.source else { panic!("{:?}", identity.source) };
    assert!(reason.contains("damaged"), "{reason}");
    let reset = Writing { reset: true, ..CAREFUL };
    for table in [Some(&TABLE), None] {
        let refusals = reset.refusals(&mut client, table).unwrap();
        assert!(matches!(&refusals[..], [WriteError::Link(LinkError::Refused { .. })]), "{refusals:?}");
        assert!(Writing { rewired: true, ..reset }.refusals(&mut client, table).unwrap().is_empty());
    }
    let record = to_record(&TABLE.admit().unwrap());
    let push = |client: &mut Client, consent| client.push(record.clone(), consent);
    assert!(reset.write(&mut client, push).unwrap_err().to_string().contains("may change"));
    let written = Writing { rewired: true, ..reset }.write(&mut client, push).unwrap();
    assert_eq!(written.unwrap().source, TableSource::Stored);
}

#[test]
fn a_push_that_fails_lets_the_device_go_on() {
    let (done, source, mode) = push(Writing { pause: true, reset: true, ..CAREFUL }, Worn(erased(), None));
    let complaint = done.unwrap_err().to_string();
    assert!(complaint.contains("flash reports an error"), "{complaint}");
    assert!(source != TableSource::Stored && mode == Mode::Estimate);
}

#[test]
fn a_table_that_is_stored_though_the_one_before_could_not_be_marked_is_said_to_be() {
    let mut memory = vec![0xFF; 4096];
    let other = Table { amplifier_slew_v_per_s: Some(250.0), ..TABLE };
    let mut store = ParameterStore::new(RamFlash::new(&mut memory), 0..4096).unwrap();
    block_on(store.store(&to_record(&other.admit().unwrap()))).unwrap();
    // Behind the longest record.
    let flash = Worn(RamFlash::new(memory), Some(MAX_RECORD as u32 + 12..2048));
    let (done, source, mode) = push(Writing { reset: true, ..CAREFUL }, flash);
    let complaint = done.unwrap_err().to_string();
    assert!(complaint.contains("the table is stored, but") && complaint.ends_with(WRITTEN), "{complaint}");
    assert!(source == TableSource::Stored && mode == Mode::Estimate, "{source:?} {mode:?}");
}

#[test]
fn whether_it_is_stored_is_said_as_far_as_it_is_known() {
    // Connecting takes two replies, the refusal of a device that estimates one, the pause one, then the write.
    for (options, from, says) in [
        (Writing { pause: true, ..CAREFUL }, 2, Some(UNSURE)),
        (Writing { pause: true, ..CAREFUL }, 3, None),
        (Writing { pause: true, ..CAREFUL }, 4, Some(UNSURE)),
        (Writing { pause: true, ..CAREFUL }, 5, Some(WRITTEN)),
        (Writing { reset: true, ..CAREFUL }, 5, Some(RESTARTING)),
    ] {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let line = FaultyLine::to(device.address(), lose_replies(from..from + 20)).unwrap();
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        let record = to_record(&TABLE.admit().unwrap());
        let done = options.write(&mut client, |client, consent| client.push(record.clone(), consent));
        let complaint = done.unwrap_err().to_string();
        for known in [UNSURE, WRITTEN, RESTARTING] {
            assert_eq!(complaint.contains(known), says == Some(known), "{from}: {complaint}");
        }
    }
}

#[test]
fn whatever_goes_wrong_what_is_known_is_a_sentence_of_its_own() {
    let port = || Address::from(SocketAddr::from(([127, 0, 0, 1], 1)));
    for (error, ends) in [
        (LinkError::Port(PortError::Busy { port: "COM3".to_owned() }), "a monitor) first. "),
        (LinkError::Broken { port: port(), error: ErrorKind::UnexpectedEof.into() }, "the emulator running? "),
        (LinkError::Silent { port: port() }, "connected to it? "),
        (LinkError::Version { port: port(), found: 0 }, "the firmware is older. "),
        (LinkError::Unknown { port: port() }, "whether it was done. "),
        (LinkError::Refused { port: port(), refusal: Box::new(Refusal::NoDrive) }, ". "),
        (LinkError::Confused { port: port() }, "from the same sources. "),
    ] {
        let said = WriteError::Unsure(error).to_string();
        let wrong = said.strip_suffix(UNSURE).unwrap();
        assert!(wrong.ends_with(ends) && !wrong.ends_with(".. "), "{said}");
    }
}

#[test]
fn a_device_that_does_not_answer_is_not_said_to_lack_a_table() {
    let device = Emulator::new().start().unwrap();
    let line = FaultyLine::to(device.address(), lose_replies(2..5)).unwrap();
    let (mut client, _) = Client::connect(&line.address().into()).unwrap();
    let complaint = table::running(&mut client).unwrap_err().to_string();
    assert!(complaint.contains("no answer") && !complaint.contains("no table"), "{complaint}");
}
