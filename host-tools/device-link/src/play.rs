//! What a device whose DAC drives the amplifier is to go through, at its own pace, and its samples back: wanted
//! displacements ([`Mode::Follow`]), or voltages ([`Mode::Excite`]).

use super::client::Client;
use super::error::LinkError;
use super::interrupt::Interrupt;
use super::streamed::Streamed;
use super::window::{Continuity, Numbers, samples_in};
use protocol::{Faults, MOST_VALUES, Mode, References, Refusal, Samples};
use std::time::{Duration, Instant};

/// A device that returns nothing for so long has stopped.
const SILENCE: Duration = Duration::from_secs(5);
/// How long to wait for samples before something else is looked at: half a frame of references at 2 kHz.
const LOOK: Duration = Duration::from_millis(16);

/// What is to be gone through.
#[derive(Clone, Copy, Debug)]
pub struct Play<'r> {
    /// One that drives; it says what the references are.
    pub mode: Mode,
    /// Go on from a play before that holds its last reference. Else the mode is set, and it starts from rest.
    pub goes_on: Option<Held>,
    /// µm in [`Mode::Follow`], V in [`Mode::Excite`], one a tick.
    pub references: &'r [f32],
    /// The last reference is held, a displacement for ever, a voltage for as long as the host speaks; without it, as
    /// each one before the last, for a second.
    pub hold: bool,
    /// Ticks that are wanted, from the first reference on, and one more for each that finds no reference.
    pub ticks: usize,
}

/// Where a play holds its last reference: the number of the tick that would have taken the next one, had none been
/// starved since the mode was entered. Each that is starved puts it off by one.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Held(u32);

/// What came of it.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Played {
    /// Ticks whose samples were handed over, those between samples among them.
    pub ticks: usize,
    /// Ticks that found no reference and held the last one.
    pub starved: u32,
    /// What sent the drive back to rest before the end; empty where nothing did.
    pub stopped: Faults,
    /// Whoever took the samples had enough before the end.
    pub enough: bool,
    /// Where another play may go on.
    pub held: Held,
}

/// Why it was not gone through to its end.
#[derive(Debug, thiserror::Error)]
pub enum PlayError {
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
    /// Samples were lost.
    #[error("{0} samples were lost: is the cable sound, and this machine not too busy?")]
    SamplesLost(u64),
    /// The device has left the mode, as it does where its host is silent for so long.
    #[error(
        "the device heard nothing of this machine for five seconds, or another program set its mode: its voltage went to rest"
    )]
    LetGo,
    /// The device counts from 0 again.
    #[error("the device was restarted, or its mode set by somebody else")]
    Restarted,
    /// Neither samples nor errors come.
    #[error("the device gives nothing any more")]
    Silent,
}

/// Sends references and hands each sample to `take`, from the first one on, until all ticks are over, a fault stops the
/// drive, or `take` answers `false`. The device is left in the mode, at the last reference. Of a play that goes on, the
/// samples of the hold before its own first reference are passed over; the first of its own need not be of its first
/// reference where the device streams every n-th tick only.
///
/// # Errors
/// The link fails or loses samples, the device stops, refuses, or the user does not want to wait.
pub fn play(
    client: &mut Client,
    play: &Play<'_>,
    interrupt: &Interrupt,
    take: &mut dyn FnMut(&Streamed) -> bool,
) -> Result<Played, PlayError> {
    let &Play { mode, goes_on, references, hold, ticks: wanted } = play;
    if goes_on.is_none() {
        client.set_mode(mode)?;
    }
    client.stream(true)?;
    // The number that the device gives the first reference.
    let (begin, _) = client.refer(0, References::new(), false, false).map_err(let_go)?;
    let mut played = Played::default();
    let mut numbers = Numbers::default();
    let (mut sent, mut going, mut news) = (0, goes_on.is_some(), Instant::now());
    // Ticks that had found none before: those between this play and the one that it goes on from.
    let mut starved_before = if goes_on.is_some() { None } else { Some(0) };
    // The number of the tick that takes the first reference; of a play from rest, its sample shows it.
    let mut first = None;
    let mut ticks = wanted;
    // Before all is sent nobody knows how many ticks find nothing: no sample is one too many.
    let end = |sent: usize, ticks: usize| if sent < references.len() { usize::MAX } else { ticks };
    while played.ticks < end(sent, ticks) && played.stopped.is_empty() && !played.enough {
        let done = played.ticks;
        if interrupt.wanted() {
            return Err(PlayError::Interrupted { done, ticks });
        }
        let next = &references[sent..references.len().min(sent + MOST_VALUES)];
        let mut full = next.is_empty();
        // It goes once its queue is full, or holds all.
        if !full || !going {
            let chunk: References = next.iter().copied().collect();
            // Nothing but the end is held: a host that dies on the way is waited for for a second.
            let last = sent + next.len() == references.len();
            going |= last;
            let from = begin.wrapping_add(sent as u32);
            let (needed, starved) = client.refer(from, chunk, going, hold && last).map_err(let_go)?;
            let taken = needed.wrapping_sub(begin) as usize;
            if !(sent..=sent + next.len()).contains(&taken) {
                return Err(PlayError::Restarted);
            }
            full = taken < sent + next.len();
            going |= full;
            sent = taken;
            let before = *starved_before.get_or_insert(starved);
            first = first.or(goes_on.map(|Held(next)| next.wrapping_add(before)));
            played.starved = starved.saturating_sub(before);
            ticks = wanted + played.starved as usize;
        }
        // What has come is taken in any case; a full queue leaves the time to wait for more.
        let mut patience = if full { LOOK } else { Duration::ZERO };
        while let Some(batch) = client.samples(patience)? {
            match numbers.take(&batch) {
                Continuity::Contiguous => {}
                Continuity::Gap(ticks) => return Err(PlayError::SamplesLost(samples_in(ticks, &batch))),
                Continuity::Restarted => return Err(PlayError::Restarted),
            }
            played.take(&batch, &mut first, end(sent, ticks), take);
            if let Some(first) = first {
                let own = first.wrapping_add(sent as u32);
                played.held = Held(own.wrapping_sub(starved_before.unwrap_or(0)));
            }
            news = Instant::now();
            patience = Duration::ZERO;
        }
        if news.elapsed() >= SILENCE {
            return Err(PlayError::Silent);
        }
    }
    Ok(played)
}

/// What it means that no reference is taken in a mode that took them.
fn let_go(error: LinkError) -> PlayError {
    match error {
        LinkError::Refused { refusal, .. } if *refusal == Refusal::NotFollowing => PlayError::LetGo,
        error => error.into(),
    }
}

impl Played {
    /// Takes what is from the tick `first` on; where that is not known, the drive starts from rest, and its first
    /// sample that is not of the rest is the first.
    fn take(
        &mut self,
        batch: &Samples,
        first: &mut Option<u32>,
        ticks: usize,
        take: &mut dyn FnMut(&Streamed) -> bool,
    ) {
        let every = batch.every;
        for (number, &sample) in batch.numbered() {
            let resting = sample.faults.contains(Faults::SAFE_OUTPUT);
            let waiting = first.is_none() && !sample.faults.intersects(Faults::UNSAFE);
            if resting && !waiting {
                self.stopped = sample.faults;
                return;
            }
            // At rest before the first reference, or still held by the play before.
            if resting {
                continue;
            }
            let Ok(tick) = usize::try_from(number.wrapping_sub(*first.get_or_insert(number)) as i32) else { continue };
            if tick < ticks && !self.enough {
                self.ticks = tick + usize::from(every.get());
                self.enough = !take(&Streamed { tick, every, sample });
            }
        }
    }
}

#[cfg(test)]
mod tests;
