//! The mean estimate over one full cycle of the voltage, from the device's samples as they come: what a sensor's mean,
//! or the middle of two stops, is compared with.
//!
//! A full cycle has three reversals of the voltage, each a retreat by a quarter of its span so far ([`first_cycle`]).
//! The mean is taken from the voltage's middle between the first and the second to where it comes there again behind
//! the third: a reversal's own place is what the noise makes of a flat top, and there the displacement is farthest from
//! its mean. A cycle that spans less than [`LEAST_SPAN`] is noise or ripple, and none.

use super::client::Client;
use super::error::LinkError;
use super::interrupt::Interrupt;
use super::streamed::{estimate_at, status_at};
use super::window::{Continuity, Numbers, samples_in};
use super::words;
use estimator_core::{AdcCalibration, AdcCode, Admitted, Range, Status};
use log_survey::reversals::first_cycle;
use protocol::{Faults, Sample};
use serde::Serialize;
use std::num::NonZeroU8;
use std::time::{Duration, Instant};

/// Part of the table's voltage range that a cycle spans at least.
pub const LEAST_SPAN: f64 = 0.05;
/// Status bits with which an estimate is not the model's at the amplifier's voltage. One that is not settled is: what
/// the start has left in it is what a mean over a cycle takes off.
pub const WORTHLESS: Status =
    Status::ADC_SATURATED.union(Status::VOLTAGE_OUT_OF_RANGE).union(Status::CLAMPED).union(Status::SLEW_EXCEEDED);

/// A device that returns nothing for so long has stopped.
const SILENCE: Duration = Duration::from_secs(2);
/// How often the wish to end is looked at.
const LOOK: Duration = Duration::from_millis(100);
/// A cycle is looked for again when this part more samples have come, so that a long wait costs little.
const MORE: usize = 50;

/// Which cycle is waited for.
#[derive(Clone, Copy, Debug)]
pub struct CycleRequest {
    /// Codes to volts.
    pub calibration: AdcCalibration,
    /// What a cycle spans at least, V.
    pub least_span_v: f64,
    /// Length of a tick, µs.
    pub tick_us: u32,
    /// How long a cycle is waited for, s of the device.
    pub wait_s: f64,
}

impl CycleRequest {
    /// A cycle of a device that runs this table, waited for so long, s of the device.
    pub fn new(table: &Admitted, wait_s: f64) -> Self {
        let least_span_v = LEAST_SPAN * f64::from(table.voltage_range_v.span());
        Self { calibration: table.adc, least_span_v, tick_us: table.sample_period_us, wait_s }
    }

    /// Ticks after which no cycle is waited for any more.
    fn ticks(&self) -> u64 {
        (self.wait_s * 1e6 / f64::from(self.tick_us)).round() as u64
    }
}

/// One full cycle.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Cycle {
    /// Its length, ticks.
    pub ticks: usize,
    /// Mean displacement over it, µm.
    pub mean_um: f64,
    /// The voltages between which it went, V.
    pub voltage_v: Range<f64>,
    /// Every status bit.
    #[serde(serialize_with = "words::serialize_status")]
    pub status: Status,
}

/// Why there is no mean over a cycle.
#[derive(Debug, thiserror::Error)]
pub enum CycleError {
    /// The link fails.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The user does not want to wait.
    #[error("interrupted before the voltage had made a full cycle")]
    Interrupted,
    /// The voltage made none.
    #[error(
        "the voltage made no full cycle within {wait_s} s: it spanned {span_v:.4} V, and a cycle has three reversals and \
         spans {least_span_v:.4} V at least"
    )]
    NoCycle {
        /// How long was waited, s of the device.
        wait_s: f64,
        /// What the voltage spanned meanwhile, V.
        span_v: f64,
        /// What a cycle spans at least, V.
        least_span_v: f64,
    },
    /// Samples were lost.
    #[error("{0} samples were lost, so that the mean is not known: is the cable sound, and this machine not too busy?")]
    SamplesLost(u64),
    /// The device counts from 0 again.
    #[error("the device was restarted, or its mode set by somebody else")]
    Restarted,
    /// No samples come any more.
    #[error("the device sends no samples any more")]
    Silent,
    /// The estimate is of no use, or starts anew afterwards.
    #[error("the device has a fault: {}", words::list(words::faults(*.0).map(|(_, what)| what)))]
    Faulty(Faults),
    /// The estimate was not the model's somewhere in the cycle.
    #[error("the mean over the cycle says nothing: {}", words::list(words::status(*.0).map(|(_, what)| what)))]
    Worthless(Status),
}

/// Streams samples without a gap until the voltage has made a full cycle. The stream is stopped afterwards.
///
/// # Errors
/// There is no cycle in time, or what it would be found in is not sound; the link fails; or the user does not
/// want to wait.
pub fn over_cycle(
    client: &mut Client,
    request: &CycleRequest,
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Cycle, CycleError> {
    client.stream(true)?;
    let found = find(client, request, interrupt, progress);
    // A device that no longer answers has been reported already.
    let stopped = client.stream(false);
    let cycle = found?;
    stopped?;
    Ok(cycle)
}

/// What has come, sample by sample.
#[derive(Default)]
struct Heard {
    /// Voltages of the cycle, V.
    voltage: Vec<f64>,
    /// The estimate, µm.
    estimated: Vec<f32>,
    /// What was said of it: the status of the sample before.
    status: Vec<Status>,
    /// The last sample.
    last: Option<Sample>,
}

impl Heard {
    fn take(&mut self, sample: Sample, every: NonZeroU8, calibration: &AdcCalibration) -> Result<(), CycleError> {
        let wrong = sample.faults & Faults::UNSAFE;
        if !wrong.is_empty() {
            return Err(CycleError::Faulty(wrong));
        }
        if let Some(before) = self.last.replace(sample) {
            self.voltage.push(calibration.voltage(AdcCode(sample.code)));
            self.estimated.push(estimate_at(&before, &sample, every));
            self.status.push(status_at(&before, &sample, every));
        }
        Ok(())
    }

    /// The first full cycle, of samples so many ticks apart.
    fn cycle(&self, least_span_v: f64, every: usize) -> Option<Cycle> {
        let cycle = between_middles(&self.voltage, first_cycle(&self.voltage, least_span_v)?)?;
        let (voltage, estimated) = (&self.voltage[cycle.clone()], &self.estimated[cycle.clone()]);
        let sum: f64 = estimated.iter().copied().map(f64::from).sum();
        Some(Cycle {
            ticks: estimated.len() * every,
            mean_um: sum / estimated.len() as f64,
            voltage_v: Range::of_values(voltage.iter().copied()),
            status: self.status[cycle].iter().fold(Status::empty(), |all, status| all | *status),
        })
    }
}

/// The samples from the middle between a cycle's first two reversals to the same one behind its third; `None` as long
/// as the voltage has not come there. Where the outer two are not alike, it is the middle to the nearer of them.
fn between_middles(voltage: &[f64], reversals: std::ops::Range<usize>) -> Option<std::ops::Range<usize>> {
    let (first, third) = (*voltage.get(reversals.start)?, *voltage.get(reversals.end)?);
    let all = Range::of_values(voltage[reversals.clone()].iter().copied());
    let falls = first > all.middle();
    let middle = 0.5 * if falls { all.min + first.min(third) } else { all.max + first.max(third) };
    let beyond = |&at: &usize| (voltage[at] > middle) != falls;
    let from = (reversals.start..reversals.end).find(beyond)?;
    Some(from..(reversals.end..voltage.len()).find(beyond)?)
}

fn find(
    client: &mut Client,
    request: &CycleRequest,
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Cycle, CycleError> {
    let (mut heard, mut numbers) = (Heard::default(), Numbers::default());
    let (mut look, mut news) = (0, Instant::now());
    loop {
        if interrupt.wanted() {
            return Err(CycleError::Interrupted);
        }
        let Some(batch) = client.samples(LOOK)? else {
            if news.elapsed() > SILENCE {
                return Err(CycleError::Silent);
            }
            continue;
        };
        news = Instant::now();
        match numbers.take(&batch) {
            Continuity::Contiguous => {}
            Continuity::Gap(ticks) => return Err(CycleError::SamplesLost(samples_in(ticks, &batch))),
            Continuity::Restarted => return Err(CycleError::Restarted),
        }
        for sample in batch.samples {
            heard.take(sample, batch.every, &request.calibration)?;
        }
        let every = usize::from(batch.every.get());
        let ticks = heard.voltage.len() * every;
        progress(ticks);
        let late = ticks as u64 >= request.ticks();
        if late || ticks >= look {
            look = ticks + ticks / MORE;
            match heard.cycle(request.least_span_v, every) {
                Some(cycle) if cycle.status.intersects(WORTHLESS) => {
                    return Err(CycleError::Worthless(cycle.status & WORTHLESS));
                }
                Some(cycle) => return Ok(cycle),
                None => {}
            }
        }
        if late {
            let &CycleRequest { wait_s, least_span_v, .. } = request;
            let span_v = Range::of_values(heard.voltage.iter().copied()).span().max(0.0);
            return Err(CycleError::NoCycle { wait_s, span_v, least_span_v });
        }
    }
}

#[cfg(test)]
mod tests;
