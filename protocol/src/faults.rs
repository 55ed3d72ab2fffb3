//! What can be wrong on a device.

use crate::mode::Mode;
use serde::{Deserialize, Serialize};

bitflags::bitflags! {
    /// What is wrong on the device now. While [`Faults::SAFE_OUTPUT`] is among them, the DAC stands at its
    /// safe value, or is on its way there. Of what lasts until a second after its cause, a mode that is set
    /// ends [`Faults::SETPOINT`] alone.
    #[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize, Deserialize)]
    pub struct Faults: u16 {
        /// The ADC has stood at an end of its range: a broken divider, a wrong offset, or an open input.
        const ADC_SATURATED = 1 << 0;
        /// The ADC has given one and the same code: a converter or an input that has stopped.
        const ADC_STUCK = 1 << 1;
        /// The voltage has been beyond what the table was identified on: the calibration is not that of this divider.
        const OUT_OF_CALIBRATION = 1 << 2;
        /// A tick came late or not at all, or was not done in time for its output.
        const MISSED_DEADLINE = 1 << 3;
        /// The analogue supply, which is the converters' reference, is or has been out of tolerance, or is not
        /// measured any more.
        const SUPPLY = 1 << 4;
        /// There is no admissible table, so nothing is estimated.
        const NO_TABLE = 1 << 5;
        /// A stored table could not be used, so another one is.
        const TABLE_FALLBACK = 1 << 6;
        /// The DAC stands at its safe value, or is on its way there: by a fault, or because nothing is put out
        /// in this mode.
        const SAFE_OUTPUT = 1 << 7;
        /// While driving, the voltage has not been what was commanded: a wire is open, the amplifier has tripped, or a
        /// span is wrong.
        const AMPLIFIER = 1 << 8;
        /// While the set-point is followed, its input has stood at an end of the ADC's range, or given one and the same
        /// code: a controller that is off, an open wire, or a wrong divider.
        const SETPOINT = 1 << 9;
        /// The crystal did not start: the chip's own oscillator, up to 2 % off, clocks the device,
        /// which estimates nothing.
        const CLOCK = 1 << 10;
        /// The monitor's voltage has leapt as the amplifier cannot, and stayed there, or went on leaping: a wire is
        /// off, the input floats, or the table states a slower amplifier than there is. It lasts until a second after
        /// the voltage leaps back, or until the device is reset.
        const SLEW_EXCEEDED = 1 << 11;
        /// Nothing is stored, and the image's table is the demonstration's: another actuator's. It is estimated by for
        /// trials; the output is not put on its pin.
        const DEMONSTRATION = 1 << 12;
        /// The main loop has stood still: a drive goes to rest before the watchdog resets the device.
        const STALLED = 1 << 13;
        /// The displacement had been told, and the estimate has begun anew since, by a fault, a pause or a restart that
        /// nobody has asked for: it is relative to the model's zero again, and lasts until it is told anew.
        const ZERO_LOST = 1 << 14;
    }
}

impl Faults {
    /// The faults that send the DAC to its safe value. With a table that is not the one stored, or nobody's here,
    /// nobody knows what the DAC is wired to. A zero that is lost moves no output. [`Faults::MISSED_DEADLINE`] is not
    /// among them: of one late tick it says so, too, which moves none; where ticks are late for 10 ms it comes with
    /// [`Faults::SAFE_OUTPUT`].
    pub const UNSAFE: Self = Self::ADC_SATURATED
        .union(Self::ADC_STUCK)
        .union(Self::OUT_OF_CALIBRATION)
        .union(Self::SUPPLY)
        .union(Self::AMPLIFIER)
        .union(Self::SETPOINT)
        .union(Self::CLOCK)
        .union(Self::SLEW_EXCEEDED)
        .union(Self::NO_TABLE)
        .union(Self::TABLE_FALLBACK)
        .union(Self::DEMONSTRATION)
        .union(Self::STALLED);

    /// Whether an estimate suffers from any of these: of the set-point nothing is estimated, and the tick goes on where
    /// the main loop stands still.
    #[must_use]
    pub const fn harm_estimate(self) -> bool {
        !Self::SETPOINT.union(Self::STALLED).contains(self)
    }

    /// The faults with which a mode is not entered, beside ticks that go on being late: none where the output rests or
    /// shows the estimate, and where it drives those of [`Faults::UNSAFE`] that concern the mode.
    pub const fn against(mode: Mode) -> Self {
        match mode {
            Mode::Estimate | Mode::Pil | Mode::Pause => Self::empty(),
            Mode::Follow | Mode::Excite | Mode::Waveform => Self::UNSAFE.difference(Self::SETPOINT),
            Mode::Linearise => Self::UNSAFE,
        }
    }
}
