//! Which column holds what: from header names such as `displacement (µm)`, or as the user says.

use std::fmt;

use super::columns::{Columns, Position};
use super::fault::Fault;
use super::label::{Label, find, listed};
use super::number::excerpt;
use super::read_options::ReadOptions;
use super::units::{Quantity, Unit};

/// One column chosen from a file: its index from 0 and its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Channel {
    pub index: usize,
    pub unit: Unit,
}

/// The columns chosen from a file. Displayed as the [`Columns`] that choose them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Channels {
    pub time: Option<Channel>,
    pub voltage: Option<Channel>,
    pub displacement: Option<Channel>,
    /// The displacement's column is named an estimate.
    pub displacement_estimated: bool,
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

    /// The same columns with another unit for `quantity`: an example for a message.
    pub fn restated(self, quantity: Quantity, unit: Unit) -> String {
        let channels = match self.get(quantity) {
            Some(channel) => self.with(quantity, Channel { unit, ..channel }),
            None => self,
        };
        channels.to_string()
    }

    /// Refuses a choice of columns without voltage, without a displacement that is required, and without a time where
    /// no sample rate is stated.
    pub fn check_complete(
        &self,
        count: usize,
        labels: Option<&[Label]>,
        file: &str,
        options: &ReadOptions,
    ) -> Result<(), Fault> {
        let file = file.to_owned();
        let example = match labels {
            Some(labels) => example(labels),
            None => Self::in_order(count).to_string(),
        };
        let required =
            [(Quantity::Voltage, options.voltage_required), (Quantity::Displacement, options.displacement_required)];
        if let Some((quantity, _)) = required.into_iter().find(|&(q, required)| required && self.get(q).is_none()) {
            return Err(Fault::NoColumn {
                quantity,
                columns: labels.map_or_else(|| format!("1 to {count}"), listed),
                file,
                example,
            });
        }
        if self.time.is_none() && options.sample_rate.is_none() {
            return Err(Fault::NoTime { file });
        }
        Ok(())
    }

    /// The columns in the thesis's order, time first, and without it where there are fewer than three.
    pub fn in_order(count: usize) -> Self {
        let first = usize::from(count >= 3);
        let channel = |index, quantity: Quantity| {
            let unit = quantity.base();
            (index < count).then_some(Channel { index, unit })
        };
        Self {
            time: channel(0, Quantity::Time).filter(|_| first == 1),
            voltage: channel(first, Quantity::Voltage),
            displacement: channel(first + 1, Quantity::Displacement),
            displacement_estimated: false,
        }
    }
}

impl fmt::Display for Channels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut comma = "";
        for quantity in [Quantity::Time, Quantity::Voltage, Quantity::Displacement] {
            if let Some(Channel { index, unit }) = self.get(quantity) {
                write!(f, "{comma}{quantity}={}:{unit}", index + 1)?;
                comma = ",";
            }
        }
        Ok(())
    }
}

/// Columns whose header names say what they hold.
///
/// # Errors
/// Two columns for one quantity; a unit that is missing, unknown or of another quantity.
pub(super) fn from_header(labels: &[Label]) -> Result<Channels, Fault> {
    let example = example(labels);
    let mut channels = Channels::default();
    for quantity in [Quantity::Time, Quantity::Voltage, Quantity::Displacement] {
        let mut claims = labels.iter().enumerate().filter(|(_, label)| label.quantity() == Some(quantity));
        let Some((index, label)) = claims.next() else {
            continue;
        };
        if let Some((_, second)) = claims.next() {
            return Err(Fault::TwoClaims {
                quantity,
                first: excerpt(&label.text),
                second: excerpt(&second.text),
                example,
            });
        }
        let unit = label
            .unit_as(quantity, &example)?
            .ok_or_else(|| Fault::MissingUnit { column: excerpt(&label.text), example: example.clone() })?;
        channels = channels.with(quantity, Channel { index, unit });
    }
    Ok(channels)
}

/// Likely [`Columns`] for these names: by name, else by unit, else in order.
pub(super) fn example(labels: &[Label]) -> String {
    let mut channels = Channels::default();
    for quantity in [Quantity::Time, Quantity::Voltage, Quantity::Displacement] {
        let by_unit = |label: &Label| label.unit_of(quantity).is_some();
        let index = labels
            .iter()
            .position(|label| label.quantity() == Some(quantity))
            .or_else(|| labels.iter().position(by_unit));
        if let Some(index) = index {
            let unit = labels[index].unit_of(quantity).unwrap_or(quantity.base());
            channels = channels.with(quantity, Channel { index, unit });
        }
    }
    if channels.voltage.is_none() {
        channels = Channels::in_order(labels.len());
    }
    channels.to_string()
}

/// The columns the user stated, in a file of `count` columns, with `labels` where it has a header.
///
/// # Errors
/// A column that is not there or not unique, or a header unit that does not fit and is not overruled.
pub(super) fn from_columns(columns: &Columns, count: usize, labels: Option<&[Label]>) -> Result<Channels, Fault> {
    let mut channels = Channels::default();
    for (quantity, column) in columns.stated() {
        let index = match &column.at {
            Position::Number(number) => (1..=count).contains(number).then(|| number - 1),
            Position::Name(name) => labels.and_then(|labels| find(labels, name)),
        };
        let index = index.ok_or_else(|| Fault::NoSuchColumn {
            wanted: excerpt(&column.at.to_string()),
            columns: match (labels, &column.at) {
                (Some(labels), Position::Name(_)) => listed(labels),
                _ => format!("1 to {count}"),
            },
        })?;
        let header_unit = match (column.unit, labels) {
            (None, Some(labels)) => labels[index].unit_as(quantity, &example(labels))?,
            _ => None,
        };
        let unit = column.unit.or(header_unit).unwrap_or(quantity.base());
        channels = channels.with(quantity, Channel { index, unit });
    }
    Ok(channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(names: &[&str]) -> Result<String, Fault> {
        let labels: Vec<Label> = names.iter().map(|name| Label::new(name)).collect();
        from_header(&labels).map(|channels| channels.to_string())
    }

    #[test]
    fn the_usual_spellings() {
        let base = "time=1:s,voltage=2:V,displacement=3:um";
        for names in [
            ["time_s", "voltage_V", "displacement_um"],
            ["time (s)", "voltage (V)", "displacement (\u{b5}m)"],
            ["Time [s]", "Voltage [V]", "Displacement [\u{3bc}m]"],
            ["t / s", "U / V", "y / um"],
            ["t in s", "Drive voltage, V", "position.um"],
            ["TIME_S", "DRIVE_VOLTAGE_V", "POS_UM"],
            ["s", "V", "micron"],
            ["t_s", "u_V", "x_um"],
            ["Time stamp {s}", "v(volts)", "Measured displacement um"],
        ] {
            assert_eq!(header(&names).unwrap(), base, "{names:?}");
        }
        assert_eq!(
            header(&["position_nm", "temperature_C", "Voltage [mV]", "time (ms)"]).unwrap(),
            "time=4:ms,voltage=3:mV,displacement=1:nm"
        );
    }

    #[test]
    fn refuses_bad_units_and_two_claims() {
        assert!(matches!(header(&["t_s", "voltage (furlong)"]), Err(Fault::UnknownUnit { .. })));
        assert!(matches!(header(&["t_s", "voltage_kg"]), Err(Fault::UnknownUnit { .. })));
        assert!(matches!(header(&["t_s", "voltage_um"]), Err(Fault::WrongDimension { .. })));
        assert!(matches!(
            header(&["time_s", "voltage", "y_um"]),
            Err(Fault::MissingUnit { example, .. })
                if example == "time=1:s,voltage=2:V,displacement=3:um"
        ));
        assert!(matches!(header(&["u_V", "voltage_mV"]), Err(Fault::TwoClaims { .. })));
    }

    fn stated(columns: &str, names: &[&str]) -> Result<String, Fault> {
        let labels: Vec<Label> = names.iter().map(|name| Label::new(name)).collect();
        from_columns(&columns.parse().unwrap(), names.len(), Some(&labels)).map(|channels| channels.to_string())
    }

    #[test]
    fn stated_columns_by_number_and_name() {
        let names = ["CH1 (mV)", "CH2 (V)", "Sensor", "n"];
        assert_eq!(stated("voltage=ch1,displacement=sensor:nm", &names).unwrap(), "voltage=1:mV,displacement=3:nm");
        assert_eq!(stated("voltage=CH1 (mV)", &names).unwrap(), "voltage=1:mV");
        assert_eq!(stated("voltage=3", &names).unwrap(), "voltage=3:V");
        assert_eq!(stated("voltage=1:kV", &names).unwrap(), "voltage=1:kV");
        for columns in ["voltage=5", "voltage=CH3"] {
            assert!(matches!(stated(columns, &names), Err(Fault::NoSuchColumn { .. })));
        }
        assert!(matches!(stated("voltage=x", &["x", "X"]).unwrap().as_str(), "voltage=1:V"));
        assert!(stated("voltage=a", &["A_V", "A_mV"]).is_err());
        assert!(matches!(stated("displacement=2,voltage=1", &names), Err(Fault::WrongDimension { .. })));
    }
}
