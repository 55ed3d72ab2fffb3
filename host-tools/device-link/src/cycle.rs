//! The mean estimate over one full cycle of the voltage, from the device's samples as they come: what a sensor's mean,
//! or the middle of two stops, is compared with.
//!
//! A full cycle is what lies between the first and the third reversal of the voltage, a retreat by a quarter of its
//! span so far ([`first_cycle`]). One that spans less than [`LEAST_SPAN`] is noise or ripple, and none.

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
        let cycle = first_cycle(&self.voltage, least_span_v)?;
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
mod tests {
    use super::*;
    use emulator::faults::{lose_samples_at, samples, silent_from};
    use emulator::{Emulator, Fault, FaultyLine, Plant, TABLE, triangle};

    /// Looks for a cycle for four seconds of the device.
    fn found(plant: impl Plant, fault: impl Fault) -> Result<Cycle, CycleError> {
        let device = Emulator::new().plant(plant).speed(8.0).start().unwrap();
        let line = FaultyLine::to(device.address(), fault).unwrap();
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        let request = CycleRequest::new(&TABLE.admit().unwrap(), 4.0);
        let found = over_cycle(&mut client, &request, &Interrupt::default(), &mut |_| {});
        assert_eq!(client.samples(Duration::from_millis(100)).unwrap(), None, "the stream was stopped");
        found
    }

    /// Lets `edit` change every sample after the first thousand.
    fn after_a_thousand(edit: impl Fn(&mut Sample) + Send + 'static) -> impl Fault {
        let mut seen = 0;
        samples(move |batch| {
            if seen > 1000 {
                batch.samples.iter_mut().for_each(&edit);
            }
            seen += batch.samples.len();
            true
        })
    }

    fn sound(_: emulator::Direction, _: &mut Vec<u8>) {}

    #[test]
    fn the_mean_over_a_cycle_is_0_once_it_is_taken_off() {
        let device = Emulator::new().speed(8.0).start().unwrap();
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let request = CycleRequest::new(&TABLE.admit().unwrap(), 4.0);
        let over_cycle = |client: &mut Client| {
            let cycle = over_cycle(client, &request, &Interrupt::default(), &mut |_| {}).unwrap();
            assert_eq!(cycle.ticks, 2_000, "the triangle's period");
            cycle
        };
        // The first may have the start in it.
        over_cycle(&mut client);
        let cycle = over_cycle(&mut client);
        assert_eq!(cycle.status, Status::empty());
        assert!(cycle.mean_um.abs() > 0.1 && cycle.voltage_v.span() > 1.0, "{cycle:?}");
        client.shift_bias(-cycle.mean_um as f32).unwrap();
        let mean_um = over_cycle(&mut client).mean_um;
        assert!(mean_um.abs() < 0.01, "{mean_um}");
    }

    #[test]
    fn noise_at_rest_is_no_cycle() {
        let mut noise = 0;
        let rest = move |_| {
            noise = 1 - noise;
            AdcCode(30_000 + 20 * noise).into()
        };
        let error = found(rest, sound).unwrap_err();
        assert!(matches!(error, CycleError::NoCycle { span_v, .. } if span_v > 0.0), "{error}");
    }

    #[test]
    fn what_is_not_whole_gives_no_mean() {
        let error = found(triangle(), lose_samples_at(1_000)).unwrap_err();
        assert!(matches!(error, CycleError::SamplesLost(lost) if lost > 0), "{error}");
        let error = found(triangle(), silent_from(1_000)).unwrap_err();
        assert!(matches!(error, CycleError::Silent), "{error}");
    }

    #[test]
    fn what_is_not_sound_gives_no_mean() {
        let error = found(triangle(), after_a_thousand(|sample| sample.faults |= Faults::ADC_STUCK)).unwrap_err();
        assert!(matches!(error, CycleError::Faulty(Faults::ADC_STUCK)), "{error}");
        for bit in WORTHLESS {
            let said = after_a_thousand(move |sample| sample.status |= bit | Status::DAC_SATURATED);
            let error = found(triangle(), said).unwrap_err();
            assert!(matches!(error, CycleError::Worthless(only) if only == bit), "{bit:?}: {error}");
        }
        let late = after_a_thousand(|sample| {
            sample.faults |= Faults::MISSED_DEADLINE | Faults::SAFE_OUTPUT;
            sample.status |= Status::NOT_SETTLED;
        });
        assert_eq!(found(triangle(), late).unwrap().status, Status::NOT_SETTLED, "and is said");
    }
}
