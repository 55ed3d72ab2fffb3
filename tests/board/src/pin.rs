//! Pins that have a model, by their names.

/// A port with a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Port {
    /// The port of pins PA0 to PA15.
    A,
    /// The port of pins PB0 to PB15.
    B,
    /// The port of pins PC0 to PC15.
    C,
}

impl Port {
    pub(crate) const ALL: [Self; 3] = [Self::A, Self::B, Self::C];
}

/// A pin of one of the modelled ports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Pin {
    /// The port that it belongs to.
    pub port: Port,
    /// Its number, 0 to 15.
    pub number: u8,
}
