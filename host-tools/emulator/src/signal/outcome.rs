//! What the firmware made of a fault of the signal.

use estimator_core::Status;
use protocol::{Faults, Sample};

/// What came of a fault.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Outcome {
    /// The first bits of the status that the run without the fault has not, and at which tick of the fault, from 1; a
    /// start anew, which is not settled, is none.
    pub flag: Option<(Status, u32)>,
    /// The first fault that lasts, and at which tick of the fault, from 1.
    pub fault: Option<(Faults, u32)>,
    /// The largest error before any fault that lasts, which starts the estimate anew, µm.
    pub worst_um: f64,
    /// The ± that was stated at that tick, µm; `None` where none was.
    pub stated_um: Option<f64>,
    /// Ticks at which the error was beyond the ±, and neither a bit of the status nor a lasting fault stood beside it,
    /// whatever the run without the fault has.
    pub silent: u32,
    /// When the estimate may be believed again.
    pub recovery: Recovery,
}

/// When the estimate may be believed again after a fault.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Recovery {
    /// So many ticks after the fault's end its error is within its ± and stays there.
    After(u32),
    /// It has begun anew, and has no ± before the displacement is told again.
    NeedsZero,
    /// The fault that the firmware made of it lasts, until the device is reset.
    Faulty,
    /// Its error was still beyond the ± where the run ended.
    NotYet,
}

/// What a fault leaves behind, or does, and what is none by itself.
const LEFT: Faults = Faults::SAFE_OUTPUT.union(Faults::ZERO_LOST);

impl Outcome {
    /// Compares two runs, from the fault's first tick on; `ticks` is how long it lasts.
    pub(crate) fn of(sound: &[Sample], faulty: &[Sample], ticks: usize) -> Self {
        let (mut flag, mut fault) = (None, None);
        let (mut worst_um, mut stated_um, mut silent) = (0.0, None, 0);
        let mut beyond_last = None;
        for (at, (sound, faulty)) in (0..).zip(sound.iter().zip(faulty)) {
            let raised = faulty.status.difference(sound.status | Status::NOT_SETTLED);
            if flag.is_none() && !raised.is_empty() {
                flag = Some((raised, at + 1));
            }
            let lasting = faulty.faults.difference(LEFT);
            if fault.is_none() && !lasting.is_empty() {
                fault = Some((lasting, at + 1));
            }
            let error = f64::from(faulty.displacement - sound.displacement).abs();
            let stated = faulty.half_width.map(f64::from);
            if fault.is_none() && error > worst_um {
                (worst_um, stated_um) = (error, stated);
            }
            if stated.is_none_or(|stated| error > stated) {
                beyond_last = Some(at as usize);
                silent += u32::from(stated.is_some() && faulty.status.is_empty() && lasting.is_empty());
            }
        }
        let stays = faulty.last().is_some_and(|last| !last.faults.difference(LEFT).is_empty());
        let ended = faulty.last().is_none_or(|last| last.half_width.is_none());
        let recovery = match beyond_last {
            _ if stays => Recovery::Faulty,
            _ if ended => Recovery::NeedsZero,
            Some(last) if last + 1 >= faulty.len() => Recovery::NotYet,
            Some(last) => Recovery::After((last + 1).saturating_sub(ticks) as u32),
            None => Recovery::After(0),
        };
        Self { flag, fault, worst_um, stated_um, silent, recovery }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For how many of the ten ticks the fault lasts.
    const TICKS: usize = 4;

    fn sample(displacement: f32, half_width: Option<f32>) -> Sample {
        let (status, faults) = (Status::empty(), Faults::empty());
        Sample { code: 0, sensor: None, displacement, half_width, dac: 0, status, faults }
    }

    /// Ten ticks at rest, ± 1 µm, of which some are changed.
    fn ten(change: impl Fn(usize, &mut Sample)) -> Vec<Sample> {
        let mut samples = vec![sample(0.0, Some(1.0)); 10];
        samples.iter_mut().enumerate().for_each(|(at, sample)| change(at, sample));
        samples
    }

    fn of(faulty: &[Sample]) -> Outcome {
        Outcome::of(&ten(|_, _| ()), faulty, TICKS)
    }

    /// Off by 2 µm from one tick to before another.
    fn off(from: usize, to: usize) -> Vec<Sample> {
        ten(|at, sample| sample.displacement = if (from..to).contains(&at) { -2.0 } else { 0.5 })
    }

    #[test]
    fn it_is_back_after_the_last_tick_beyond_counted_from_the_fault_s_end() {
        for (from, to, after) in [(0, 0, 0), (1, 3, 0), (1, 4, 0), (1, 5, 1), (8, 9, 5)] {
            assert_eq!(of(&off(from, to)).recovery, Recovery::After(after), "{from}..{to}");
        }
        // An estimate without ± meanwhile is not back, either.
        let without = ten(|at, sample| sample.half_width = (at != 6).then_some(1.0));
        assert_eq!(of(&without).recovery, Recovery::After(3));
    }

    #[test]
    fn it_is_not_back_where_the_last_tick_is_beyond_and_needs_a_zero_where_that_has_no_interval() {
        assert_eq!(of(&off(9, 10)).recovery, Recovery::NotYet);
        for displacement in [0.0, 2.0] {
            let ended = ten(|at, last| {
                if at == 9 {
                    *last = sample(displacement, None);
                }
            });
            assert_eq!(of(&ended).recovery, Recovery::NeedsZero);
        }
    }

    #[test]
    fn it_is_not_back_where_the_fault_lasts_whatever_its_error_and_its_interval() {
        for half_width in [Some(1.0), None] {
            let faulty = ten(|at, sample| {
                (sample.faults, sample.half_width) = (Faults::SAFE_OUTPUT | Faults::SLEW_EXCEEDED, half_width);
                if at < 5 {
                    sample.faults = Faults::empty();
                }
            });
            assert_eq!(of(&faulty).recovery, Recovery::Faulty);
        }
    }

    #[test]
    fn only_what_no_flag_and_no_fault_stands_beside_is_silent() {
        assert_eq!(of(&off(2, 7)).silent, 5);
        let mut said = off(2, 7);
        said[2].status = Status::UNTRAINED;
        said[3].faults = Faults::ADC_STUCK;
        said[4].faults = Faults::SAFE_OUTPUT;
        said[5].half_width = None;
        assert_eq!(of(&said).silent, 2, "the safe output alone says nothing, and without ± nothing is claimed");
        // A flag that the run without the fault has at the same tick is said all the same.
        let sound = ten(|at, sample| sample.status.set(Status::UNTRAINED, at == 2 || at == 6));
        let outcome = Outcome::of(&sound, &said, TICKS);
        assert_eq!((outcome.silent, outcome.flag), (2, None), "{outcome:?}");
    }

    #[test]
    fn the_interval_is_that_of_the_largest_error_before_a_lasting_fault() {
        assert_eq!((of(&ten(|_, _| ())).worst_um, of(&ten(|_, _| ())).stated_um), (0.0, None));
        let mut faulty = off(2, 7);
        (faulty[4].displacement, faulty[4].half_width) = (3.0, Some(1.5));
        (faulty[5].displacement, faulty[5].faults) = (9.0, Faults::ADC_SATURATED);
        let outcome = of(&faulty);
        assert_eq!((outcome.worst_um, outcome.stated_um), (3.0, Some(1.5)));
        faulty[6] = sample(9.0, None);
        assert_eq!(of(&faulty).worst_um, 3.0, "it has begun anew since");
        faulty[3] = sample(4.0, None);
        assert_eq!((of(&faulty).worst_um, of(&faulty).stated_um), (4.0, None));
    }

    #[test]
    fn the_first_flag_and_the_first_fault_are_told_with_their_ticks_from_1() {
        let mut faulty = ten(|_, sample| sample.status = Status::NOT_SETTLED);
        faulty[0].faults = Faults::SAFE_OUTPUT;
        assert_eq!((of(&faulty).flag, of(&faulty).fault), (None, None));
        faulty[3].status |= Status::CLAMPED | Status::UNTRAINED;
        faulty[4].status |= Status::ADC_SATURATED;
        faulty[7].faults = Faults::SUPPLY | Faults::SAFE_OUTPUT;
        assert_eq!(of(&faulty).flag, Some((Status::CLAMPED | Status::UNTRAINED, 4)));
        assert_eq!(of(&faulty).fault, Some((Faults::SUPPLY, 8)));
    }
}
