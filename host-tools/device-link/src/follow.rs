//! A wanted trajectory to a device whose DAC drives the amplifier, at the device's own pace, and its estimates back.

use super::client::Client;
use super::error::LinkError;
use super::interrupt::Interrupt;
use super::window::{Continuity, Numbers};
use protocol::{Faults, Mode, References, Sample};
use std::time::{Duration, Instant};

/// References in one frame; [`References`] takes so many.
const CHUNK: usize = 64;
/// A device that returns nothing for so long has stopped.
const SILENCE: Duration = Duration::from_secs(5);
/// How long to wait for samples before something else is looked at: half a frame of references.
const LOOK: Duration = Duration::from_millis(16);

/// What came of it.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Followed {
    /// A sample a tick, from the tick that took the first reference on.
    pub samples: Vec<Sample>,
    /// Ticks that found no reference and held the last one.
    pub starved: u32,
    /// What sent the drive back to rest before the end; empty where nothing did.
    pub stopped: Faults,
}

/// Why a trajectory was not followed to its end.
#[derive(Debug, thiserror::Error)]
pub enum FollowError {
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
    /// A reply to references was lost.
    #[error(
        "a reply was lost, so that nobody knows which references the device has taken: after {done} of {ticks} ticks"
    )]
    ReplyLost {
        /// How many ticks had been done.
        done: usize,
        /// How many ticks were asked for.
        ticks: usize,
    },
    /// Samples were lost.
    #[error("{0} samples were lost: is the cable sound, and this machine not too busy?")]
    SamplesLost(u32),
    /// The device counts from 0 again.
    #[error("the device was restarted, or its mode set by somebody else")]
    Restarted,
    /// Neither samples nor errors come.
    #[error("the device gives nothing any more")]
    Silent,
}

/// Sends references and collects `ticks` samples from the first one on, or as many as come before a fault. The device is left
/// in [`Mode::Follow`], at the last reference, which it holds for ever with `hold` and for a second without.
///
/// # Errors
/// The link fails or loses samples, the device stops, refuses, or the user does not want to wait.
pub fn follow(
    client: &mut Client,
    references: &[f32],
    hold: bool,
    ticks: usize,
    interrupt: &Interrupt,
    progress: &mut dyn FnMut(usize),
) -> Result<Followed, FollowError> {
    client.set_mode(Mode::Follow)?;
    client.stream(true)?;
    let mut followed = Followed::default();
    let mut numbers = Numbers::default();
    let (mut sent, mut going, mut news) = (0, false, Instant::now());
    while followed.samples.len() < ticks && followed.stopped.is_empty() {
        let done = followed.samples.len();
        if interrupt.wanted() {
            return Err(FollowError::Interrupted { done, ticks });
        }
        let next = &references[sent..references.len().min(sent + CHUNK)];
        let mut full = next.is_empty();
        // It goes once its queue is full, or holds all.
        if !full || !going {
            let chunk: References = next.iter().copied().collect();
            going |= sent + next.len() == references.len();
            let (taken, starved) = match client.refer(chunk, going, hold) {
                Err(LinkError::Unknown { .. }) => return Err(FollowError::ReplyLost { done, ticks }),
                answer => answer?,
            };
            full = taken < next.len();
            going |= full;
            sent += taken.min(next.len());
            followed.starved = starved;
        }
        // What has come is taken in any case; a full queue leaves the time to wait for more.
        let mut patience = if full { LOOK } else { Duration::ZERO };
        while let Some(batch) = client.samples(patience)? {
            match numbers.take(&batch) {
                Continuity::Contiguous => {}
                Continuity::Gap(lost) => return Err(FollowError::SamplesLost(lost)),
                Continuity::Restarted => return Err(FollowError::Restarted),
            }
            take(&mut followed, &batch.samples, ticks);
            progress(followed.samples.len());
            news = Instant::now();
            patience = Duration::ZERO;
        }
        if news.elapsed() >= SILENCE {
            return Err(FollowError::Silent);
        }
    }
    Ok(followed)
}

fn take(followed: &mut Followed, samples: &[Sample], ticks: usize) {
    for sample in samples {
        let resting = sample.faults.contains(Faults::SAFE_OUTPUT);
        let waiting = followed.samples.is_empty() && !sample.faults.intersects(Faults::UNSAFE);
        if resting && !waiting {
            followed.stopped = sample.faults;
            return;
        }
        if resting {
            // Before the first reference.
            continue;
        }
        if followed.samples.len() < ticks {
            followed.samples.push(*sample);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pages;
    use crate::table::to_record;
    use emulator::faults::{lose_samples_at, messages};
    use emulator::{Direction, Emulator, Fault, FaultyLine, Plant, TABLE, amplifier};
    use estimator_core::{AdcCode, Admitted, DacCode, DriveCalibration, DriveLimits, Range, Table};
    use parameter_store::RamFlash;
    use protocol::{Refusal, Reply, ToHost};

    const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
    /// An amplifier of 0 … 4 V on the DAC's scale.
    const DRIVE: DriveCalibration =
        DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS };

    /// The device's own table, its DAC driving the amplifier.
    fn driving() -> Admitted {
        Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap()
    }

    fn wave() -> Vec<f32> {
        (0..1000).map(|k| 20.0 + 5.0 * (k as f32 * 0.02).sin()).collect()
    }

    fn sound(_: Direction, _: &mut Vec<u8>) {}

    /// Follows the wave; the device's queue of references lasts for half a second.
    fn run(plant: impl Plant, fault: impl Fault) -> Result<Followed, FollowError> {
        run_at(0.25, plant, fault)
    }

    fn run_at(speed: f64, plant: impl Plant, fault: impl Fault) -> Result<Followed, FollowError> {
        let flash = RamFlash::new(pages::with(&to_record(&driving()), 4096).unwrap());
        let device = Emulator::new().flash(flash).plant(plant).speed(speed).start().unwrap();
        let line = FaultyLine::to(device.address(), fault).unwrap();
        let (mut client, _) = Client::connect(&line.address().into()).unwrap();
        follow(&mut client, &wave(), true, 1000, &Interrupt::default(), &mut |_| {})
    }

    #[test]
    fn every_reference_gives_a_sample_and_the_voltage_of_the_core_s_inverse() {
        let followed = run(amplifier(DRIVE, TABLE.adc), sound).unwrap();
        assert_eq!((followed.samples.len(), followed.starved, followed.stopped), (1000, 0, Faults::empty()));
        let last = followed.samples.last().unwrap().displacement;
        assert!((last - (20.0 + 5.0 * (999f32 * 0.02).sin())).abs() < 1.0, "{last}");
        let mut inverse = driving().inverse::<f32>(&LIMITS).unwrap();
        for (tick, (sample, reference)) in followed.samples.iter().zip(wave()).enumerate() {
            let expected = DRIVE.code(inverse.tick(reference).voltage, TABLE.dac.full_scale);
            assert_eq!(DacCode(sample.dac), expected, "tick {tick}");
        }
    }

    #[test]
    fn a_fault_ends_it_and_starved_ticks_are_told() {
        // The ADC is saturated from the 280th tick on at which the amplifier has moved: two ticks after the first reference it
        // begins to, and after twenty saturated ticks that is a fault.
        let (mut amplifier, mut moved) = (amplifier(DRIVE, TABLE.adc), 0);
        let rest = DRIVE.code(LIMITS.rest_v, TABLE.dac.full_scale);
        let breaks = move |dac| {
            moved += u32::from(moved > 0 || dac != rest);
            let conversion = amplifier.sample(dac);
            if moved < 280 { conversion } else { AdcCode(TABLE.adc.full_scale).into() }
        };
        let starves = messages(|message| match message {
            ToHost::Reply { to, reply: Reply::Referred { taken, .. } } => {
                Some(ToHost::Reply { to, reply: Reply::Referred { taken, starved: 7 } })
            }
            other => Some(other),
        });
        let followed = run(breaks, starves).unwrap();
        assert_eq!(followed.samples.len(), 300);
        assert_eq!((followed.starved, followed.stopped), (7, Faults::ADC_SATURATED | Faults::SAFE_OUTPUT));
    }

    #[test]
    fn a_line_that_hesitates_starves_the_drive_and_the_device_counts_it() {
        let mut requests = 0;
        let hesitates = move |direction, _: &mut Vec<u8>| {
            // Every request comes behind an empty frame. Connecting and starting takes some ten; four fill the queue.
            requests += u32::from(direction == Direction::ToDevice);
            if requests == 24 {
                requests += 1;
                // Longer than the queue of references lasts at this pace, and no reason to give a reply up for lost.
                std::thread::sleep(Duration::from_millis(150));
            }
        };
        let followed = run_at(2.0, amplifier(DRIVE, TABLE.adc), hesitates).unwrap();
        assert!(followed.starved > 0);
        assert_eq!((followed.samples.len(), followed.stopped), (1000, Faults::empty()));
    }

    #[test]
    fn what_is_odd_before_the_first_reference_ends_nothing_but_an_unsafe_fault_does() {
        let sample = |faults| Sample {
            code: 1,
            sensor: None,
            displacement: 0.0,
            half_width: None,
            dac: 0,
            status: Default::default(),
            faults,
        };
        let after = |faults: &[Faults]| {
            let mut followed = Followed::default();
            take(&mut followed, &faults.iter().map(|&faults| sample(faults)).collect::<Vec<_>>(), 10);
            (followed.samples.len(), followed.stopped)
        };
        let safe = Faults::SAFE_OUTPUT;
        let none = Faults::empty();
        assert_eq!(after(&[safe, safe | Faults::MISSED_DEADLINE, safe, none, none]), (2, none));
        assert_eq!(after(&[safe, safe | Faults::ADC_STUCK, none]), (0, safe | Faults::ADC_STUCK));
        assert_eq!(after(&[none, Faults::MISSED_DEADLINE, safe]), (2, safe));
    }

    #[test]
    fn a_device_without_a_drive_and_lost_samples_are_errors() {
        let device = Emulator::new().start().unwrap();
        let (mut client, _) = Client::connect(&device.address().into()).unwrap();
        let refused = follow(&mut client, &[1.0], true, 1, &Interrupt::default(), &mut |_| {}).unwrap_err();
        let FollowError::Link(LinkError::Refused { refusal, .. }) = refused else { panic!("{refused}") };
        assert_eq!(*refusal, Refusal::NoDrive);
        let lost = run(amplifier(DRIVE, TABLE.adc), lose_samples_at(500)).unwrap_err().to_string();
        assert!(lost.contains("samples were lost"), "{lost}");
    }
}
