//! What the firmware made of a fault of the signal.

use estimator_core::Status;
use protocol::{Faults, Sample};

/// What came of a fault.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Outcome {
    /// The first bits of the status that the run without the fault has not, and at which tick of the fault, from 1; a start anew,
    /// which is not settled, is none.
    pub flag: Option<(Status, u32)>,
    /// The first fault that lasts, and at which tick of the fault, from 1.
    pub fault: Option<(Faults, u32)>,
    /// The largest error on ticks with an estimate that no lasting fault belies, µm.
    pub worst_um: f64,
    /// The ± that was stated at that tick, µm; `None` where none was.
    pub stated_um: Option<f64>,
    /// Ticks at which the error was beyond the ±, and nothing said so.
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
    /// Its error was still beyond the ± where the run ended.
    NotYet,
}

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
            let lasting = faulty.faults.difference(Faults::SAFE_OUTPUT);
            if fault.is_none() && !lasting.is_empty() {
                fault = Some((lasting, at + 1));
            }
            let error = f64::from(faulty.displacement - sound.displacement).abs();
            let stated = faulty.half_width.map(f64::from);
            if lasting.is_empty() && error > worst_um {
                (worst_um, stated_um) = (error, stated);
            }
            if stated.is_none_or(|stated| error > stated) {
                beyond_last = Some(at as usize);
                silent += u32::from(stated.is_some() && raised.is_empty() && lasting.is_empty());
            }
        }
        let ended = faulty.last().is_none_or(|last| last.half_width.is_none());
        let recovery = match beyond_last {
            _ if ended => Recovery::NeedsZero,
            Some(last) if last + 1 >= faulty.len() => Recovery::NotYet,
            Some(last) => Recovery::After((last + 1).saturating_sub(ticks) as u32),
            None => Recovery::After(0),
        };
        Self { flag, fault, worst_um, stated_um, silent, recovery }
    }
}
