//! What the device does that a request asks for, and its reply.

use super::loaded::Loaded;
use crate::boot::{self, Chosen};
use crate::chip::Chip;
use crate::compiled::TABLE;
use crate::drive::Following;
use crate::facts::Facts;
use crate::queues::{Command, LinkQueues};
use crate::rate::TICK_HZ;
use crate::restarts::Memory;
use crate::telemetry::Telemetry;
use crate::waveform::Points;
use core::sync::atomic::Ordering::Relaxed;
use embassy_time::{Duration, Instant, Timer};
use embedded_storage_async::nor_flash::NorFlash;
use estimator_core::{AdcCode, Admitted, DriveCalibration};
use parameter_store::ParameterStore;
use protocol::{Codes, Faults, LastWords, Mode, References, Refusal, Reply, Request, text};

/// How long a change of mode may take; it happens at the next tick.
pub(super) const OBEYED: Duration = Duration::from_millis(20);
pub(super) const POLL: Duration = Duration::from_micros(250);
/// How long a reset tries to pause the tick first. Where ticks come at all, the first try succeeds.
const PAUSED: Duration = Duration::from_secs(1);

/// What the link has of a tick.
pub struct LinkEnd<'q> {
    /// What the tick is handed and hands back.
    pub queues: LinkQueues<'q>,
    /// Where it plays a waveform from.
    pub points: &'q Points,
    /// What it leaves to read.
    pub telemetry: &'q Telemetry,
}

/// All that requests are about.
pub struct Device<'q, F: NorFlash> {
    /// What the board says of itself.
    pub facts: Facts,
    /// What its chip counts.
    pub(super) chip: &'q dyn Chip,
    /// What this start leaves the next ones.
    pub(super) memory: Memory<'q>,
    /// The table in use, where it comes from, and what speaks against it.
    pub chosen: Chosen,
    /// The last run's message.
    pub(super) last_words: Option<LastWords>,
    /// The parameter store.
    pub store: ParameterStore<F>,
    /// What the tick leaves to read.
    pub telemetry: &'q Telemetry,
    /// What the tick is handed and hands back.
    pub queues: LinkQueues<'q>,
    /// Frames refused so far.
    pub(super) frames_refused: u32,
    /// Errors of the serial line that its driver has reported so far, of either direction.
    pub(super) line_errors: u32,
    /// What the board's counters were when they were last forgotten.
    pub(super) forgotten: Forgotten,
    /// The references of the mode so far.
    pub(super) referred: Taken,
    /// The waveform in memory.
    pub(super) waveform: Loaded<'q>,
}

/// Counts that the board goes on with, as they were.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Forgotten {
    /// Errors of the line.
    pub(super) line_errors: u32,
    /// Flash words that could not be corrected.
    pub(super) flash_errors: u32,
}

/// References that have been taken.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Taken {
    /// Of the mode that began so ([`Telemetry::epoch`]).
    epoch: u32,
    /// The number of the next one.
    next: u32,
    /// Ticks that had found none when the last one was taken.
    starved: u32,
}

impl<'q, F: NorFlash> Device<'q, F> {
    /// A device that has just started with this table.
    pub fn new(
        facts: Facts,
        chip: &'q dyn Chip,
        memory: Memory<'q>,
        chosen: Chosen,
        last_words: Option<LastWords>,
        store: ParameterStore<F>,
        LinkEnd { queues, points, telemetry }: LinkEnd<'q>,
    ) -> Self {
        Self {
            facts,
            chip,
            memory,
            chosen,
            last_words,
            store,
            telemetry,
            queues,
            frames_refused: 0,
            line_errors: 0,
            forgotten: Forgotten::default(),
            referred: Taken::default(),
            waveform: Loaded::new(points),
        }
    }
}

impl<F: NorFlash> Device<'_, F> {
    /// Does what is asked. A reset is left to the caller, after the reply.
    pub async fn handle(&mut self, request: Request) -> Reply {
        let done = match request {
            Request::Identify => return Reply::Identity(self.identity()),
            Request::Health => return Reply::Health(self.health()),
            Request::Pull => return self.record().map_or(Reply::Refused(Refusal::NoTable), Reply::Table),
            Request::Feed(codes) => return self.feed(&codes),
            Request::Refer { first, references, go, hold } => return self.refer(first, &references, go, hold),
            Request::Push { record, while_estimating, rewired } => self.push(&record, while_estimating, rewired).await,
            Request::Erase { while_estimating, rewired } => self.erase(while_estimating, rewired).await,
            Request::Load { first, points } => return self.load(first, &points),
            Request::Play(how) => self.play(how).await,
            Request::SetMode(mode) => self.set_mode(mode).await,
            Request::SetZero { at_um } => self.tell(at_um, Command::SetZero { at_um }).await,
            Request::ShiftBias { by_um } => self.shift(by_um).await,
            Request::Stream(on) => {
                self.stream(on);
                Ok(())
            }
            Request::Forget => {
                self.forget();
                Ok(())
            }
            Request::Reset => return Reply::Resetting { in_ms: self.telemetry.ticks_to_safe() / (TICK_HZ / 1_000) },
        };
        done.map_or_else(Reply::Refused, |()| Reply::Done)
    }

    /// Brings the output to its safe code, at the drive's slew rate where there is one, however long that takes. It
    /// ends whatever the output does: a device that waited here for ever could not even be reset. Where the tick does
    /// not come any more, the watchdog ends this sooner.
    pub async fn rest(&mut self) {
        let asked = Instant::now();
        while self.set_mode(Mode::Pause).await.is_err() && asked.elapsed() < PAUSED {
            Timer::after(POLL).await;
        }
        let passed = || self.telemetry.ticks.load(Relaxed);
        // Twice as long as the way takes: the drive goes it in steps that are rounded otherwise.
        let (start, enough) = (passed(), self.telemetry.ticks_to_safe().saturating_mul(2));
        while self.telemetry.ticks_to_safe() > 0 && passed().wrapping_sub(start) < enough {
            Timer::after(POLL).await;
        }
    }

    async fn push(&mut self, record: &[u8], while_estimating: bool, rewired: bool) -> Result<(), Refusal> {
        let table = boot::parse(record, &self.facts.interface).map_err(Refusal::Table)?;
        self.may_rewire(table.drive.is_some(), rewired)?;
        self.may_write(while_estimating)?;
        self.store.store(record).await.map_err(|error| Refusal::Store(text(error)))
    }

    async fn erase(&mut self, while_estimating: bool, rewired: bool) -> Result<(), Refusal> {
        self.may_rewire(TABLE.drive.is_some(), rewired)?;
        self.may_write(while_estimating)?;
        self.store.erase().await.map_err(|error| Refusal::Store(text(error)))
    }

    /// Whether the next table may be one by which the DAC drives the amplifier, or no longer does.
    fn may_rewire(&self, drives: bool, rewired: bool) -> Result<(), Refusal> {
        // Where something is stored that could not be used, nobody knows what the output is wired for.
        let known = !self.chosen.doubts.contains(Faults::TABLE_FALLBACK);
        let same = known && self.chosen.table.as_ref().is_none_or(|table| table.drive.is_some() == drives);
        if same || rewired { Ok(()) } else { Err(Refusal::Rewired) }
    }

    fn may_write(&self, while_estimating: bool) -> Result<(), Refusal> {
        if let Some(reason) = self.facts.no_store {
            return Err(Refusal::Store(text(reason)));
        }
        if self.estimating() && !while_estimating { Err(Refusal::Estimating) } else { Ok(()) }
    }

    fn estimating(&self) -> bool {
        self.telemetry.mode().measures() && self.estimator().is_some()
    }

    /// The table that is estimated by: none without a clock.
    pub(super) fn estimator(&self) -> Option<&Admitted> {
        self.chosen.table.as_ref().filter(|_| !self.telemetry.faults().contains(Faults::CLOCK))
    }

    fn drive(&self) -> Option<&DriveCalibration> {
        self.chosen.table.as_ref()?.drive.as_ref()
    }

    /// Streaming starts with samples of now and ends with the change of mode. One that is asked for again goes on.
    fn stream(&mut self, on: bool) {
        if on && self.telemetry.streaming.load(Relaxed) {
            return;
        }
        self.telemetry.streaming.store(false, Relaxed);
        while self.queues.samples.dequeue().is_some() {}
        self.telemetry.streaming.store(on, Relaxed);
    }

    /// Whether the mode is one that lasts only while the host that has set it speaks. To stay at a displacement is
    /// asked for; the voltages of a session are held between its parts, by a host that goes on.
    pub fn lent(&self) -> bool {
        let mode = self.telemetry.mode();
        let stays = mode == Mode::Follow && self.telemetry.following() == Following::UntilModeEnds;
        !mode.lasts() && !stays
    }

    /// Changes what the tick does, which takes a tick.
    ///
    /// # Errors
    /// The table or the board does not have what the mode needs, a fault hinders it, or no tick has come to obey.
    pub async fn set_mode(&mut self, mode: Mode) -> Result<(), Refusal> {
        match (mode, self.drive()) {
            (Mode::Waveform, _) => return Err(Refusal::NotByMode),
            (Mode::Linearise, Some(_)) if !self.facts.has_setpoint => return Err(Refusal::NoSetpointInput),
            (Mode::Linearise, Some(drive)) if drive.setpoint.is_none() => return Err(Refusal::NoSetpoint),
            // It follows its set-point, or waits for that: it neither leaves it nor waits longer.
            (Mode::Linearise, Some(_)) if self.telemetry.linearises() => return Ok(()),
            _ => {}
        }
        self.begin(mode, Command::SetMode(mode)).await
    }

    /// Has the tick begin a mode by a command.
    pub(super) async fn begin(&mut self, mode: Mode, command: Command) -> Result<(), Refusal> {
        if mode.drives() && self.drive().is_none() {
            return Err(Refusal::NoDrive);
        }
        // Of ticks that are late one alone hinders nothing.
        let deadline_missed = mode.drives() && self.telemetry.deadline_missed.load(Relaxed);
        if deadline_missed || self.telemetry.faults().intersects(Faults::against(mode)) {
            return Err(Refusal::Faulty);
        }
        let epoch = self.telemetry.epoch.load(Relaxed);
        self.queues.commands.enqueue(command).map_err(|_| Refusal::Busy)?;
        for _ in 0..OBEYED.as_ticks() / POLL.as_ticks() {
            if self.telemetry.epoch.load(Relaxed) != epoch {
                self.stream(false);
                return Ok(());
            }
            Timer::after(POLL).await;
        }
        Err(Refusal::Busy)
    }

    fn feed(&mut self, codes: &Codes) -> Reply {
        if self.telemetry.mode() != Mode::Pil {
            return Reply::Refused(Refusal::NotPil);
        }
        let taken = codes.iter().take_while(|&&code| self.queues.fed.enqueue(AdcCode(code)).is_ok()).count();
        // At most 64.
        Reply::Fed(taken as u16)
    }

    fn refer(&mut self, first: u32, references: &References, go: bool, hold: bool) -> Reply {
        if !self.telemetry.mode().takes_references() {
            return Reply::Refused(Refusal::NotFollowing);
        }
        if !references.iter().all(|reference| reference.is_finite()) {
            return Reply::Refused(Refusal::NotFinite);
        }
        let epoch = self.telemetry.epoch.load(Relaxed);
        if self.referred.epoch != epoch {
            self.referred = Taken { epoch, ..Taken::default() };
        }
        // What was taken before is passed over. A gap, or a frame that is late by more than its length, is left alone.
        let known = self.referred.next.wrapping_sub(first) as usize;
        if let Some(new) = references.get(known..) {
            let mut queued = true;
            for &reference in new {
                let starved = self.telemetry.starved.load(Relaxed);
                queued = self.queues.references.enqueue(reference).is_ok();
                if !queued {
                    break;
                }
                self.referred.next = self.referred.next.wrapping_add(1);
                self.referred.starved = starved;
            }
            // What is held is the last of them, never one on the way.
            if go && self.queues.commands.enqueue(Command::Go { hold: hold && queued }).is_err() {
                return Reply::Refused(Refusal::Busy);
            }
        }
        let Taken { next, starved, .. } = self.referred;
        Reply::Referred { next, starved }
    }
}
