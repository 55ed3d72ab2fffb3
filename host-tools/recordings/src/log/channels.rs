//! The columns that hold a log, each with its unit.

use std::fmt::{self, Display};

use measurement_files::{Quantity, Unit};
use serde::{Serialize, Serializer};

use super::sensitivity::Sensitivity;

/// Every quantity of a log.
pub(super) const QUANTITIES: [Quantity; 3] = [Quantity::Time, Quantity::Voltage, Quantity::Displacement];

/// What is to be said of how a log's columns were understood.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "remark", rename_all = "kebab-case")]
pub enum Remark {
    /// The stated unit is not the one that the file says.
    Overruled {
        /// What the column holds.
        #[serde(serialize_with = "as_shown")]
        quantity: Quantity,
        /// The file's unit.
        #[serde(serialize_with = "as_shown")]
        header: Unit,
        /// The stated one, which is used.
        #[serde(serialize_with = "as_shown")]
        stated: Unit,
    },
    /// The file names no columns, and they are taken in the documented order and units.
    Assumed {
        /// They, as [`Columns`](super::Columns) say it.
        columns: String,
    },
}

fn as_shown<S: Serializer>(of: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(of)
}

/// One column chosen from a file: its index from 0 and its unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Channel {
    pub index: usize,
    pub unit: Unit,
    /// The sensor's scale, where the unit is one of voltage and the column holds the displacement.
    pub sensor: Option<Sensitivity>,
    /// The header's unit, where another one was stated.
    pub overruled: Option<Unit>,
}

impl Channel {
    pub fn new(index: usize, unit: Unit) -> Self {
        Self { index, unit, sensor: None, overruled: None }
    }

    /// A value of the column in s, V or µm.
    pub fn to_base(self, value: f64) -> f64 {
        self.unit.to_base(value) * self.sensor.map_or(1.0, |sensor| sensor.um_per_v)
    }
}

/// The columns chosen from a file. Displayed as the [`Columns`] that choose them.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Channels {
    pub time: Option<Channel>,
    pub voltage: Option<Channel>,
    pub displacement: Option<Channel>,
    /// The displacement's column is named an estimate.
    pub displacement_estimated: bool,
    /// Nothing says which column holds what: they are taken in the documented order and units.
    pub in_documented_order: bool,
}

impl Channels {
    pub fn get(&self, quantity: Quantity) -> Option<Channel> {
        match quantity {
            Quantity::Time => self.time,
            Quantity::Voltage => self.voltage,
            Quantity::Displacement => self.displacement,
        }
    }

    pub fn with(mut self, quantity: Quantity, channel: Channel) -> Self {
        match quantity {
            Quantity::Time => self.time = Some(channel),
            Quantity::Voltage => self.voltage = Some(channel),
            Quantity::Displacement => self.displacement = Some(channel),
        }
        self
    }

    /// Whether a column has been chosen.
    pub fn has(&self, index: usize) -> bool {
        QUANTITIES.iter().any(|&quantity| self.get(quantity).is_some_and(|channel| channel.index == index))
    }

    /// The same columns with another unit for `quantity`: an example for a message.
    pub fn restated(self, quantity: Quantity, unit: Unit) -> String {
        match self.get(quantity) {
            Some(channel) if channel.sensor.is_none() => self.with(quantity, Channel { unit, ..channel }).to_string(),
            _ => self.to_string(),
        }
    }

    /// The columns in the thesis's order, time first, and without it where there are fewer than three.
    pub fn in_order(count: usize) -> Self {
        let first = usize::from(count >= 3);
        let channel = |index, quantity: Quantity| (index < count).then_some(Channel::new(index, quantity.base()));
        Self {
            time: channel(0, Quantity::Time).filter(|_| first == 1),
            voltage: channel(first, Quantity::Voltage),
            displacement: channel(first + 1, Quantity::Displacement),
            displacement_estimated: false,
            in_documented_order: true,
        }
    }

    /// What is to be said of this choice.
    pub fn remarks(&self) -> Vec<Remark> {
        let overruled = |&quantity: &Quantity| {
            let Channel { unit, overruled, .. } = self.get(quantity)?;
            overruled.map(|header| Remark::Overruled { quantity, header, stated: unit })
        };
        let assumed = self.in_documented_order.then(|| Remark::Assumed { columns: self.to_string() });
        QUANTITIES.iter().filter_map(overruled).chain(assumed).collect()
    }
}

impl Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut comma = "";
        for quantity in QUANTITIES {
            if let Some(Channel { index, unit, sensor, .. }) = self.get(quantity) {
                write!(f, "{comma}{quantity}={}:", index + 1)?;
                match sensor {
                    Some(sensor) => write!(f, "{sensor}")?,
                    None => write!(f, "{unit}")?,
                }
                comma = ",";
            }
        }
        Ok(())
    }
}
