//! A wanted trajectory to a device whose DAC drives the amplifier, at the device's own pace, and its estimates back.

use super::client::Client;
use super::error::LinkError;
use super::interrupt::Interrupt;
use super::window::{Numbers, Sequel};
use anyhow::{Result, bail, ensure};
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
) -> Result<Followed> {
    client.set_mode(Mode::Follow)?;
    client.stream(true)?;
    let mut followed = Followed::default();
    let mut numbers = Numbers::default();
    let (mut sent, mut going, mut news) = (0, false, Instant::now());
    while followed.samples.len() < ticks && followed.stopped.is_empty() {
        ensure!(!interrupt.wanted(), "interrupted after {} of {ticks} ticks", followed.samples.len());
        let next = &references[sent..references.len().min(sent + CHUNK)];
        let mut full = next.is_empty();
        // It goes once its queue is full, or holds all.
        if !full || !going {
            let chunk: References = next.iter().copied().collect();
            going |= sent + next.len() == references.len();
            let (taken, starved) = match client.refer(chunk, going, hold) {
                Err(LinkError::Unknown { .. }) => bail!(
                    "a reply was lost, so that nobody knows which references the device has taken: after {} of {ticks} ticks",
                    followed.samples.len()
                ),
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
                Sequel::Follows => {}
                Sequel::Lost(lost) => {
                    bail!("{lost} samples were lost: is the cable sound, and this machine not too busy?")
                }
                Sequel::Anew => bail!("the device was restarted, or its mode set by somebody else"),
            }
            take(&mut followed, &batch.samples, ticks);
            progress(followed.samples.len());
            news = Instant::now();
            patience = Duration::ZERO;
        }
        ensure!(news.elapsed() < SILENCE, "the device gives nothing any more: look at it with `piezo info`");
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
    use crate::device::fake::{Fake, Manners};

    fn run(manners: Manners) -> Result<Followed> {
        let fake = Fake::start(Manners { drives: true, ..manners });
        let (mut client, _) = fake.connect();
        let wave: Vec<f32> = (0..1000).map(|k| 20.0 + 5.0 * (k as f32 * 0.02).sin()).collect();
        follow(&mut client, &wave, true, 1000, &Interrupt::default(), &mut |_| {})
    }

    #[test]
    fn every_reference_gives_a_sample() {
        let followed = run(Manners::default()).unwrap();
        assert_eq!((followed.samples.len(), followed.starved, followed.stopped), (1000, 0, Faults::empty()));
        let last = followed.samples.last().unwrap().displacement;
        assert!((last - (20.0 + 5.0 * (999f32 * 0.02).sin())).abs() < 1.0, "{last}");
    }

    #[test]
    fn a_fault_ends_it_and_hunger_is_told() {
        let followed = run(Manners { faulty_from: Some(300), starved: 7, ..Manners::default() }).unwrap();
        assert_eq!(followed.samples.len(), 300);
        assert_eq!((followed.starved, followed.stopped), (7, Faults::ADC_SATURATED | Faults::SAFE_OUTPUT));
    }

    #[test]
    fn what_is_odd_before_the_first_reference_ends_nothing_but_an_unsafe_fault_does() {
        let sample = |faults| Sample { code: 1, displacement: 0.0, dac: 0, status: Default::default(), faults };
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
        let fake = Fake::start(Manners::default());
        let (mut client, _) = fake.connect();
        let refused = follow(&mut client, &[1.0], true, 1, &Interrupt::default(), &mut |_| {}).unwrap_err().to_string();
        assert!(refused.contains("--drive-span"), "{refused}");
        let lost = run(Manners { lose_samples_from: Some(500), ..Manners::default() }).unwrap_err().to_string();
        assert!(lost.contains("samples were lost"), "{lost}");
    }
}
