//! A host at the other end of an emulated board's serial line, and the tables it sends.

/// The image's table, which is the demonstration's.
#[rustfmt::skip]
#[path = "../../../../../firmware/src/table.rs"]
mod demonstration;
pub mod noise;

use anyhow::{Result, bail, ensure};
use board_emulator_test::{Board, CORE_HZ, Edge, Image, Latch, Pin, Port, Record as Recorded, Reset, Stop};
use embassy_futures::block_on;
use estimator_core::record::MAX_LENGTH;
use estimator_core::{AdcCode, Admitted, DacCode, Table};
use parameter_store::{ParameterStore, RamFlash};
use protocol::frame::MAX_FRAME;
use protocol::{Deframer, Health, Identity, Record, Reply, Request, Samples, ToDevice, ToHost, encode};

/// Clocks from trigger to trigger.
pub const PERIOD: u64 = CORE_HZ as u64 / 2000;
/// Clocks from a trigger to its tick's interrupt: of three channels sixteen conversions of 60 ADC clocks each, at a
/// quarter of the core's clock.
pub const CONVERSION: u64 = 16 * CONVERTED;
/// The same where a code is of one conversion.
pub const CONVERTED: u64 = 3 * 60 * 4;
/// The pin that has an edge at every good tick.
pub const VALID: Pin = Pin { port: Port::B, number: 10 };
/// The pages of the parameter store, as memory.x has them.
const PAGES: std::ops::Range<u32> = 0x0807_F000..0x0808_0000;
/// How long the device may take to start and to reply, s. The longest reply waits for some thirty flash operations.
const PATIENCE: f64 = 0.5;

/// A board and its host.
pub struct Bench {
    pub board: Board,
    /// What the device has streamed.
    pub samples: Vec<Samples>,
    deframer: Deframer,
    sequence: u16,
}

impl Bench {
    /// A board that has a table in its store, the demonstration's, running, on a voltage that rises and falls.
    pub fn started() -> Result<Self> {
        Self::of("FIRMWARE_IMAGE", |board| {
            board.feed(triangle);
            store(board, 500);
        })
    }

    /// The same with an erased store.
    pub fn erased() -> Result<Self> {
        Self::of("FIRMWARE_IMAGE", |board| board.feed(triangle))
    }

    /// A new board with the image that an environment variable names, running on inputs that it is given before.
    pub fn of(image: &str, inputs: impl FnOnce(&mut Board)) -> Result<Self> {
        let mut board = Board::power_on(&Image::from_environment(image)?)?;
        inputs(&mut board);
        let mut bench = Self { board, samples: Vec::new(), deframer: Deframer::new(), sequence: 0 };
        bench.start()?;
        Ok(bench)
    }

    /// Until the device ticks.
    pub fn start(&mut self) -> Result<()> {
        let before = self.board.record().conversions.len();
        let stop = self.board.run_until(PATIENCE, |board| board.record().conversions.len() > before)?;
        ensure!(stop == Stop::Condition, "the firmware does not come to its first conversion: {stop:?}");
        Ok(())
    }

    /// A reset or the return of power, after which the device runs again.
    pub fn reboot(&mut self, cause: Reset) -> Result<()> {
        self.board.reboot(cause)?;
        self.deframer = Deframer::new();
        self.board.take_received();
        self.start()
    }

    /// Connects an amplifier between DAC and ADC, which makes of the voltage that a table's drive commands the one that
    /// its ADC reads.
    pub fn connect(&mut self, table: &Admitted, amplifier: impl Fn(f32) -> f32 + 'static) {
        let (adc, drive) = (table.adc, table.drive.expect("the table drives"));
        let rest = drive.code(drive.limits.rest_v, table.dac.full_scale);
        self.board.connect(move |n, pin| {
            let AdcCode(code) = adc.code(amplifier(drive.voltage(pin.map_or(rest, DacCode))));
            code.saturating_add((n % 2) as u16).min(adc.full_scale)
        });
    }

    /// Runs for `seconds`; nothing may end the run before.
    pub fn run(&mut self, seconds: f64) -> Result<()> {
        let stop = self.board.run(seconds)?;
        ensure!(stop == Stop::Time, "the run ends with {stop:?}");
        self.listen();
        Ok(())
    }

    /// The reply to a request.
    pub fn ask(&mut self, request: Request) -> Result<Reply> {
        let name = format!("{request:?}");
        match self.ask_or_stop(request)? {
            Ok(reply) => Ok(reply),
            Err(stop) => bail!("no reply to {name}: {stop:?}"),
        }
    }

    /// The reply to a request, or what kept the device from giving it.
    pub fn ask_or_stop(&mut self, request: Request) -> Result<Result<Reply, Stop>> {
        self.sequence += 1;
        let sequence = self.sequence;
        self.board.send(&frame(sequence, request));
        let deadline = self.board.clock() + (PATIENCE * f64::from(CORE_HZ)) as u64;
        while self.board.clock() < deadline {
            let stop = self.board.run_until(PATIENCE, |board| board.received() > 0)?;
            if stop != Stop::Condition {
                return Ok(Err(stop));
            }
            if let Some((_, reply)) = self.listen().into_iter().find(|(to, _)| *to == sequence) {
                return Ok(Ok(reply));
            }
        }
        Ok(Err(Stop::Time))
    }

    /// Takes what has come: keeps the samples, gives the replies.
    pub fn listen(&mut self) -> Vec<(u16, Reply)> {
        let mut replies = Vec::new();
        for byte in self.board.take_received() {
            match self.deframer.push(byte) {
                Some(Ok(ToHost::Reply { to, reply })) => replies.push((to, reply)),
                Some(Ok(ToHost::Samples(samples))) => self.samples.push(samples),
                Some(Err(error)) => panic!("the device sends {error}"),
                None => {}
            }
        }
        replies
    }

    pub fn does(&mut self, request: Request) -> Result<()> {
        let reply = self.ask(request)?;
        ensure!(reply == Reply::Done, "{reply:?}");
        Ok(())
    }

    pub fn health(&mut self) -> Result<Health> {
        match self.ask(Request::Health)? {
            Reply::Health(health) => Ok(health),
            other => bail!("{other:?}"),
        }
    }

    pub fn identity(&mut self) -> Result<Identity> {
        match self.ask(Request::Identify)? {
            Reply::Identity(identity) => Ok(identity),
            other => bail!("{other:?}"),
        }
    }

    /// The table in use.
    pub fn table(&mut self) -> Result<Admitted> {
        match self.ask(Request::Pull)? {
            Reply::Table(record) => Ok(Table::parse(&record)?),
            other => bail!("{other:?}"),
        }
    }

    /// Flash operations so far.
    pub fn operations(&self) -> usize {
        self.board.record().flash.len()
    }

    /// Stores a table, which is used after [`Bench::restart`].
    pub fn push(&mut self, table: &Admitted) -> Result<()> {
        self.does(push(table))
    }

    /// Asks for a reset; the time that the device says it needs before, ms.
    pub fn reset(&mut self) -> Result<u32> {
        match self.ask(Request::Reset)? {
            Reply::Resetting { in_ms } => Ok(in_ms),
            other => bail!("{other:?}"),
        }
    }

    /// A reset that the device is asked for.
    pub fn restart(&mut self) -> Result<()> {
        self.reset()?;
        let stop = self.board.run(PATIENCE)?;
        ensure!(stop == Stop::Reset(Reset::Software), "{stop:?}");
        self.reboot(Reset::Software)
    }
}

/// Puts the demonstration's table into the store, for this tick.
pub fn store(board: &mut Board, tick_us: u32) {
    let table = demonstration::TABLE.at_tick(tick_us).expect("a model that is bound to no tick");
    let mut pages = vec![0xFF; PAGES.len()];
    let mut store = ParameterStore::new(RamFlash::new(&mut pages), 0..PAGES.len() as u32).expect("two pages");
    block_on(store.store(&record(&table.admit().expect("the demonstration's table is admissible")))).expect("room");
    board.contents_mut().set(PAGES.start, &pages);
}

/// Parts of a code that the output has, and its largest code in them.
pub const PARTS: u16 = 16;
pub const FULL: u16 = 4095 * PARTS;
/// Codes that the DAC puts out in a tick, clocks from one to the next, and by which the first may be earlier
/// than the trigger.
const CODES: usize = 50;
const SPACING: u64 = PERIOD / CODES as u64;
pub const EARLY: u64 = CORE_HZ as u64 / 1_000_000;

/// What a low-pass behind the pin shows, from the latch `start` on, in [`PARTS`] of a code: the mean of what is put out
/// from each trigger to the next, at that trigger's clock. What is put out without triggers is there as it is; a tick
/// that is not over is not. No tick is to have other codes than two neighbours.
pub fn shown(record: &Recorded, start: usize) -> Vec<Latch> {
    let mut triggers = record.conversions.iter().map(|conversion| conversion.trigger).peekable();
    let mut ticks: Vec<(u64, Vec<u16>)> = Vec::new();
    let mut trigger = None;
    for &Latch { clock, code } in &record.outputs[start..] {
        while let Some(next) = triggers.next_if(|&next| next <= clock + EARLY) {
            trigger = Some(next);
        }
        let of = trigger.filter(|&of| clock + EARLY < of + PERIOD).unwrap_or(clock);
        match ticks.last_mut().filter(|(last, _)| *last == of) {
            Some((_, codes)) => codes.push(code),
            None => ticks.push((of, vec![code])),
        }
    }
    if let Some([before, last]) = record.outputs.last_chunk()
        && last.clock - before.clock == SPACING
    {
        while ticks.pop_if(|(of, _)| last.clock + SPACING + EARLY < *of + PERIOD).is_some() {}
    }
    for (of, codes) in ticks.iter().filter(|(_, codes)| codes.len() == CODES) {
        assert!(codes.windows(2).all(|pair| pair[0].abs_diff(pair[1]) <= 1), "the tick at {of}: {codes:?}");
    }
    let mean = |codes: &[u16]| codes.iter().map(|&code| f64::from(code)).sum::<f64>() / codes.len() as f64;
    // Of 50 codes the mean is what is wanted to a third of a part.
    let parts = |codes: &[u16]| (mean(codes) * f64::from(PARTS)).round() as u16;
    ticks.iter().map(|(clock, codes)| Latch { clock: *clock, code: parts(codes) }).collect()
}

/// The edges of VALID.
pub fn valid(board: &Board) -> &[Edge] {
    board.record().edges.get(&VALID).map_or(&[], Vec::as_slice)
}

/// How many of them have come since.
pub fn valid_since(board: &Board, clock: u64) -> usize {
    valid(board).iter().filter(|edge| edge.clock >= clock).count()
}

/// A request's frame.
pub fn frame(sequence: u16, request: Request) -> Vec<u8> {
    let message = ToDevice { sequence, request };
    encode(&message, &mut [0; MAX_FRAME]).expect("every request fits a frame").to_vec()
}

pub fn push(table: &Admitted) -> Request {
    Request::Push { record: record(table), while_estimating: true, rewired: true }
}

pub fn record(table: &Admitted) -> Record {
    let mut buffer = [0; MAX_LENGTH];
    let length = table.encode(&mut buffer).expect("the longest record fits");
    buffer[..length].iter().copied().collect()
}

/// The table with another seed: as good, and told apart by its record.
pub fn reseeded(table: &Admitted, seed: u32) -> Admitted {
    let mut table: Table = **table;
    table.provenance.seed = seed;
    table.admit().expect("the seed does not matter")
}

/// Codes over a good part of the range, never the same twice in a row, far from the converter's ends.
pub fn triangle(n: u64) -> u16 {
    let phase = (n % 2000) as u16;
    10_000 + 40 * phase.min(2000 - phase)
}
