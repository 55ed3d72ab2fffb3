//! The tick: what happens between a conversion and the next trigger, the same on every board and in every test.
//!
//! Contract. A timer's trigger starts the conversion. The end of the conversion raises the highest-priority interrupt,
//! which calls [`Tick::sample`]. What that returns the board puts out from the *next* trigger on, by hardware alone:
//! whatever the tick's duration, the output has no jitter, as long as the tick is done in time. One tick is 500 µs,
//! 85,000 cycles at 170 MHz, where the image is not built for another rate ([`crate::rate`]). A tick that comes late or
//! not at all, or is not done in time for its output, is counted, and the sample says so; the numbers of the samples
//! skip ticks that did not come. No lock, no log, no allocation, no `f64`. Where the DAC drives the amplifier
//! ([`crate::drive`]), the same holds of its voltage: the reference of tick k moves it at tick k + 1, and the
//! displacement a tick after that.

mod arrival;
mod command;
mod output;

use crate::conversion::Conversion;
use crate::correction::{Correction, Read};
use crate::decimation::Streamed;
use crate::facts::Facts;
use crate::leap::Leap;
use crate::queues::{Numbered, TickQueues};
use crate::setpoint::SetpointCode;
use crate::shaping::{Codes, DacParts};
use crate::startup::{DacUse, Startup};
use crate::telemetry::{Telemetry, add};
use crate::watch::{FaultState, Seen, Watch};
use crate::waveform::{Player, Points};
use arrival::{Arrival, Clock};
use core::sync::atomic::Ordering::Relaxed;
use estimator_core::{AdcCode, Estimate, Estimator, Status};
use protocol::{Faults, Mode, Sample};

/// With these the estimate is not of the voltage that there is.
const DOUBTFUL: Status = Status::ADC_SATURATED.union(Status::VOLTAGE_OUT_OF_RANGE).union(Status::SLEW_EXCEEDED);

/// Everything the interrupt owns.
pub struct Tick<'q> {
    correction: Correction,
    /// Where the table says how fast the amplifier is.
    leap: Option<Leap>,
    /// Without one the DAC stays at its safe code.
    estimator: Option<Estimator<f32>>,
    dac: DacUse,
    /// What the DAC has at its safe code.
    safe: Codes,
    /// Faults that last whatever is read ([`Startup::faults`]).
    standing: Faults,
    queues: TickQueues<'q>,
    telemetry: &'q Telemetry,
    clock: Clock,
    mode: Mode,
    watch: Watch,
    /// The tick's number since the mode was set.
    number: u32,
    decimation: Streamed,
    valid: bool,
    /// The estimate of what the ADC reads has been told its displacement.
    told: bool,
    player: Player<'q>,
}

impl<'q> Tick<'q> {
    /// A tick of a board; its safe code and its faults since boot can be read in `telemetry` from now on.
    pub fn new(
        startup: Startup,
        facts: &Facts,
        queues: TickQueues<'q>,
        points: &'q Points,
        telemetry: &'q Telemetry,
    ) -> Self {
        telemetry.begin_at_rest(&startup);
        let Startup { estimator, correction, leap, dac, linearises, safe, faults, .. } = startup;
        let mut tick = Self {
            correction,
            leap,
            estimator,
            dac,
            safe: Codes { code: safe, parts: DacParts(safe.0.saturating_mul(facts.dac_parts)) },
            standing: faults,
            queues,
            telemetry,
            clock: Clock::new(facts),
            mode: Mode::default(),
            watch: Watch::new(facts.interface.adc_full_scale),
            number: 0,
            decimation: Streamed::default(),
            valid: false,
            told: false,
            player: Player::new(points, telemetry),
        };
        if linearises {
            tick.enter(Mode::Linearise);
        }
        tick
    }

    /// One tick: the codes just converted in, what the DAC is to be given from its next trigger on out.
    /// `now` is the cycle counter.
    pub fn sample(&mut self, conversion: Conversion, now: u32) -> DacParts {
        add(&self.telemetry.ticks, 1);
        self.telemetry.bias.age();
        let arrival = self.arrival(now);
        if let Some(command) = self.queues.commands.dequeue() {
            self.obey(command);
        }
        self.queues.fed.discard();
        self.queues.references.discard();
        let monitor = conversion.monitor;
        let mut read = self.correction.tick(self.telemetry.supply.off(), conversion);
        self.telemetry.set_setpoint(read.corrected.setpoint);
        let mut faults = self.standing;
        if let Some(leap) = &mut self.leap {
            // In every mode, paused and fed ones as well: that a wire is off, or back, shows once.
            read.corrected.monitor = leap.tick(read.corrected.monitor, arrival.lost());
            faults |= leap.faults();
        }
        faults.set(Faults::MISSED_DEADLINE, arrival.is_late());
        faults.set(Faults::SUPPLY, self.telemetry.supply.bad());
        faults.set(Faults::STALLED, self.telemetry.stalled());
        let read = match self.mode {
            Mode::Estimate | Mode::Follow | Mode::Excite | Mode::Linearise | Mode::Waveform => Some(read),
            Mode::Pil => self.queues.fed.take().map(Conversion::from).map(Read::from),
            Mode::Pause => None,
        };
        let (given, faults) = match read {
            Some(read) => self.estimate(read, arrival, faults),
            None => {
                let codes = self.safe_output();
                (self.give(codes).0, faults | Faults::SAFE_OUTPUT)
            }
        };
        let faults = if self.mode.measures() { faults } else { faults | self.idle(monitor, arrival, faults) };
        self.telemetry.set_faults(faults);
        self.telemetry.deadline_missed.store(self.watch.deadline_missed(), Relaxed);
        self.valid = faults.is_empty();
        given
    }

    /// The faults that last of what the converter reads while nothing is estimated of it. (A function of its own, for
    /// modes that have the time.)
    #[cold]
    #[inline(never)]
    fn idle(&mut self, monitor: AdcCode, arrival: Arrival, faults: Faults) -> Faults {
        let (status, late_or_lost, astray) = (Status::empty(), self.clock.odd_ticks(arrival), false);
        self.watch.update(Seen { monitor, setpoint: None, status, late_or_lost, astray, faults }).lasting()
    }

    /// Whether the last tick's code is the estimate's, or follows a reference, with no fault set; a zero that is lost
    /// is one. Where it is, the board shows so by an edge of a pin, which dies with the tick.
    pub fn valid(&self) -> bool {
        self.valid
    }

    fn estimate(&mut self, read: Read, arrival: Arrival, faults: Faults) -> (DacParts, Faults) {
        let Read { conversion: Conversion { monitor, .. }, corrected } = read;
        let code = corrected.monitor;
        let Estimate { displacement, half_width, dac, mut status } = match &mut self.estimator {
            Some(estimator) => {
                let estimate = tick_sample(estimator, code);
                self.telemetry.may_be_told.store(estimator.may_be_told(), Relaxed);
                estimate
            }
            None => Estimate { displacement: 0.0, half_width: None, dac: self.safe.code, status: Status::empty() },
        };
        if self.watch.at_an_end(monitor) {
            // An end of the range says so whatever has become of it.
            status |= Status::ADC_SATURATED;
        }
        if let Some(leap) = &self.leap
            && self.mode.measures()
        {
            status |= leap.status();
        }
        let setpoint = self.setpoint(read);
        let (mut faults, sound) = self.supervise(read, setpoint.map(|code| code.read), status, arrival, faults);
        self.telemetry.doubtful.store(status.intersects(DOUBTFUL) || !self.watch.sound(), Relaxed);
        let output = self.output((displacement, dac), setpoint, sound);
        status |= output.status;
        let (given, beyond) = self.give(output.codes);
        let drives = self.dac.drive().is_some();
        if drives {
            // The DAC shows no displacement.
            status.remove(Status::DAC_SATURATED);
        }
        if beyond && !output.safe {
            status |= if drives { Status::OUT_OF_REACH } else { Status::DAC_SATURATED };
        }
        self.telemetry.count(status);
        faults.set(Faults::SAFE_OUTPUT, output.safe);
        self.stream(Sample {
            code: code.0,
            sensor: corrected.sensor.map(|AdcCode(code)| code),
            displacement,
            half_width,
            dac: output.codes.code.0,
            status,
            faults,
        });
        self.number = self.number.wrapping_add(1);
        (given, faults)
    }

    /// The set-point's code, where it is followed. One that does not come is as good as one at an end of the range.
    fn setpoint(&self, Read { conversion, corrected }: Read) -> Option<SetpointCode> {
        let at = |conversion: Conversion| conversion.setpoint.unwrap_or(AdcCode(0));
        (self.mode == Mode::Linearise).then(|| SetpointCode { read: at(conversion), corrected: at(corrected) })
    }

    /// Adds the faults that last to this tick's, and says whether the output may be anything but the safe one.
    fn supervise(
        &mut self,
        Read { conversion: Conversion { monitor, .. }, corrected }: Read,
        setpoint: Option<AdcCode>,
        status: Status,
        arrival: Arrival,
        faults: Faults,
    ) -> (Faults, bool) {
        // Fed codes are not the ADC's: they say nothing of its health, and their ticks come when they are fed.
        if self.mode == Mode::Pil {
            return (faults, false);
        }
        self.number = self.number.wrapping_add(arrival.lost());
        let drive = self.dac.drive().filter(|_| self.mode.drives());
        let astray = drive.is_some_and(|drive| drive.astray(corrected.monitor));
        let late_or_lost = self.clock.odd_ticks(arrival);
        // Codes as they were read show the converter's ends, and whether it stands still.
        let state = self.watch.update(Seen { monitor, setpoint, status, late_or_lost, astray, faults });
        if let FaultState::Recovered(lasted) = state
            && lasted.harm_estimate()
        {
            // What it has made of the bad codes is forgotten; this tick's sample still has it.
            self.restart();
        }
        (faults | state.lasting(), state == FaultState::Healthy && !faults.intersects(Faults::UNSAFE))
    }

    fn stream(&mut self, sample: Sample) {
        if !self.telemetry.streaming.load(Relaxed) {
            if !Streamed::ALL {
                self.decimation = Streamed::default();
            }
            return;
        }
        // Of fed codes every one is answered: they come no faster than the line brings them.
        let all = Streamed::ALL || self.mode == Mode::Pil;
        let streamed = if all { Some(sample) } else { self.decimation.take(self.number, sample) };
        if let Some(sample) = streamed
            && self.queues.samples.enqueue(Numbered { tick: self.number, sample }).is_err()
        {
            add(&self.telemetry.dropped, 1);
        }
    }

    /// How this tick has come, which is counted.
    fn arrival(&mut self, now: u32) -> Arrival {
        let arrival = self.clock.tick(now, !self.telemetry.output_late.load(Relaxed));
        if let Arrival::Late { lost } = arrival {
            self.telemetry.output_late.store(false, Relaxed);
            add(&self.telemetry.missed, lost.max(1));
        }
        arrival
    }
}

/// The estimator's tick as a function of its own, so that its instructions can be counted in an image.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_sample(estimator: &mut Estimator<f32>, code: AdcCode) -> Estimate<f32> {
    estimator.tick(code)
}

/// Marks the start of a measurement, for whoever counts instructions.
#[inline(never)]
#[unsafe(no_mangle)]
fn tick_restart(estimator: &mut Estimator<f32>) {
    estimator.restart();
}
