//! What a device reports, in plain words.

use estimator_core::Status;
use protocol::{Faults, Health, Identity, Mode, ResetCause, TableSource, Text};
use serde::Serializer;

/// Every fault that is set, and what is so.
pub fn faults(faults: Faults) -> impl Iterator<Item = (Faults, &'static str)> {
    FAULTS.into_iter().filter(move |(bit, _)| faults.contains(*bit))
}

/// Every status bit that is set, and what is so.
pub fn status(status: Status) -> impl Iterator<Item = (Status, &'static str)> {
    STATUS.into_iter().filter(move |(bit, _)| status.contains(*bit))
}

/// What is so, of all of these, in one line; nothing where nothing is.
pub fn list(said: impl Iterator<Item = &'static str>) -> String {
    said.collect::<Vec<_>>().join("; ")
}

/// The names of the status bits, for machines.
pub fn serialize_status<S: Serializer>(status: &Status, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(status.iter_names().map(|(name, _)| name))
}

/// Why a device started, by what it says of it and by whether its last run left a message.
pub fn reset(cause: ResetCause, left_a_message: bool) -> String {
    let by_itself = match left_a_message {
        true => "the firmware restarted itself, after a panic",
        false => {
            "by software, and no host asked for it: by a debug probe, or after a failure whose message was taken since"
        }
    };
    let causes = [
        (ResetCause::BROWN_OUT, "power came, or sagged and came back"),
        (ResetCause::WATCHDOG, "the watchdog restarted it, since ticks or the link had stopped"),
        (ResetCause::ASKED, "a host asked for it, as it does after storing a table"),
        (ResetCause::SOFTWARE, by_itself),
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
        Mode::Excite => "drives the amplifier to the voltages that it is told, and estimates from its ADC",
        Mode::Linearise => {
            "drives the amplifier to where the set-point at its ADC wants the displacement, and estimates"
        }
        Mode::Waveform => "plays the waveform in its memory, or has played it, and estimates from its ADC",
    }
}

/// What a device does and whether that is over, as [`mode`] says it.
pub fn state(health: &Health) -> &'static str {
    activity(health.mode, health.faults)
}

fn activity(mode: Mode, faults: Faults) -> &'static str {
    match mode {
        Mode::Waveform if rests(mode, faults) => "has played its waveform, and estimates from its ADC",
        Mode::Waveform if faults.contains(Faults::SAFE_OUTPUT) => {
            "has stopped playing its waveform, and estimates from its ADC"
        }
        Mode::Waveform => "plays the waveform in its memory, and estimates from its ADC",
        Mode::Follow | Mode::Excite if faults.contains(Faults::SAFE_OUTPUT) => {
            "rests, since a fault or a host's silence ended its drive or none has begun, and estimates from its ADC"
        }
        other => self::mode(other),
    }
}

/// Whether a device that drives the amplifier is at rest by its own table, and with no fault: whenever nothing is
/// followed or no host goes on, and after a waveform's last line.
pub fn rests(mode: Mode, faults: Faults) -> bool {
    faults == Faults::SAFE_OUTPUT && mode != Mode::Linearise
}

/// What a device that [`rests`] does.
pub const AT_REST: &str = "the DAC is at its rest, as it is while nothing is followed";

/// Where the table in use comes from, and why not from the store, as the end of a sentence.
pub fn source(source: &TableSource) -> String {
    match source {
        TableSource::Stored => "from the parameter store".to_owned(),
        TableSource::Compiled { reason } => format!("from the firmware image, since {reason}"),
        TableSource::None { stored, compiled } => {
            format!("none, since {stored}, and the firmware image's own is refused: {compiled}")
        }
    }
}

/// How old the bias is and what it adds to the model's displacement, as the end of a sentence that starts
/// with the device.
pub fn bias(health: &Health, tick_us: u32) -> String {
    let Some(ticks) = health.bias_age_ticks else {
        return "never zeroed since the estimate began".to_owned();
    };
    let seconds = f64::from(ticks) * f64::from(tick_us) * 1e-6;
    let age = match seconds {
        ..120.0 => format!("{seconds:.0} s"),
        ..7200.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.1} h", seconds / 3600.0),
    };
    let oldest = if ticks >= Health::OLDEST_BIAS_TICKS { "at least " } else { "" };
    format!("zeroed {oldest}{age} ago, bias {:+.3} µm", health.bias_um)
}

const FAULTS: [(Faults, &str); 15] = [
    (Faults::NO_TABLE, "there is no table that it can run, so nothing is estimated"),
    (
        Faults::TABLE_FALLBACK,
        "the stored table cannot be used or was not read, so the one of the firmware image is, which may be another actuator's: the output stays safe",
    ),
    (
        Faults::DEMONSTRATION,
        "no table is stored, and the one of the firmware image is the demonstration's, which is another actuator's: what it estimates is for trials alone, and the output A2 is not driven",
    ),
    (
        Faults::STALLED,
        "the firmware's main loop has stood still, so that the output was brought to its safe value before the watchdog could restart the device",
    ),
    (
        Faults::CLOCK,
        "the board's crystal did not start: the chip's own oscillator, up to 2 % off, clocks it, and nothing is estimated or driven",
    ),
    (
        Faults::SUPPLY,
        "the analogue supply, the converters' reference, is or was out of tolerance, or is not measured any more",
    ),
    (Faults::ADC_SATURATED, "the ADC stands at an end of its range, or comes too near it too often"),
    (Faults::ADC_STUCK, "the ADC gives one and the same code"),
    (
        Faults::SLEW_EXCEEDED,
        "the monitor's voltage leapt as the amplifier cannot, and stayed there for 10 ms or went on leaping; its wire may still be off",
    ),
    (Faults::OUT_OF_CALIBRATION, "the voltage is beyond what the table was identified on"),
    (
        Faults::AMPLIFIER,
        "the voltage at the ADC was not what the drive commanded, to within 5 % of its range, for 100 ms",
    ),
    (
        Faults::SETPOINT,
        "the set-point stands at an end of the ADC's range, comes too near it too often, or gives one and the same code",
    ),
    (
        Faults::ZERO_LOST,
        "its zero is lost: since the displacement was told, the estimate has begun anew, by a fault, a pause or a restart that nobody asked for, and is relative to the model's zero again",
    ),
    (Faults::MISSED_DEADLINE, "a tick came late or not at all, or was not done in time for its output"),
    (Faults::SAFE_OUTPUT, "the DAC stands at its safe value"),
];

const STATUS: [(Status, &str); 8] = [
    (Status::ADC_SATURATED, "the ADC was at an end of its range: the voltage was at least that large"),
    (
        Status::VOLTAGE_OUT_OF_RANGE,
        "the voltage left the range the table was identified on, and the nearest end was taken",
    ),
    (Status::CLAMPED, "the estimate was clamped to the table's limits"),
    (Status::DAC_SATURATED, "the DAC was at an end of its range: the displacement was at least that far"),
    (
        Status::NOT_SETTLED,
        "the voltage had not turned at either end of half its range since the start, or since it was beyond the range: the estimate \
         depended on what was assumed then",
    ),
    (
        Status::OUT_OF_REACH,
        "the wanted displacement, or voltage, was out of reach: the voltage or its slew rate stood at the drive's limit",
    ),
    (
        Status::UNTRAINED,
        "the voltage went as it never did in the training: what the estimate said there was not learnt",
    ),
    (
        Status::SLEW_EXCEEDED,
        "the voltage leapt as the amplifier cannot, and the last one before was taken; or it had just come back",
    ),
];

/// A device's text as a terminal may have it: no control character, which could begin an escape sequence, gets through.
pub fn printable<const N: usize>(said: &Text<N>) -> Text<N> {
    // None becomes longer.
    said.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// The same of all that a device says of itself.
pub fn of_identity(mut identity: Identity) -> Identity {
    identity.board = printable(&identity.board);
    identity.firmware = printable(&identity.firmware);
    identity.git = printable(&identity.git);
    identity.model = printable(&identity.model);
    identity
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_has_words() {
        assert_eq!(faults(Faults::all()).count(), Faults::all().iter().count());
        assert_eq!(status(Status::all()).count(), Status::all().iter().count());
        for cause in ResetCause::all().iter() {
            assert_ne!(reset(cause, false), reset(ResetCause::empty(), false), "{cause:?}");
        }
        assert!(
            reset(ResetCause::SOFTWARE, true).contains("panic")
                && !reset(ResetCause::SOFTWARE, false).contains("panic")
        );
    }

    #[test]
    fn a_drive_that_has_ended_is_not_said_to_go_on() {
        let of = |faults| activity(Mode::Waveform, faults);
        assert!(of(Faults::empty()).starts_with("plays"));
        assert!(of(Faults::SAFE_OUTPUT).starts_with("has played"));
        assert!(of(Faults::SAFE_OUTPUT | Faults::AMPLIFIER).starts_with("has stopped playing"));
        assert!(activity(Mode::Follow, Faults::SAFE_OUTPUT).starts_with("rests"));
        assert!(activity(Mode::Follow, Faults::empty()).starts_with("drives"));
    }

    #[test]
    fn no_escape_sequence_of_a_device_gets_through() {
        // A title, a colour, and the one-character form of the same, which UTF-8 has, too.
        let said = printable::<40>(&protocol::text("a\u{1b}]0;b\u{7}c\u{1b}[31m\u{9b}1md µ"));
        assert_eq!(said.as_str(), "a?]0;b?c?[31m?1md µ");
    }
}
