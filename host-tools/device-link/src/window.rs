//! The last second of a stream of samples.

use estimator_core::{AdcCalibration, AdcCode, Status};
use protocol::{Faults, Sample, Samples};
use std::collections::VecDeque;
use std::num::NonZeroU8;

/// How a frame of samples stands to the one before.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Continuity {
    /// The frame begins where the one before ended.
    Contiguous,
    /// So many ticks later.
    Gap(u32),
    /// Before it: the device counts from 0 again, since its mode was set or it was restarted.
    Restarted,
}

/// How many samples a gap of so many ticks before a frame has cost.
pub fn samples_in(ticks: u32, frame: &Samples) -> u64 {
    u64::from(ticks.div_ceil(frame.every.get().into()))
}

/// Finds gaps in the numbers of samples.
#[derive(Clone, Copy, Default, Debug)]
pub struct Numbers {
    next: Option<u32>,
}

impl Numbers {
    /// How this frame stands to the one before.
    pub fn take(&mut self, samples: &Samples) -> Continuity {
        let expected = self.next.replace(samples.end());
        match expected.map_or(0, |expected| samples.first.wrapping_sub(expected)) {
            0 => Continuity::Contiguous,
            gap if gap < 1 << 31 => Continuity::Gap(gap),
            _ => Continuity::Restarted,
        }
    }
}

/// The last second.
#[derive(Clone, Debug)]
pub struct Window {
    calibration: AdcCalibration,
    /// Ticks of a second.
    length: usize,
    samples: VecDeque<Sample>,
    numbers: Numbers,
    /// Ticks from a sample to the next.
    every: NonZeroU8,
    received: u64,
    lost: u64,
}

/// Least, last and largest.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extent {
    /// The least of the window.
    pub min: f32,
    /// The last of the window.
    pub last: f32,
    /// The largest of the window.
    pub max: f32,
}

impl Window {
    /// A window of `length` ticks.
    pub fn new(calibration: AdcCalibration, length: usize) -> Self {
        let (samples, numbers, every) = (VecDeque::new(), Numbers::default(), NonZeroU8::MIN);
        Self { calibration, length, samples, numbers, every, received: 0, lost: 0 }
    }

    /// Takes the next frame.
    pub fn take(&mut self, samples: &Samples) {
        match self.numbers.take(samples) {
            Continuity::Contiguous => {}
            Continuity::Gap(ticks) => self.lost += samples_in(ticks, samples),
            Continuity::Restarted => self.samples.clear(),
        }
        self.every = samples.every;
        self.received += samples.samples.len() as u64;
        self.samples.extend(&samples.samples);
        let surplus = self.samples.len().saturating_sub(self.length.div_ceil(samples.every.get().into()));
        self.samples.drain(..surplus);
    }

    /// Forgets the samples, but not what was counted.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Ticks from a sample to the next.
    pub fn every(&self) -> NonZeroU8 {
        self.every
    }

    /// Samples received since the start.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Samples lost since the start.
    pub fn lost(&self) -> u64 {
        self.lost
    }

    /// The last sample.
    pub fn last(&self) -> Option<&Sample> {
        self.samples.back()
    }

    /// The last so many samples, or all that there are.
    pub fn tail(&self, length: usize) -> Vec<Sample> {
        self.samples.range(self.samples.len().saturating_sub(length)..).copied().collect()
    }

    /// The last ADC code.
    pub fn code(&self) -> Option<u16> {
        self.last().map(|sample| sample.code)
    }

    /// The estimated displacement, µm.
    pub fn displacement(&self) -> Option<Extent> {
        self.extent(|sample| sample.displacement)
    }

    /// Half-width of the last estimate's 95 % interval, µm; `None` where there is none.
    pub fn half_width(&self) -> Option<f32> {
        self.samples.back().and_then(|sample| sample.half_width)
    }

    /// The measured voltage, V.
    pub fn voltage(&self) -> Option<Extent> {
        self.extent(|sample| self.calibration.voltage(AdcCode(sample.code)))
    }

    /// Every status bit.
    pub fn status(&self) -> Status {
        self.samples.iter().fold(Status::empty(), |all, sample| all | sample.status)
    }

    /// Every fault that a sample of the window had.
    pub fn faults(&self) -> Faults {
        self.samples.iter().fold(Faults::empty(), |all, sample| all | sample.faults)
    }

    fn extent(&self, of: impl Fn(&Sample) -> f32) -> Option<Extent> {
        let last = of(self.samples.back()?);
        let start = Extent { min: last, last, max: last };
        Some(self.samples.iter().map(of).fold(start, |extent, x| Extent {
            min: extent.min.min(x),
            max: extent.max.max(x),
            ..extent
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(first: u32, displacements: &[f32]) -> Samples {
        let sample = |&displacement| Sample {
            code: 100,
            sensor: None,
            displacement,
            half_width: None,
            dac: 7,
            status: Status::CLAMPED,
            faults: Faults::empty(),
        };
        Samples { first, every: NonZeroU8::MIN, samples: displacements.iter().map(sample).collect() }
    }

    #[test]
    fn gaps_are_counted_and_the_second_slides() {
        let calibration = AdcCalibration { gain_v_per_code: 0.01, offset_v: -2.0, invert: false, full_scale: 4095 };
        let mut window = Window::new(calibration, 3);
        assert_eq!(window.displacement(), None);
        window.take(&frame(10, &[9.0, 1.0]));
        window.take(&frame(12, &[3.0]));
        window.take(&frame(20, &[2.0]));
        assert_eq!((window.received(), window.lost()), (4, 7));
        assert_eq!(window.displacement(), Some(Extent { min: 1.0, last: 2.0, max: 3.0 }));
        assert_eq!(window.voltage().map(|v| v.last), Some(-1.0));
        assert_eq!(window.code(), Some(100));
        assert_eq!((window.status(), window.faults()), (Status::CLAMPED, Faults::empty()));
        window.take(&frame(0, &[5.0]));
        assert_eq!((window.lost(), window.displacement().map(|y| y.min)), (7, Some(5.0)), "it started anew");
    }

    #[test]
    fn numbers_run_over() {
        let mut numbers = Numbers::default();
        assert_eq!(numbers.take(&frame(u32::MAX, &[1.0, 2.0])), Continuity::Contiguous);
        assert_eq!(numbers.take(&frame(1, &[1.0])), Continuity::Contiguous);
        assert_eq!(numbers.take(&frame(5, &[1.0])), Continuity::Gap(3));
    }

    #[test]
    fn of_every_fourth_tick_a_second_has_a_fourth_of_the_samples_and_a_gap_costs_a_fourth() {
        let calibration = AdcCalibration { gain_v_per_code: 0.01, offset_v: -2.0, invert: false, full_scale: 4095 };
        let mut window = Window::new(calibration, 12);
        let every = NonZeroU8::new(4).unwrap();
        let mut take = |first, displacements: &[f32]| window.take(&Samples { every, ..frame(first, displacements) });
        take(u32::MAX - 7, &[9.0, 1.0, 3.0]);
        take(4, &[5.0]);
        take(20, &[6.0]);
        assert_eq!((window.received(), window.lost()), (5, 3));
        assert_eq!(window.every(), every);
        assert_eq!(window.displacement().map(|y| y.min), Some(3.0), "three samples are twelve ticks");
    }
}
