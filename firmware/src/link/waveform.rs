//! The waveform that is loaded and played.

use super::device::Device;
use super::loaded::Loaded;
use crate::queues::Command;
use embedded_storage_async::nor_flash::NorFlash;
use protocol::waveform::checksum;
use protocol::{MOST_POINTS, Mode, Playback, References, Refusal, Reply};

impl<F: NorFlash> Device<'_, F> {
    pub(super) fn load(&mut self, first: u16, points: &References) -> Reply {
        if self.telemetry.plays() {
            return Reply::Refused(Refusal::Playing);
        }
        if self.to_be_obeyed() {
            return Reply::Refused(Refusal::Busy);
        }
        if !points.iter().all(|point| point.is_finite()) {
            return Reply::Refused(Refusal::NotFinite);
        }
        let (start, loaded) = (usize::from(first), &mut self.waveform);
        let end = start + points.len();
        if end > MOST_POINTS {
            return Reply::Refused(Refusal::TooManyPoints);
        }
        if first <= loaded.count {
            (start..).zip(points).for_each(|(at, &um)| loaded.points.set(at, um));
            // At most `MOST_POINTS`.
            loaded.count = end as u16;
        }
        Reply::Loaded(loaded.count)
    }

    pub(super) async fn play(&mut self, how: Playback) -> Result<(), Refusal> {
        if how.on_trigger && !self.facts.has_trigger {
            return Err(Refusal::NoTriggerInput);
        }
        let Loaded { points, count, played } = self.waveform;
        if self.telemetry.plays() {
            return if played == Some(how) { Ok(()) } else { Err(Refusal::Playing) };
        }
        if self.to_be_obeyed() {
            return Err(Refusal::Busy);
        }
        if how.points.get() != count || checksum(points.first(count.into())) != how.crc {
            return Err(Refusal::NotLoaded { points: count });
        }
        let done = self.begin(Mode::Waveform, Command::Play(how)).await;
        // With the queue empty before, busy is only a tick that has not come yet: it will play this when it comes.
        if matches!(done, Ok(()) | Err(Refusal::Busy)) {
            self.waveform.played = Some(how);
        }
        done
    }

    /// Whether the tick has not yet taken all that it was told: a waveform may be among it.
    fn to_be_obeyed(&self) -> bool {
        !self.queues.commands.is_empty()
    }
}
