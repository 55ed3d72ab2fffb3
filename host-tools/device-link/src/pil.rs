//! Processor in the loop: codes in over the link, the device's estimates back, tick for tick beside the host's f32
//! core. On the way both are told a displacement, so that bias and interval are compared, too.

use super::client::Client;
use super::error::LinkError;
use super::interrupt::Interrupt;
use super::words;
use estimator_core::{AdcCode, Admitted, Estimator, Status};
use protocol::{Codes, MOST_VALUES, Mode, Sample};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Ticks after which a displacement is told, or as soon as the table allows; and what is told, µm.
const TOLD: usize = 1_000;
const TOLD_UM: f32 = 0.5;
/// How often it is told again where no reply came and nothing was done.
const TELLS: u32 = 3;
/// Codes under way or waiting in the device: its queues hold 255 each way, and the link adds some milliseconds.
const OUTSTANDING: usize = 200;
/// A device that returns nothing for so long has stopped.
const SILENCE: Duration = Duration::from_secs(5);
/// After this long without a sample, all that were under way have come: the queue is empty in 128 ms at 2 kHz, in 256
/// at 1 kHz.
const SETTLED: Duration = Duration::from_millis(400);
/// How long to wait for samples before something else is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// What a tick gave.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct TickResult {
    /// The device's displacement, µm.
    pub displacement_um: f32,
    /// The bits of that f32.
    pub bits: u32,
    /// Half-width of its interval, µm; `None` where there is none.
    pub half_width_um: Option<f32>,
    /// The status beside it.
    #[serde(serialize_with = "words::serialize_status")]
    pub status: Status,
}

/// One tick on which host and device do not agree.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Difference {
    /// The tick, from 0.
    pub tick: usize,
    /// The code fed.
    pub code: u16,
    /// What the host gave.
    pub host: TickResult,
    /// What the device gave.
    pub device: TickResult,
}

/// All ticks of a log, host beside device.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Comparison {
    /// Ticks that were compared.
    pub ticks: usize,
    /// Ticks on which every bit of displacement, interval and status is the same.
    pub identical: usize,
    /// Ticks with an interval.
    pub with_interval: usize,
    /// The first tick on which one is not.
    pub first_difference: Option<Difference>,
    /// Largest difference of the displacements, µm.
    pub max_difference_um: f32,
    /// Every status bit that the host raised.
    #[serde(serialize_with = "words::serialize_status")]
    pub status: Status,
}

impl Comparison {
    /// Whether every bit of every tick is the host's.
    pub fn bit_exact(&self) -> bool {
        self.identical == self.ticks
    }
}

/// Why codes were not fed to their end.
#[derive(Debug, thiserror::Error)]
pub enum FeedError {
    /// The link fails, or the device refuses.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The user does not want to wait.
    #[error("interrupted after {done} of {ticks} ticks")]
    Interrupted {
        /// How many ticks had been done.
        done: usize,
        /// How many ticks were asked for.
        ticks: usize,
    },
    /// Neither samples nor errors come.
    #[error("the device gives nothing any more, after {done} of {ticks} ticks")]
    Silent {
        /// How many ticks had been done.
        done: usize,
        /// How many ticks were asked for.
        ticks: usize,
    },
    /// Samples were lost: nothing can be compared.
    #[error(
        "the link lost samples: after tick {expected} came tick {came}. Nothing can be compared; is the cable sound, and \
         this machine not too busy? Try again"
    )]
    SamplesLost {
        /// The tick that should have come.
        expected: usize,
        /// The tick that came.
        came: u32,
    },
    /// More samples came than codes were fed.
    #[error(
        "the device gave more samples than the {fed} codes it was fed: is its firmware built from the sources of this \
         program?"
    )]
    Unasked {
        /// Codes that were fed before.
        fed: usize,
    },
}

/// The tick before which a displacement is told.
fn told_at(table: &Admitted) -> usize {
    let earliest = table.interval.map_or(0.0, |interval| interval.earliest_s / table.sample_period::<f32>());
    TOLD.max(earliest.ceil() as usize + 1)
}

/// Feeds codes to the device at its own pace and collects what it gives. It is left in [`Mode::Pil`], streaming.
///
/// # Errors
/// The link fails or loses samples, the device stops, or the user does not want to wait.
pub fn feed(
    client: &mut Client,
    table: &Admitted,
    codes: &[AdcCode],
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Vec<Sample>, FeedError> {
    client.set_mode(Mode::Pil)?;
    client.stream(true)?;
    let mut samples: Vec<Sample> = Vec::with_capacity(codes.len());
    let mut fed = 0;
    let told_at = told_at(table);
    let mut untold = true;
    let mut news = Instant::now();
    while samples.len() < codes.len() {
        let (done, ticks) = (samples.len(), codes.len());
        if interrupt.wanted() {
            return Err(FeedError::Interrupted { done, ticks });
        }
        if untold && samples.len() == told_at {
            tell(client)?;
            untold = false;
        }
        // What is fed before it is told has to have been run through.
        let end = if untold { codes.len().min(told_at) } else { codes.len() };
        let next = &codes[fed..end.min(fed + MOST_VALUES)];
        let fits = !next.is_empty() && fed - samples.len() + next.len() <= OUTSTANDING;
        if fits {
            // Cannot fail: no more than fit.
            let chunk: Codes = next.iter().map(|code| code.0).collect();
            fed = match client.feed(chunk) {
                Ok(taken) => fed + taken.min(next.len()),
                Err(LinkError::Unknown { .. }) => settle(client, &mut samples, fed + next.len())?,
                Err(error) => return Err(error.into()),
            };
        }
        if collect(client, &mut samples, fed, if fits { Duration::ZERO } else { LOOK })? {
            news = Instant::now();
            progress(samples.len());
        }
        if news.elapsed() >= SILENCE {
            return Err(FeedError::Silent { done: samples.len(), ticks });
        }
    }
    Ok(samples)
}

/// Calls the displacement of now [`TOLD_UM`].
fn tell(client: &mut Client) -> Result<(), LinkError> {
    let mut told = client.set_zero(TOLD_UM);
    for _ in 1..TELLS {
        match told {
            Err(LinkError::Unknown { .. }) if client.health()?.bias_age_ticks.is_some() => return Ok(()),
            Err(LinkError::Unknown { .. }) => told = client.set_zero(TOLD_UM),
            known => return known,
        }
    }
    told
}

/// Takes the samples that come within `patience`, of `fed` codes at most; returns whether any did.
fn collect(client: &mut Client, samples: &mut Vec<Sample>, fed: usize, patience: Duration) -> Result<bool, FeedError> {
    let mut patience = patience;
    let mut any = false;
    while let Some(batch) = client.samples(patience)? {
        let expected = samples.len();
        if batch.first as usize != expected {
            return Err(FeedError::SamplesLost { expected, came: batch.first });
        }
        if expected + batch.samples.len() > fed {
            return Err(FeedError::Unasked { fed });
        }
        samples.extend(batch.samples);
        patience = Duration::ZERO;
        any = true;
    }
    Ok(any)
}

/// Finds out how many codes the device has taken when the reply that would say so was lost: it answers in order, so
/// that it has taken those codes or never will, and each one taken gives a sample.
fn settle(client: &mut Client, samples: &mut Vec<Sample>, fed: usize) -> Result<usize, FeedError> {
    client.health()?;
    while collect(client, samples, fed, SETTLED)? {}
    Ok(samples.len())
}

/// Runs the host's f32 core on the same codes and compares.
pub fn compare(table: &Admitted, codes: &[AdcCode], samples: &[Sample]) -> Comparison {
    let mut estimator = Estimator::<f32>::new(table);
    let mut comparison = Comparison {
        ticks: samples.len(),
        identical: 0,
        with_interval: 0,
        first_difference: None,
        max_difference_um: 0.0,
        status: Status::empty(),
    };
    let told_at = told_at(table);
    for (tick, (&code, sample)) in codes.iter().zip(samples).enumerate() {
        if tick == told_at {
            estimator.set_zero(TOLD_UM);
        }
        let mut estimate = estimator.tick(code);
        if table.drive.is_some() {
            // The device's DAC shows no displacement then.
            estimate.status.remove(Status::DAC_SATURATED);
        }
        let gave = |displacement_um: f32, half_width_um, status| TickResult {
            displacement_um,
            bits: displacement_um.to_bits(),
            half_width_um,
            status,
        };
        let host = gave(estimate.displacement, estimate.half_width, estimate.status);
        let device = gave(sample.displacement, sample.half_width, sample.status);
        comparison.status |= host.status;
        comparison.with_interval += usize::from(host.half_width_um.is_some());
        let bits = |width: Option<f32>| width.map(f32::to_bits);
        let same = host.bits == device.bits && bits(host.half_width_um) == bits(device.half_width_um);
        if same && host.status == device.status && sample.code == code.0 {
            comparison.identical += 1;
        } else {
            comparison.first_difference.get_or_insert(Difference { tick, code: code.0, host, device });
            let apart = (host.displacement_um - device.displacement_um).abs();
            // A NaN is the largest of all, and stays.
            if apart.is_nan() || apart > comparison.max_difference_um {
                comparison.max_difference_um = apart;
            }
        }
    }
    comparison
}

#[cfg(test)]
mod tests;
