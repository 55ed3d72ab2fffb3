//! What a device reports, in plain words, each with what can be done about it.

use estimator_core::Status;
use protocol::{Faults, Mode, ResetCause};
use serde::Serializer;

/// What a bit means.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Meaning {
    /// What is so.
    pub what: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

/// Every fault that is set.
pub fn faults(faults: Faults) -> impl Iterator<Item = Meaning> {
    FAULTS.into_iter().filter(move |(bit, _)| faults.contains(*bit)).map(|(_, meaning)| meaning)
}

/// Every status bit that is set.
pub fn status(status: Status) -> impl Iterator<Item = Meaning> {
    STATUS.into_iter().filter(move |(bit, _)| status.contains(*bit)).map(|(_, meaning)| meaning)
}

/// What is so, of all of these, in one line; nothing where nothing is.
pub fn list(meanings: impl Iterator<Item = Meaning>) -> String {
    meanings.map(|meaning| meaning.what).collect::<Vec<_>>().join("; ")
}

/// The names of the status bits, for machines.
pub fn serialize_status<S: Serializer>(status: &Status, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(status.iter_names().map(|(name, _)| name))
}

/// Why a device started.
pub fn reset(cause: ResetCause) -> String {
    let causes = [
        (ResetCause::BROWN_OUT, "power came, or sagged and came back"),
        (ResetCause::WATCHDOG, "the watchdog restarted it, since ticks or the link had stopped"),
        (ResetCause::SOFTWARE, "the firmware restarted itself, as asked or after a panic"),
        (ResetCause::PIN, "the reset button or a debug probe"),
        (ResetCause::OTHER, "a low-power, window-watchdog or option-byte reset"),
    ];
    let set: Vec<&str> = causes.into_iter().filter(|(bit, _)| cause.contains(*bit)).map(|(_, words)| words).collect();
    // A reset by the pin shows beside every other cause, which pulls that pin.
    match set[..] {
        [] => "for no reason that it knows".to_owned(),
        [first, ..] => first.to_owned(),
    }
}

/// What a device does, as the end of a sentence that starts with the device.
pub fn mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Estimate => "estimates from its ADC",
        Mode::Pil => "waits for fed samples (processor in the loop) and estimates nothing else",
        Mode::Pause => "is paused and estimates nothing",
        Mode::Follow => "drives the amplifier to where it is told, and estimates from its ADC",
    }
}

const FAULTS: [(Faults, Meaning); 8] = [
    (
        Faults::NO_TABLE,
        Meaning {
            what: "there is no table that it can run, so nothing is estimated",
            remedy: "give it one: piezo push",
        },
    ),
    (
        Faults::TABLE_FALLBACK,
        Meaning {
            what: "the stored table cannot be used, so the one of the firmware image is, which may be another actuator's: the output \
                   stays safe",
            remedy: "piezo info says why; store it again: piezo push",
        },
    ),
    (
        Faults::SUPPLY,
        Meaning {
            what: "the analogue supply, the converters' reference, was out of tolerance at the start",
            remedy: "measure VDDA (3.3 V) with a multimeter, mend the supply, then piezo reset",
        },
    ),
    (
        Faults::ADC_SATURATED,
        Meaning {
            what: "the ADC stands at an end of its range, or comes too near it too often",
            remedy: "check the plug, the divider and its offset: is the input open, or the voltage beyond them?",
        },
    ),
    (
        Faults::ADC_STUCK,
        Meaning {
            what: "the ADC gives one and the same code",
            remedy: "check the wire to the ADC; if it is sound, piezo reset, and replace the board if that does not help",
        },
    ),
    (
        Faults::OUT_OF_CALIBRATION,
        Meaning {
            what: "the voltage is beyond what the table was identified on",
            remedy: "compare the voltage of piezo monitor with a multimeter: if they differ, piezo emit --adc-span; if they \
                     agree, identify on logs that reach as far",
        },
    ),
    (
        Faults::MISSED_DEADLINE,
        Meaning {
            what: "a tick came late or not at all, or was not done in time for its output",
            remedy: "writing a table does that (with --pause it does not matter), and an emulated board is as late as its \
                     host; otherwise report it, for it must not happen",
        },
    ),
    (
        Faults::SAFE_OUTPUT,
        Meaning {
            what: "the DAC stands at its safe value",
            remedy: "mend what else is wrong; where nothing is, piezo reset makes it estimate again. One that drives the \
                     amplifier rests until piezo follow",
        },
    ),
];

const STATUS: [(Status, Meaning); 6] = [
    (
        Status::ADC_SATURATED,
        Meaning {
            what: "the ADC was at an end of its range: the voltage was at least that large",
            remedy: "a divider for larger voltages, or less voltage; then piezo emit --adc-span",
        },
    ),
    (
        Status::VOLTAGE_OUT_OF_RANGE,
        Meaning {
            what: "the voltage left the range the table was identified on, and the nearest end was taken",
            remedy: "identify on logs that reach as far, or drive the actuator less",
        },
    ),
    (
        Status::CLAMPED,
        Meaning {
            what: "the estimate was clamped to the table's limits",
            remedy: "identify on logs with as large a stroke",
        },
    ),
    (
        Status::DAC_SATURATED,
        Meaning {
            what: "the DAC was at an end of its range: the displacement was at least that far",
            remedy: "a wider output: piezo emit --dac-span",
        },
    ),
    (
        Status::NOT_SETTLED,
        Meaning {
            what: "the voltage had not turned at either end of half its range since the start: the estimate depended on where \
                   that was assumed",
            remedy: "move the actuator once up and down its range; a start from rest at 0 V needs it least",
        },
    ),
    (
        Status::OUT_OF_REACH,
        Meaning {
            what: "the wanted displacement was out of reach: the voltage or its slew rate stood at the drive's limit",
            remedy: "ask for less or more slowly, or widen the limits: piezo emit --drive-range, --drive-slew",
        },
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_has_words() {
        assert_eq!(faults(Faults::all()).count(), Faults::all().iter().count());
        assert_eq!(status(Status::all()).count(), Status::all().iter().count());
        for cause in ResetCause::all().iter() {
            assert_ne!(reset(cause), reset(ResetCause::empty()), "{cause:?}");
        }
    }
}
