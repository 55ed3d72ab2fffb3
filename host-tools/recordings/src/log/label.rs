//! Names of a header: `displacement (µm)` taken apart into a quantity and a unit.

use measurement_files::{Quantity, Unit, UnknownUnit, excerpt};

use super::fault::Fault;
use super::vocabulary;

/// A header name taken apart.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Label {
    /// The label as it is written.
    pub text: String,
    /// Lower case, words separated by single spaces, without the unit.
    name: String,
    unit: Option<Result<Unit, UnknownUnit>>,
}

impl Label {
    /// Units are set apart by brackets, `_`, `/`, a comma, a dot or a space; a unit alone (`mV`) is a name as well.
    pub fn new(text: &str) -> Self {
        let text = text.trim();
        let label = |name: &str, unit| Self { text: text.to_owned(), name: normalised(name), unit };
        for (open, close) in [('(', ')'), ('[', ']'), ('{', '}'), ('（', '）'), ('【', '】')] {
            // What has a colon is a part of a MATLAB array: `x(:,1)`.
            if let Some((name, unit)) = text.strip_suffix(close).and_then(|t| t.rsplit_once(open))
                && !unit.contains(':')
            {
                return label(name, Some(unit.parse()));
            }
        }
        if let Some(unit) = text.parse().ok().filter(|unit: &Unit| unit.names_a_column()) {
            return label("", Some(Ok(unit)));
        }
        let whole = label(text, None);
        if whole.named_quantity().is_some() {
            return whole;
        }
        let Some((name, unit)) = text.rsplit_once(['_', '/', ',', '.', ' ']) else {
            return whole;
        };
        let parted = label(name, Some(unit.parse()));
        match parted.unit {
            Some(Err(_)) if parted.named_quantity().is_none() => whole,
            _ => parted,
        }
    }

    /// What the name says the column holds, whatever the unit says.
    fn named_quantity(&self) -> Option<Quantity> {
        vocabulary::quantity(&self.name)
    }

    /// What the column holds, by its name or, where the name is a unit alone, by that.
    pub fn quantity(&self) -> Option<Quantity> {
        match (&self.unit, self.name.as_str()) {
            (Some(Ok(unit)), "") => Some(unit.quantity()),
            // A letter that something else follows than a unit of it is no name: `X (Sequence)`, `x (ms)`.
            (Some(unit), name) if name.chars().count() == 1 && (unit.is_err() || self.contradicts_itself()) => None,
            _ => self.named_quantity(),
        }
    }

    /// Whether the unit is none of what the name says; a sensor's volts are one of its displacement.
    pub fn contradicts_itself(&self) -> bool {
        let (Some(Ok(unit)), Some(named)) = (&self.unit, self.named_quantity()) else { return false };
        let volts_of_sensor = (named, unit.quantity()) == (Quantity::Displacement, Quantity::Voltage);
        unit.quantity() != named && !volts_of_sensor
    }

    /// Whether the name says that the column is an estimate, as `piezo record` names its displacement and `piezo
    /// estimate` what it writes.
    pub fn says_estimated(&self) -> bool {
        matches!(self.name.split(' ').next(), Some("estimated" | "estimate"))
    }

    /// Whether the name says that the column is beside the matter: an error, a target, a supply.
    pub fn says_other(&self) -> bool {
        vocabulary::is_other(&self.name)
    }

    /// Whether the name is a displacement sensor's.
    pub fn is_sensor(&self) -> bool {
        vocabulary::is_sensor(&self.name)
    }

    /// The unit, if it is one of `quantity`.
    pub fn unit_of(&self, quantity: Quantity) -> Option<Unit> {
        let unit = *self.unit.as_ref()?.as_ref().ok()?;
        (unit.quantity() == quantity).then_some(unit)
    }

    /// The unit of this column when it is read as `quantity`.
    pub fn unit_as(&self, quantity: Quantity, example: &str) -> Result<Option<Unit>, Fault> {
        let (column, example) = (excerpt(&self.text), example.to_owned());
        match self.unit.clone().transpose() {
            Err(UnknownUnit(unit)) => {
                // Which of the units it is, the file does not say.
                let open = |of: &str| match of.split_once(':').filter(|(is, _)| is.starts_with(&quantity.to_string())) {
                    Some((is, _)) => format!("{is}:<UNIT>"),
                    None => of.to_owned(),
                };
                let example = example.split(',').map(open).collect::<Vec<_>>().join(",");
                Err(Fault::UnknownUnit { column, unit: UnknownUnit(excerpt(&unit)), example })
            }
            Ok(Some(unit)) if unit.quantity() != quantity => {
                Err(Fault::WrongDimension { column, quantity, unit, example })
            }
            Ok(unit) => Ok(unit),
        }
    }
}

fn normalised(name: &str) -> String {
    let lower = name.to_lowercase();
    let mut words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).collect();
    if words.last() == Some(&"in") {
        words.pop();
    }
    words.join(" ")
}

/// The only column of that name: as written, else without unit, case and punctuation.
pub(super) fn find(labels: &[Label], name: &str) -> Option<usize> {
    let wanted = Label::new(name);
    let unique = |same: &dyn Fn(&Label) -> bool| {
        let mut found = labels.iter().enumerate().filter(|(_, label)| same(label));
        let (index, _) = found.next()?;
        found.next().is_none().then_some(index)
    };
    unique(&|label| label.text == wanted.text).or_else(|| {
        unique(&|label| label.name == normalised(name) || (label.name == wanted.name && label.unit == wanted.unit))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_as(name: &str) -> (Option<Quantity>, Option<Unit>) {
        let label = Label::new(name);
        let unit = label.unit.and_then(Result::ok);
        (Label::new(name).quantity(), unit)
    }

    #[test]
    fn names_and_units_in_the_usual_spellings() {
        let displacement = (Some(Quantity::Displacement), Some(Unit::Micrometre));
        for name in [
            "displacement_um",
            "Displacement [\u{3bc}m]",
            "y / \u{b5}m",
            "pos in micron",
            "x.um",
            "Measured displacement, um",
            "estimated_displacement_um",
            "um",
        ] {
            assert_eq!(read_as(name), displacement, "{name}");
        }
        let voltage = (Some(Quantity::Voltage), Some(Unit::Millivolt));
        for name in ["U_mV", "V (mV)", "drive-voltage [mV]", "mV"] {
            assert_eq!(read_as(name), voltage, "{name}");
        }
        assert_eq!(read_as("Drive_Voltage"), (Some(Quantity::Voltage), None));
        assert_eq!(read_as("voltage (furlong)"), (Some(Quantity::Voltage), None));
        for name in
            ["Piezo Voltage of output chan 1", "Spannung [V]", "Tension (V)", "电压（V）", "Ua voltage 1", "U / V"]
        {
            let quantity = read_as(name).0;
            assert_eq!(quantity == Some(Quantity::Voltage), name != "Ua voltage 1", "{name}");
        }
        for name in [
            "Current Position of axis 1",
            "Auslenkung [\u{b5}m]",
            "d\u{e9}placement_um",
            "変位(um)",
            "Sensor position",
            "Current Position of axis1",
        ] {
            assert_eq!(read_as(name).0, Some(Quantity::Displacement), "{name}");
        }
        for name in ["Zeit [s]", "Temps (s)", "时间(s)", "timestamp"] {
            assert_eq!(read_as(name).0, Some(Quantity::Time), "{name}");
        }
    }

    #[test]
    fn an_estimate_is_known_by_its_name() {
        for name in
            ["estimate_um", "estimated_displacement_um", "Estimated Displacement [nm]", "estimated position / um"]
        {
            assert!(Label::new(name).says_estimated(), "{name}");
        }
        for name in ["displacement_um", "measured displacement (um)", "um", "underestimated_um"] {
            assert!(!Label::new(name).says_estimated(), "{name}");
        }
    }

    #[test]
    fn other_names_claim_nothing() {
        for name in [
            "position error_um",
            "sensor_V",
            "phase (deg)",
            "",
            "voltages",
            "m_kg",
            "X (Sequence)",
            "x(:,1)",
            "Channel A (V)",
        ] {
            assert_eq!(Label::new(name).quantity(), None, "{name}");
        }
    }
}
