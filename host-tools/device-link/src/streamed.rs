//! A streamed sample and the tick that it is of. Its displacement is that of the tick after it, which is not the next
//! sample's where the device streams every n-th tick only.

use estimator_core::Status;
use protocol::Sample;
use std::num::NonZeroU8;

/// A sample of a play.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Streamed {
    /// Ticks since the one that took the first reference.
    pub tick: usize,
    /// Ticks from a sample to the next.
    pub every: NonZeroU8,
    /// What the device says of that tick, and of the displacement at the next.
    pub sample: Sample,
}

impl Streamed {
    /// The estimate of this sample's own tick, µm, where the sample before it is known.
    pub fn estimate(&self, before: &Sample) -> f32 {
        estimate_at(before, &self.sample, self.every)
    }

    /// What was reported of that estimate.
    pub fn status(&self, before: &Sample) -> Status {
        status_at(before, &self.sample, self.every)
    }
}

/// The estimate (µm) of a sample's own tick: what the sample before it says where every tick is streamed, else on the
/// straight line from that to what the sample itself says, which is of the tick after.
pub fn estimate_at(before: &Sample, now: &Sample, every: NonZeroU8) -> f32 {
    // Exact where every tick is streamed.
    of_tick_before(before.displacement.into(), now.displacement.into(), every) as f32
}

/// What was reported of the estimate of a sample's own tick: by the sample before it where every tick is streamed, else
/// by one of the two, of which the second has what the ticks between reported.
pub fn status_at(before: &Sample, now: &Sample, every: NonZeroU8) -> Status {
    if every == NonZeroU8::MIN { before.status } else { before.status | now.status }
}

/// What two samples say of the ticks after theirs, at the second one's own tick.
pub fn of_tick_before(before: f64, now: f64, every: NonZeroU8) -> f64 {
    if every == NonZeroU8::MIN { before } else { now + (before - now) / f64::from(every.get()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clamp_between_two_samples_is_one_of_the_second_s_own_tick_and_not_where_there_is_none_between() {
        let sample = |status| Sample {
            code: 0,
            sensor: None,
            displacement: 0.0,
            half_width: None,
            dac: 0,
            status,
            faults: Default::default(),
        };
        let now = |every| Streamed { tick: 8, every: NonZeroU8::new(every).unwrap(), sample: sample(Status::CLAMPED) };
        let before = sample(Status::UNTRAINED);
        assert_eq!(now(4).status(&before), Status::UNTRAINED | Status::CLAMPED);
        assert_eq!(now(1).status(&before), Status::UNTRAINED);
    }

    #[test]
    fn of_a_ramp_the_estimate_is_that_of_the_sample_s_own_tick() {
        // A µm a tick; each sample says what is a tick later.
        let sample = |tick: u8| Sample {
            code: 0,
            sensor: None,
            displacement: f32::from(tick) + 1.0,
            half_width: None,
            dac: 0,
            status: Default::default(),
            faults: Default::default(),
        };
        for every in [1, 2, 4] {
            let now = Streamed { tick: 8, every: NonZeroU8::new(every).unwrap(), sample: sample(8) };
            assert_eq!(now.estimate(&sample(8 - every)), 8.0, "{every}");
        }
    }
}
