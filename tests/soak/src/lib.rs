//! A device that streams each tick for hours of its own time, and a host that receives the stream and computes each sample itself.
//!
//! The device is the firmware's own library behind a socket, as fast as this machine lets it: tick, queues, link. What its
//! converter reads is a function of the tick's number alone, so that the host knows it even of samples that never came.

mod signal;

use device_link::{Client, LinkError};
use emulator::{Conversion, Emulator, EmulatorError, TABLE};
use estimator_core::table::TableError;
use estimator_core::{AdcCode, DacCode, Estimate, Estimator};
use protocol::sample::MAX_BATCH;
use signal::code;
use std::fmt;
use std::time::{Duration, Instant};

/// Seconds of the device in a second, where this machine is fast enough; beyond that the link could not carry every sample away.
const SPEED: f64 = 12.0;
/// How long the stream may be silent.
const PATIENCE: Duration = Duration::from_secs(10);
/// Codes by which it is found which tick of the converter a sample is of, and how far it is looked for.
const CODES: usize = 64;
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
    /// Samples of which a bit of the code, the displacement, the DAC's code or the status is not the host's.
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
}

impl Soak {
    /// Has a device stream so many ticks.
    ///
    /// # Errors
    /// The device does not start, or its stream ends.
    pub fn of(ticks: u32) -> Result<Self, SoakError> {
        let mut read = 0;
        let device = Emulator::new()
            .speed(SPEED)
            .plant(move |_: DacCode| -> Conversion {
                read += 1;
                code(read - 1).into()
            })
            .start()?;
        let (mut client, _) = Client::connect(&device.address().into())?;
        client.stream(true)?;
        let (start, mut soak) = (Instant::now(), Self::default());
        let mut host: Option<Host> = None;
        while soak.ticks < ticks {
            let batch = client.samples(PATIENCE)?.ok_or(SoakError::Silent)?;
            let host = match &mut host {
                Some(host) => host,
                none => {
                    let codes: Vec<u16> = batch.samples.iter().map(|sample| sample.code).collect();
                    none.insert(Host::new(batch.first, &codes)?)
                }
            };
            let gap = batch.first.wrapping_sub(host.next);
            host.skip(gap);
            soak.missing += gap;
            for sample in &batch.samples {
                let (AdcCode(code), estimate) = host.tick();
                let same = sample.code == code
                    && sample.displacement.to_bits() == estimate.displacement.to_bits()
                    && sample.dac == estimate.dac.0
                    && sample.status == estimate.status;
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

/// The host's own estimator, tick by tick as the device's.
struct Host {
    estimator: Estimator<f32>,
    /// The converter's tick at the estimator's first.
    origin: u32,
    /// The number of the next tick.
    next: u32,
}

impl Host {
    /// Up to the first sample, which has this number.
    fn new(first: u32, codes: &[u16]) -> Result<Self, SoakError> {
        let codes = &codes[..codes.len().min(CODES)];
        let here = |at: &u32| (*at..).zip(codes).all(|(at, found)| code(at).0 == *found);
        let found = (first..first.saturating_add(FARTHEST)).find(here).ok_or(SoakError::Strange)?;
        let estimator = Estimator::new(&TABLE.admit()?);
        let mut host = Self { estimator, origin: found - first, next: 0 };
        host.skip(first);
        Ok(host)
    }

    fn skip(&mut self, ticks: u32) {
        for _ in 0..ticks {
            self.tick();
        }
    }

    fn tick(&mut self) -> (AdcCode, Estimate<f32>) {
        let code = code(self.origin.wrapping_add(self.next));
        self.next = self.next.wrapping_add(1);
        (code, self.estimator.tick(code))
    }
}
