//! Which column of a log holds what, in which unit, as the user says it.
//!
//! `time=1,voltage=2:mV,displacement=5:um`: a number counted from 1 or a header name, then the unit if it is not the
//! header's or s, V, µm. What is left out is taken from the header where that is clear. A displacement that was
//! recorded as a sensor's volts has the sensor's scale for its unit: `displacement=5:2.5um/V`.

use std::fmt;
use std::str::FromStr;

use measurement_files::{Quantity, Unit, UnknownUnit};

use super::sensitivity::{Sensitivity, SensitivityError};

/// The columns of a log, as stated by the user. Displayed as it is written on the command line.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Column of the time; none where the header or the sample rate says it.
    pub time: Option<Column>,
    /// Column of the voltage; none where the header says it, or it is not needed.
    pub voltage: Option<Column>,
    /// Column of the displacement; none where the header says it, or it is not needed.
    pub displacement: Option<Column>,
}

/// One column of a log.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Which column it is.
    pub at: Position,
    /// Its unit; without one the header's counts, and without a header s, V or µm.
    pub unit: Option<Unit>,
    /// The sensor's scale, where the column holds a sensor's volts.
    pub sensor: Option<Sensitivity>,
}

/// How a column is named.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Position {
    /// The column's number, counted from 1.
    Number(usize),
    /// A header name, with or without its unit, in any case.
    Name(String),
}

impl Columns {
    /// Whether they say which column the displacement is.
    pub fn state_displacement(&self) -> bool {
        self.displacement.is_some()
    }

    /// Each stated quantity with its column.
    pub(super) fn stated(&self) -> impl Iterator<Item = (Quantity, &Column)> {
        [
            (Quantity::Time, self.time.as_ref()),
            (Quantity::Voltage, self.voltage.as_ref()),
            (Quantity::Displacement, self.displacement.as_ref()),
        ]
        .into_iter()
        .filter_map(|(quantity, column)| Some((quantity, column?)))
    }
}

impl fmt::Display for Columns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, (quantity, column)) in self.stated().enumerate() {
            let comma = if n == 0 { "" } else { "," };
            write!(f, "{comma}{quantity}={}", column.at)?;
            if let Some(unit) = column.unit {
                write!(f, ":{unit}")?;
            }
            if let Some(sensor) = column.sensor {
                write!(f, ":{sensor}")?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for Position {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => f.write_str(name),
        }
    }
}

/// What is wrong with a choice of columns.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ColumnsError {
    /// What a user is asked to fill in.
    #[error("{0:?} is a place to fill in: write the column's number and its unit there, without angle brackets")]
    Placeholder(String),
    /// A part without `=` or without a column.
    #[error("{0:?} is not QUANTITY=COLUMN, as in time=1,voltage=2:mV,displacement=5:um")]
    Form(String),
    /// A quantity that is not known.
    #[error("unknown quantity {0:?}: use time, voltage or displacement")]
    Quantity(String),
    /// A unit that is not known.
    #[error("{0} (a header name with a colon is best given by its number)")]
    Unit(#[from] UnknownUnit),
    /// A sensor's scale that is none.
    #[error(transparent)]
    Sensitivity(#[from] SensitivityError),
    /// A unit of another quantity.
    #[error("{unit} is no unit of {quantity}")]
    Dimension {
        /// The quantity stated.
        quantity: Quantity,
        /// The unit stated.
        unit: Unit,
    },
    /// Column 0 was named.
    #[error("columns are counted from 1")]
    Zero,
    /// A quantity stated twice.
    #[error("{0} is stated twice")]
    Twice(Quantity),
    /// One column for two quantities.
    #[error("column {0} is stated for two quantities")]
    Shared(Position),
}

impl FromStr for Columns {
    type Err = ColumnsError;

    fn from_str(text: &str) -> Result<Self, ColumnsError> {
        let (mut time, mut voltage, mut displacement) = (None, None, None);
        for part in text.split(',') {
            let (quantity, column) = parse_part(part)?;
            let slot = match quantity {
                Quantity::Time => &mut time,
                Quantity::Voltage => &mut voltage,
                Quantity::Displacement => &mut displacement,
            };
            if slot.replace(column).is_some() {
                return Err(ColumnsError::Twice(quantity));
            }
        }
        let columns = Self { time, voltage, displacement };
        let positions: Vec<_> = columns.stated().map(|(_, column)| &column.at).collect();
        for (n, at) in positions.iter().enumerate() {
            if positions[..n].contains(at) {
                return Err(ColumnsError::Shared((*at).clone()));
            }
        }
        Ok(columns)
    }
}

fn parse_part(part: &str) -> Result<(Quantity, Column), ColumnsError> {
    let form = || ColumnsError::Form(part.to_owned());
    // A sensor's scale says its own.
    let is_place = |text: &str| text.trim().starts_with('<') && text.trim().ends_with('>');
    if part.split_once('=').is_some_and(|(_, column)| column.split(':').any(is_place)) {
        return Err(ColumnsError::Placeholder(part.to_owned()));
    }
    let (quantity, column) = part.split_once('=').ok_or_else(form)?;
    let quantity = match quantity.trim().to_lowercase().as_str() {
        "time" | "t" => Quantity::Time,
        "voltage" | "v" | "u" => Quantity::Voltage,
        "displacement" | "y" => Quantity::Displacement,
        _ => return Err(ColumnsError::Quantity(quantity.trim().to_owned())),
    };
    let (at, unit, sensor) = match column.rsplit_once(':') {
        Some((at, scale)) if scale.contains('/') && quantity == Quantity::Displacement => {
            (at.trim(), None, Some(scale.parse::<Sensitivity>()?))
        }
        Some((at, unit)) => (at.trim(), Some(unit.parse::<Unit>()?), None),
        None => (column.trim(), None, None),
    };
    if let Some(unit) = unit.filter(|unit| unit.quantity() != quantity) {
        return Err(ColumnsError::Dimension { quantity, unit });
    }
    let at = match at.parse() {
        Ok(0) => return Err(ColumnsError::Zero),
        Ok(number) => Position::Number(number),
        Err(_) if at.is_empty() => return Err(form()),
        Err(_) => Position::Name(at.to_owned()),
    };
    Ok((quantity, Column { at, unit, sensor }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_names_and_units() {
        let columns: Columns = "time=1, voltage=2:mV,displacement=Sensor A:\u{b5}m".parse().unwrap();
        let voltage = columns.voltage.as_ref().unwrap();
        assert_eq!(voltage.at, Position::Number(2));
        assert_eq!(voltage.unit, Some(Unit::Millivolt));
        assert_eq!(columns.to_string(), "time=1,voltage=2:mV,displacement=Sensor A:um");
        assert_eq!(columns.to_string().parse(), Ok(columns));
    }

    #[test]
    fn time_and_displacement_may_be_left_out() {
        let columns: Columns = "v=3".parse().unwrap();
        assert_eq!(columns.time, None);
        assert_eq!(columns.displacement, None);
        assert_eq!(columns.voltage.as_ref().unwrap().unit, None);
    }

    #[test]
    fn a_sensors_volts_have_its_scale_for_a_unit() {
        let columns: Columns = "voltage=2,displacement=3:80nm/mV".parse().unwrap();
        let displacement = columns.displacement.as_ref().unwrap();
        assert_eq!((displacement.unit, displacement.sensor.unwrap().um_per_v), (None, 80.0));
        assert_eq!(columns.to_string(), "voltage=2,displacement=3:80um/V");
        assert!(matches!("displacement=3:<N>um/V".parse::<Columns>(), Err(ColumnsError::Sensitivity(_))));
        assert!("voltage=2:80nm/mV".parse::<Columns>().is_err());
    }

    #[test]
    fn refuses_what_makes_no_sense() {
        use ColumnsError as E;
        let refused = |text: &str| text.parse::<Columns>().unwrap_err();
        assert!(matches!(refused(""), E::Form(_)));
        assert!(matches!(refused("voltage"), E::Form(_)));
        assert!(matches!(refused("voltage="), E::Form(_)));
        assert!(matches!(refused("force=1"), E::Quantity(_)));
        assert!(matches!(refused("voltage=1:furlong"), E::Unit(_)));
        assert!(matches!(refused("voltage=1:um"), E::Dimension { .. }));
        for place in ["voltage=<COLUMN>:<UNIT>", "time=1:<UNIT>", "displacement=<COLUMN>"] {
            assert!(matches!(refused(place), E::Placeholder(_)), "{place}");
        }
        assert!(matches!(refused("voltage=0"), E::Zero));
        assert!(matches!(refused("voltage=1,v=2"), E::Twice(_)));
        assert!(matches!(refused("voltage=1,time=1"), E::Shared(_)));
    }
}
