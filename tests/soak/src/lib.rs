//! A device that streams each tick for hours of its own time, and a host that receives the stream and computes
//! each sample itself.
//!
//! The device is the firmware's own library behind a socket, as fast as this machine lets it: tick, queues, link. Or it
//! is the image for the MPS2 in QEMU, whose bits are those of a Cortex-M4F. What the converter reads is a function of
//! the tick's number alone ([`signal`]), so that the host knows it even of samples that never came.

pub mod signal;

use device_link::{Address, Client, LinkError};
use emulator::{Conversion, EmulatedDevice, Emulator, EmulatorError, TABLE};
use estimator_core::table::TableError;
use estimator_core::{AdcCode, DacCode, Estimate, Estimator};
use protocol::Samples;
use protocol::sample::MAX_BATCH;
use signal::{Signal, swings};
use std::fmt;
use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

/// Seconds of the device in a second, where this machine is fast enough; beyond that the link could not carry
/// every sample away.
const SPEED: f64 = 12.0;
/// How long the stream may be silent.
const PATIENCE: Duration = Duration::from_secs(10);
/// Codes by which it is found which tick of the converter a sample is of: so many at least, since one or two may occur
/// often, and no more than are of use. And how far it is looked for.
const CODES: RangeInclusive<usize> = 8..=64;
const FARTHEST: u32 = 1_000_000;

/// What came of a soak.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Soak {
    /// Ticks from the first sample to the last.
    pub ticks: u32,
    /// Samples that came.
    pub samples: u32,
    /// Ticks of which no sample came.
    pub missing: u32,
    /// Those that the device counts as dropped: it found no room for them.
    pub dropped: u32,
    /// Frames that came damaged, with the samples in them.
    pub damaged: u32,
    /// Samples of which a bit of the code, the displacement, its ±, the DAC's code or the status is not the host's, or
    /// that have a fault: the converter gives no cause for one.
    pub different: u32,
    /// Ticks that the device calls late or lost.
    pub late: u32,
    /// Ticks that the status says something of.
    pub flagged: u32,
    /// How long it took.
    pub took: Duration,
}

/// Why there was no soak.
#[derive(Debug, thiserror::Error)]
pub enum SoakError {
    /// The device could not be emulated.
    #[error(transparent)]
    Emulator(#[from] EmulatorError),
    /// The link failed.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The compiled table is refused.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The stream ended.
    #[error("no sample has come for {} s", PATIENCE.as_secs())]
    Silent,
    /// What came is not what the converter read.
    #[error("the first samples are of no tick of the converter")]
    Strange,
    /// What came is of ticks that have come already, or of earlier ones.
    #[error("samples of tick {first} came behind those of the ticks before {next}")]
    Reordered {
        /// The tick of the first of them.
        first: u32,
        /// The tick that was to come next.
        next: u32,
    },
}

/// Starts the device that is soaked.
///
/// # Errors
/// It does not start.
pub fn device() -> Result<EmulatedDevice, EmulatorError> {
    let mut read = 0;
    let plant = move |_: DacCode| -> Conversion {
        read += 1;
        swings(read - 1).into()
    };
    Emulator::new().speed(SPEED).plant(plant).start()
}

impl Soak {
    /// Has a [`device`] stream so many ticks.
    ///
    /// # Errors
    /// The device does not start, or its stream ends or comes in another order.
    pub fn of(ticks: u32) -> Result<Self, SoakError> {
        let device = device()?;
        Self::at(&device.address().into(), swings, ticks)
    }

    /// Has the device at an address stream so many ticks. It has been started for this, with the compiled table, and
    /// its converter reads this signal.
    ///
    /// # Errors
    /// Its stream ends or comes in another order.
    pub fn at(address: &Address, signal: Signal, ticks: u32) -> Result<Self, SoakError> {
        let (mut client, _) = Client::connect(address)?;
        client.stream(true)?;
        let (start, mut soak) = (Instant::now(), Self::default());
        let mut begun: Vec<Samples> = Vec::new();
        while begun.iter().map(|batch| batch.samples.len()).sum::<usize>() < *CODES.start() {
            begun.push(next(&mut client)?);
        }
        let codes: Vec<u16> = begun.iter().flat_map(|batch| &batch.samples).map(|sample| sample.code).collect();
        let mut host = Host::new(signal, begun[0].first, &codes)?;
        let mut begun = begun.into_iter();
        while soak.ticks < ticks {
            let batch = begun.next().map_or_else(|| next(&mut client), Ok)?;
            let reordered = SoakError::Reordered { first: batch.first, next: host.next };
            let gap = batch.first.checked_sub(host.next).ok_or(reordered)?;
            host.skip(gap);
            soak.missing += gap;
            for sample in &batch.samples {
                let (AdcCode(code), estimate) = host.tick();
                let same = sample.code == code
                    && sample.displacement.to_bits() == estimate.displacement.to_bits()
                    && sample.dac == estimate.dac.0
                    && sample.half_width.map(f32::to_bits) == estimate.half_width.map(f32::to_bits)
                    && sample.status == estimate.status
                    && sample.faults.is_empty();
                soak.different += u32::from(!same);
                soak.flagged += u32::from(!sample.status.is_empty());
            }
            soak.samples += batch.samples.len() as u32;
            soak.ticks = soak.samples + soak.missing;
        }
        soak.took = start.elapsed();
        let health = client.health()?;
        (soak.dropped, soak.late, soak.damaged) = (health.samples_dropped, health.missed, client.damaged());
        Ok(soak)
    }

    /// Whether every tick is accounted for and every sample is the host's.
    pub fn sound(&self) -> bool {
        let accounted = u64::from(self.dropped) + u64::from(self.damaged) * MAX_BATCH as u64;
        u64::from(self.missing) <= accounted && self.different == 0 && self.late == 0
    }
}

impl fmt::Display for Soak {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { ticks, samples, missing, dropped, damaged, different, late, flagged, took } = self;
        let seconds = took.as_secs_f64();
        writeln!(f, "{ticks} ticks in {seconds:.0} s, {:.0} a second", f64::from(*ticks) / seconds)?;
        writeln!(f, "{samples} samples came, {missing} did not: {dropped} dropped, {damaged} frames damaged")?;
        write!(f, "{different} samples differ from the host's, {late} ticks were late, {flagged} samples had a flag")
    }
}

fn next(client: &mut Client) -> Result<Samples, SoakError> {
    client.samples(PATIENCE)?.ok_or(SoakError::Silent)
}

/// The host's own estimator, tick by tick as the device's.
struct Host {
    signal: Signal,
    estimator: Estimator<f32>,
    /// The converter's tick at the estimator's first.
    origin: u32,
    /// The number of the next tick.
    next: u32,
}

impl Host {
    /// Up to the first sample, which has this number.
    fn new(signal: Signal, first: u32, codes: &[u16]) -> Result<Self, SoakError> {
        let codes = &codes[..codes.len().min(*CODES.end())];
        let here = |at: &u32| (*at..).zip(codes).all(|(at, found)| signal(at).0 == *found);
        let found = (first..first.saturating_add(FARTHEST)).find(here).ok_or(SoakError::Strange)?;
        let estimator = Estimator::new(&TABLE.admit()?);
        let mut host = Self { signal, estimator, origin: found - first, next: 0 };
        host.skip(first);
        Ok(host)
    }

    fn skip(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn tick(&mut self) -> (AdcCode, Estimate<f32>) {
        let code = (self.signal)(self.origin.wrapping_add(self.next));
        self.next = self.next.wrapping_add(1);
        (code, self.estimator.tick(code))
    }
}
