//! What is streamed where the line does not carry every tick: the ticks whose numbers are multiples of n. What those
//! between reported is not lost: the next sample that is streamed reports it, too.

use crate::rate::STREAM_EVERY;
use estimator_core::Status;
use protocol::{Faults, Sample};

/// The stream of this image.
pub type Streamed = Decimation<{ STREAM_EVERY.get() as u32 }>;

/// Of every `EVERY` ticks one.
#[derive(Clone, Debug, Default)]
pub struct Decimation<const EVERY: u32> {
    status: Status,
    faults: Faults,
}

impl<const EVERY: u32> Decimation<EVERY> {
    /// Every tick is streamed.
    pub const ALL: bool = EVERY == 1;

    /// Whether the tick of this number is streamed.
    #[inline]
    pub fn has(number: u32) -> bool {
        Self::ALL || number.is_multiple_of(EVERY)
    }

    /// Takes a tick's sample; gives the one to be streamed, if it is this tick's turn.
    #[inline]
    pub fn take(&mut self, number: u32, sample: Sample) -> Option<Sample> {
        let (status, faults) = (self.status | sample.status, self.faults | sample.faults);
        let streamed = Self::has(number);
        // Where the output stands is no event: the sample says where it stands at its own tick.
        *self =
            if streamed { Self::default() } else { Self { status, faults: faults.difference(Faults::SAFE_OUTPUT) } };
        streamed.then_some(Sample { status, faults, ..sample })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(status: Status, faults: Faults) -> Sample {
        Sample { code: 7, sensor: None, displacement: 0.0, half_width: None, dac: 0, status, faults }
    }

    #[test]
    fn every_fourth_says_what_those_before_reported_and_where_the_output_stands_now() {
        let mut decimation = Decimation::<4>::default();
        let mut take = |number, status, faults| decimation.take(number, sample(status, faults));
        let (none, fine) = (Status::empty(), Faults::empty());
        assert!(take(0, none, fine).is_some());
        assert!(take(1, Status::CLAMPED, Faults::MISSED_DEADLINE | Faults::SAFE_OUTPUT).is_none());
        // Two ticks did not come.
        let streamed = take(4, Status::UNTRAINED, fine).expect("its turn");
        assert_eq!((streamed.status, streamed.faults), (Status::CLAMPED | Status::UNTRAINED, Faults::MISSED_DEADLINE));
        assert!((5..8).all(|number| take(number, none, Faults::SAFE_OUTPUT).is_none()));
        assert_eq!(
            take(8, none, Faults::SAFE_OUTPUT).map(|of| (of.status, of.faults)),
            Some((none, Faults::SAFE_OUTPUT))
        );
    }

    #[test]
    fn where_every_tick_is_streamed_each_is_what_it_is() {
        let mut decimation = Decimation::<1>::default();
        for (number, status) in [(3, Status::CLAMPED), (4, Status::empty())] {
            let sample = sample(status, Faults::empty());
            assert_eq!(decimation.take(number, sample), Some(sample));
        }
    }
}
