//! What is behind the socket: requests in, replies and samples out.

use super::Manners;
use crate::table::to_record;
use estimator_core::record::checksum;
use estimator_core::{AdcCode, Admitted, DriveCalibration, DriveLimits, Estimator, Inverse, Range, Table};
use protocol::frame::MAX_FRAME;
use protocol::sample::MAX_BATCH;
use protocol::{
    Deframer, Faults, Health, Identity, Mode, Record, Refusal, Reply, Request, ResetCause, Sample, Samples,
    TableSource, ToDevice, ToHost, encode, text,
};
use std::collections::VecDeque;
use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;

/// A frame of protocol version 3 with nothing in it, and the checksum that it needs.
const VERSION_3: [u8; 7] = [6, 3, 0x37, 0xBE, 0x0B, 0x4B, 0];

/// The table of its firmware image.
pub fn compiled() -> Admitted {
    let bytes = include_bytes!("../../../../tests/data/table/table.bin");
    Table::parse(bytes).unwrap()
}

/// The same, with its DAC driving an amplifier of 0 … 4 V.
pub fn driving() -> Admitted {
    let limits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
    let drive = DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits };
    Table { drive: Some(drive), ..*compiled() }.admit().unwrap()
}

fn inverse(table: &Admitted) -> Option<Inverse<f32>> {
    Some(table.inverse(&table.drive?.limits).unwrap())
}

/// The device behind the socket.
pub struct State {
    manners: Manners,
    requests: u32,
    feeds: u32,
    stored: Option<Record>,
    table: Admitted,
    estimator: Estimator<f32>,
    mode: Mode,
    streaming: bool,
    number: u32,
    fed: VecDeque<u16>,
    inverse: Option<Inverse<f32>>,
    references: VecDeque<f32>,
    last: Option<f32>,
    tail: u32,
    going: bool,
}

impl State {
    pub fn new(manners: Manners) -> Self {
        let table = if manners.drives { driving() } else { compiled() };
        Self {
            streaming: manners.streams,
            manners,
            requests: 0,
            feeds: 0,
            stored: None,
            table,
            estimator: Estimator::new(&table),
            mode: Mode::Estimate,
            number: 0,
            fed: VecDeque::new(),
            inverse: inverse(&table),
            references: VecDeque::new(),
            last: None,
            tail: 0,
            going: false,
        }
    }

    /// Answers one host until it leaves, or the test ends.
    pub fn serve(&mut self, mut stream: TcpStream, stop: &AtomicBool) {
        stream.set_nonblocking(false).unwrap();
        stream.set_read_timeout(Some(Duration::from_millis(2))).unwrap();
        if self.streaming {
            stream.write_all(&[17, 3, 99, 0]).unwrap();
        }
        let mut deframer = Deframer::new();
        let mut bytes = [0; 512];
        while !stop.load(Relaxed) {
            let length = match stream.read(&mut bytes) {
                Ok(0) => return,
                Ok(length) => length,
                Err(_) => 0,
            };
            for &byte in &bytes[..length] {
                if let Some(Ok(ToDevice { sequence, request })) = deframer.push(byte) {
                    let reply = self.reply(sequence, request);
                    let _ = stream.write_all(&reply);
                }
            }
            for _ in 0..2 {
                let samples = self.samples();
                let _ = stream.write_all(&samples);
            }
        }
    }

    /// The bytes that go back.
    fn reply(&mut self, to: u16, request: Request) -> Vec<u8> {
        let number = self.requests;
        self.requests += 1;
        let mut lost = self.manners.lose_replies.contains(&number);
        if matches!(request, Request::Feed(_)) {
            lost |= self.manners.lose_replies_to_feed.contains(&self.feeds);
            self.feeds += 1;
        }
        let reply = self.answer(request);
        if self.manners.newer {
            return VERSION_3.to_vec();
        }
        let mut frame = framed(&ToHost::Reply { to, reply });
        if lost {
            frame.clear();
        } else if self.manners.damage_replies.contains(&number) {
            frame[2] = if frame[2] == 1 { 2 } else { 1 };
        }
        frame
    }

    fn answer(&mut self, request: Request) -> Reply {
        match request {
            Request::Identify => return Reply::Identity(self.identity()),
            Request::Health => return Reply::Health(self.health()),
            Request::Pull => return Reply::Table(to_record(&self.table)),
            Request::Forget | Request::SetZero => {}
            Request::Push { record, while_estimating, .. } => {
                if let Err(error) = Table::parse(&record) {
                    return Reply::Refused(Refusal::Table(text(error)));
                }
                match self.refusal(while_estimating) {
                    None => self.stored = Some(record),
                    Some(refusal) => return Reply::Refused(refusal),
                }
            }
            Request::Erase { while_estimating, .. } => match self.refusal(while_estimating) {
                None => self.stored = None,
                Some(refusal) => return Reply::Refused(refusal),
            },
            Request::Stream(on) => self.streaming = on,
            Request::SetMode(Mode::Follow) if self.inverse.is_none() => return Reply::Refused(Refusal::NoDrive),
            Request::SetMode(mode) => self.enter(mode),
            Request::Feed(_) if self.mode != Mode::Pil => return Reply::Refused(Refusal::NotPil),
            Request::Feed(codes) => {
                let room = codes.len().min(255 - self.fed.len());
                self.fed.extend(&codes[..room]);
                return Reply::Fed(room as u16);
            }
            Request::Refer { .. } if self.mode != Mode::Follow => return Reply::Refused(Refusal::NotFollowing),
            Request::Refer { references, go, .. } => {
                let room = references.len().min(255 - self.references.len());
                self.references.extend(&references[..room]);
                self.going |= go;
                // A frame that is not full is the last.
                self.tail = if references.len() < 64 { 10 } else { 0 };
                return Reply::Referred { taken: room as u16, starved: self.manners.starved };
            }
            Request::Reset => {
                let stored = self.stored.as_ref().map(|record| Table::parse(record).unwrap());
                self.table = stored.unwrap_or_else(compiled);
                self.inverse = inverse(&self.table);
                self.estimator = Estimator::new(&self.table);
                self.enter(Mode::Estimate);
            }
        }
        Reply::Done
    }

    /// Of a write of flash.
    fn refusal(&self, while_estimating: bool) -> Option<Refusal> {
        if self.manners.store_fails {
            Some(Refusal::Store(text("the flash reports an error")))
        } else if self.mode == Mode::Estimate && !while_estimating {
            Some(Refusal::Estimating)
        } else {
            None
        }
    }

    fn enter(&mut self, mode: Mode) {
        self.mode = mode;
        self.streaming = false;
        self.number = 0;
        self.fed.clear();
        self.references.clear();
        (self.last, self.tail, self.going) = (None, 0, false);
        self.estimator.restart();
    }

    /// The frame of what the next ticks give; nothing where they give nothing or nobody wants it.
    fn samples(&mut self) -> Vec<u8> {
        // Where nobody watches, its time stands still.
        if self.mode == Mode::Estimate && !self.streaming {
            return Vec::new();
        }
        let first = self.number;
        let mut batch = Samples { first, samples: Default::default() };
        while batch.samples.len() < MAX_BATCH && self.manners.falls_silent_at.is_none_or(|tick| self.number < tick) {
            let code = match self.mode {
                Mode::Estimate => Some(1500 + (self.number % 1000) as u16),
                Mode::Pil => {
                    let unasked = self.manners.gives_unasked && self.number > 0;
                    self.fed.pop_front().or(unasked.then_some(0))
                }
                Mode::Pause => None,
                Mode::Follow => self.wanted().map(|reference| self.driven(reference)),
            };
            let Some(code) = code else { break };
            let estimate = self.estimator.tick(AdcCode(code));
            let wrong = self.manners.wrong_at == Some(self.number);
            let displacement = f32::from_bits(estimate.displacement.to_bits() ^ u32::from(wrong));
            let (dac, status) = (estimate.dac.0, estimate.status);
            let faulty = self.manners.faulty_from.is_some_and(|tick| self.number >= tick);
            let faults = if faulty { Faults::ADC_SATURATED | Faults::SAFE_OUTPUT } else { Faults::empty() };
            let sample = Sample { code, displacement, dac, status, faults };
            batch.samples.push(sample).unwrap();
            self.number += 1;
        }
        let lost = self.manners.lose_samples_from.take_if(|tick| self.number > *tick).is_some();
        if batch.samples.is_empty() || !self.streaming || lost { Vec::new() } else { framed(&ToHost::Samples(batch)) }
    }

    /// The next reference. Its time stands still where there is none, but for some ticks after the last.
    fn wanted(&mut self) -> Option<f32> {
        if !self.going {
            return None;
        }
        let next = self.references.pop_front().or(self.last.filter(|_| self.tail > 0));
        self.tail -= u32::from(self.references.is_empty() && self.tail > 0);
        self.last = next.or(self.last);
        next
    }

    /// The code that the ADC reads of an amplifier which follows at once.
    fn driven(&mut self, reference: f32) -> u16 {
        let voltage = self.inverse.as_mut().unwrap().tick(reference).voltage;
        self.table.adc.code(voltage).0
    }

    fn identity(&self) -> Identity {
        let reason = text("no table is stored");
        Identity {
            board: text("fake"),
            firmware: text("0.1.0"),
            git: text("test"),
            record_version: estimator_core::record::VERSION + u16::from(self.manners.newer_records),
            tick_us: self.table.sample_period_us,
            adc_full_scale: compiled().adc.full_scale,
            dac_full_scale: compiled().dac.full_scale,
            source: if self.stored.is_some() { TableSource::Stored } else { TableSource::Compiled { reason } },
            model: text(self.table.model()),
            table_crc: checksum(&to_record(&self.table)).unwrap(),
        }
    }

    fn health(&self) -> Health {
        Health {
            mode: self.mode,
            ticks: self.number,
            faults: Faults::SAFE_OUTPUT,
            faults_seen: Faults::ADC_STUCK,
            reset: ResetCause::SOFTWARE,
            last_words: Some(text("panicked at the disco")),
            cycles_last: 850,
            cycles_max: 1700,
            cycles_period: 85_000,
            missed: 0,
            adc_saturated: 0,
            voltage_out_of_range: 3,
            clamped: 0,
            dac_saturated: 0,
            out_of_reach: 0,
            samples_dropped: 0,
            frames_refused: 1,
            line_errors: 0,
            flash_errors: 0,
            supply_mv: Some(3298),
        }
    }
}

fn framed(message: &ToHost) -> Vec<u8> {
    let mut buffer = [0; MAX_FRAME];
    encode(message, &mut buffer).unwrap().to_vec()
}
