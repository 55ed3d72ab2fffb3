//! What a device's bits mean and what to do about each.

use device_link::words;
use estimator_core::Status;
use protocol::Faults;

/// What a bit means.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Meaning {
    /// What the bit says of the device or the estimate.
    pub what: &'static str,
    /// What the user can do about it.
    pub remedy: &'static str,
}

/// Every fault that is set.
pub fn faults(faults: Faults) -> impl Iterator<Item = Meaning> {
    words::faults(faults).map(|(bit, what)| Meaning { what, remedy: of(&FAULTS, bit) })
}

/// Every status bit that is set.
pub fn status(status: Status) -> impl Iterator<Item = Meaning> {
    words::status(status).map(|(bit, what)| Meaning { what, remedy: of(&STATUS, bit) })
}

fn of<T: PartialEq + Copy>(remedies: &[(T, &'static str)], bit: T) -> &'static str {
    remedies.iter().find(|(other, _)| *other == bit).map_or("report it", |(_, remedy)| remedy)
}

const FAULTS: [(Faults, &str); 15] = [
    (Faults::NO_TABLE, "give it one: piezo push"),
    (
        Faults::TABLE_FALLBACK,
        "piezo info says why. After failures in a row, piezo reset reads the store again. Else unplug the DAC's output, since nobody knows what it is wired for, and store the table again: piezo push --rewired",
    ),
    (
        Faults::DEMONSTRATION,
        "give it a table of the actuator that it is wired to: piezo learn or identify, then piezo push",
    ),
    (
        Faults::STALLED,
        "report it with what piezo info says, for it must not happen. One that drives the amplifier rests until piezo follow, linearise or waveform goes on",
    ),
    (Faults::ZERO_LOST, "zero it where the displacement is known: piezo zero, or the board's button"),
    (Faults::CLOCK, "piezo reset looks for the crystal again; if it does not start then either, replace the board"),
    (Faults::SUPPLY, "measure VDDA (3.3 V) with a multimeter, and mend the supply; where it is sound, piezo reset"),
    (
        Faults::ADC_SATURATED,
        "check the plug, the divider and its offset: is the input open, or the voltage beyond them?",
    ),
    (
        Faults::ADC_STUCK,
        "check the wire to the ADC; if it is sound, piezo reset, and replace the board if that does not help",
    ),
    (
        Faults::SLEW_EXCEEDED,
        "check the wire from the amplifier's monitor and the divider's ground: is one off, or loose? If they are sound, the amplifier is faster than was stated: piezo emit --amplifier-slew. If it stays although the wire is back, piezo reset. Then set the zero anew: piezo zero",
    ),
    (
        Faults::OUT_OF_CALIBRATION,
        "compare the voltage of piezo monitor with a multimeter: if they differ, piezo emit --adc-span; if they agree, identify on logs that reach as far",
    ),
    (
        Faults::AMPLIFIER,
        "is the amplifier on, has it tripped, are the wires to A0 and A2 sound, and as slow as --drive-slew says? If so, a span is wrong: piezo emit --adc-span, --drive-span",
    ),
    (
        Faults::SETPOINT,
        "is the controller on, and are its wire to A3 and the divider sound? When they are: piezo linearise",
    ),
    (
        Faults::MISSED_DEADLINE,
        "writing a table may do that (with --pause it does not matter), and an emulated board is as late as its host; otherwise report it, for it must not happen",
    ),
    (
        Faults::SAFE_OUTPUT,
        "mend what else is wrong; where nothing is, piezo reset makes it estimate again. One that drives the amplifier rests until piezo follow, piezo linearise or piezo waveform",
    ),
];

const STATUS: [(Status, &str); 8] = [
    (Status::ADC_SATURATED, "a divider for larger voltages, or less voltage; then piezo emit --adc-span"),
    (Status::VOLTAGE_OUT_OF_RANGE, "identify on logs that reach as far, or drive the actuator less"),
    (Status::CLAMPED, "identify on logs with as large a stroke"),
    (Status::DAC_SATURATED, "a wider output: piezo emit --dac-span"),
    (Status::NOT_SETTLED, "move the actuator once up and down its range; a start from rest at 0 V needs it least"),
    (Status::OUT_OF_REACH, "ask for less or more slowly, or widen the limits: piezo emit --drive-range, --drive-slew"),
    (Status::UNTRAINED, "believe the estimate as far as its ±; identify on logs with swings such as these"),
    (Status::SLEW_EXCEEDED, "a shielded wire; is --amplifier-slew what the amplifier can?"),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_has_a_remedy() {
        assert!(Faults::all().iter().all(|bit| FAULTS.iter().any(|(other, _)| *other == bit)));
        assert!(Status::all().iter().all(|bit| STATUS.iter().any(|(other, _)| *other == bit)));
    }

    #[test]
    fn the_book_s_tables_of_bits_are_what_is_said_of_them() {
        let book = include_str!("../../../book/src/errors.md");
        let row = |name: &str, Meaning { what, remedy }: Meaning| format!("| `{name}` | {what} | {remedy} |\n");
        let of_faults = Faults::all().iter_names().flat_map(|(name, bit)| faults(bit).map(move |of| row(name, of)));
        let of_status = Status::all().iter_names().flat_map(|(name, bit)| status(bit).map(move |of| row(name, of)));
        let rows: Vec<String> = of_faults.chain(of_status).collect();
        assert_eq!(rows.len(), FAULTS.len() + STATUS.len());
        for row in rows {
            assert!(book.contains(&row), "book/src/errors.md lacks the row\n{row}");
        }
    }
}
