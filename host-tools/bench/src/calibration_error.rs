//! Why two readings make no calibration.

use protocol::Faults;

/// Why two readings make no calibration.
#[derive(Clone, Copy, PartialEq, Debug, thiserror::Error)]
pub enum CalibrationError {
    /// The samples have no second channel.
    #[error("the board has no second channel that a sensor could be connected to")]
    NoSensor,
    /// The device sends no samples for two seconds.
    #[error("the device gives no samples")]
    Silent,
    /// The channel stands at an end of its range.
    #[error("the channel stands at an end of its range (code {code:.0} of {full_scale})")]
    Saturated {
        /// Mean of the codes of a second.
        code: f64,
        /// The channel's largest code.
        full_scale: u16,
    },
    /// What is measured does not stand still.
    #[error("the code does not stand still: after {seconds:.0} s it still goes by {codes:.0} codes in half a second")]
    Drifts {
        /// From one half of the average to the other.
        codes: f64,
        /// How long it was waited for.
        seconds: f64,
    },
    /// The two points are next to each other.
    #[error("the two points are {codes:.0} codes apart, less than a tenth of all {full_scale}")]
    TooNear {
        /// From one to the other.
        codes: f64,
        /// The channel's largest code.
        full_scale: u16,
    },
    /// The two readings are one, or none.
    #[error("the readings {0} and {1} do not differ")]
    SameReading(f64, f64),
    /// The multimeter reads something else than the amplifier was driven to.
    #[error("the reading {reading} V is more than {most:.1} V from the {volts} V that the amplifier was driven to")]
    FarFromDriven {
        /// What was read, V.
        reading: f64,
        /// What the amplifier was driven to, V.
        volts: f64,
        /// How far they may be apart, V.
        most: f64,
    },
    /// The voltage was driven one way, and the readings go the other.
    #[error("the readings go from {} to {} V where the amplifier was driven from {} to {} V", readings[0], readings[1], volts[0], volts[1])]
    OtherWay {
        /// What was read, V.
        readings: [f64; 2],
        /// What the amplifier was driven to, V.
        volts: [f64; 2],
    },
    /// The channel would count the other way than before.
    #[error(
        "the readings make the span [{:.2}, {:.2}], which goes the other way than the former one, [{}, {}]", found.0, found.1, former.0, former.1
    )]
    Inverted {
        /// What the file says.
        former: (f64, f64),
        /// What the readings say.
        found: (f64, f64),
    },
    /// The codes stand for nothing.
    #[error("the codes cannot be believed, for the device reports {}", names(*.0))]
    Faulty(Faults),
    /// The file says of a drive neither how far nor how fast it may go, and what is measured would be its span.
    #[error(
        "board.toml does not say how far and how fast the DAC may drive, and what is measured here would stand beside that"
    )]
    NoDrive,
    /// The device states a tick that cannot be.
    #[error("the device states a tick of 0 µs")]
    NoTick,
    /// The user has had enough.
    #[error("interrupted: nothing was calibrated")]
    Interrupted,
}

fn names(faults: Faults) -> String {
    faults.iter_names().map(|(name, _)| name).collect::<Vec<_>>().join(", ")
}
