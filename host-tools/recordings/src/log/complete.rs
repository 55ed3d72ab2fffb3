//! Whether the columns that were chosen are all that a log needs, and what is wrong where they are not.

use measurement_files::{Column, Quantity, excerpt};

use super::channels::{Channels, QUANTITIES};
use super::choose::Chooser;
use super::fault::Fault;
use super::guess;
use super::read_options::Need;

impl Chooser<'_> {
    /// Refuses a choice of columns without voltage, without a displacement that is required, and without a time.
    pub(super) fn check_complete(&self, channels: &Channels) -> Result<(), Fault> {
        let options = self.options;
        if let Some(fault) = self.text_column(channels) {
            return Err(fault);
        }
        let required = [
            (Quantity::Voltage, options.voltage_required),
            (Quantity::Displacement, options.displacement == Need::Required),
        ];
        let missing = |&(quantity, required): &(Quantity, bool)| required && channels.get(quantity).is_none();
        if let Some((quantity, _)) = required.into_iter().find(missing) {
            let guess = self.guess();
            let open = match guess.get(quantity) {
                Some(_) => String::new(),
                None => format!(",{quantity}=<COLUMN>:<UNIT>"),
            };
            let with_sensor = guess.displacement.filter(|displacement| self.may_be_volts(displacement.index));
            return Err(Fault::NoColumn {
                quantity,
                columns: self.listed(),
                rate_needed: self.rate_needed(guess.time.is_some()),
                example: format!("{guess}{open}").trim_start_matches(',').to_owned(),
                with_sensor: with_sensor.map(|_| guess::with_sensor(&guess, self.options.sensor)),
            });
        }
        if self.rate_needed(channels.time.is_some()) {
            return Err(Fault::NoTime { columns: self.listed() });
        }
        Ok(())
    }

    /// What is wrong with a column that is named as a quantity for which no other was chosen, and that holds text.
    fn text_column(&self, channels: &Channels) -> Option<Fault> {
        let missing = |quantity: &Quantity| {
            let wanted = match quantity {
                Quantity::Time => self.rate_needed(false),
                Quantity::Voltage => self.options.voltage_required,
                Quantity::Displacement => self.options.displacement == Need::Required,
            };
            wanted && channels.get(*quantity).is_none()
        };
        QUANTITIES.into_iter().filter(missing).find_map(|quantity| {
            let claims = |(at, column): &(usize, &Column)| {
                !column.numeric && column.text.is_some() && self.labels[*at].quantity() == Some(quantity)
            };
            let (at, column) =
                self.table.columns.iter().enumerate().find(|column| self.table.named && claims(column))?;
            let value = column.text.as_deref().unwrap_or_default();
            let remedy = match thousands(value) {
                true => "remove the separators between the thousands, or export with one decimal mark and no other",
                false => "correct the values, or choose another column",
            };
            Some(Fault::TextColumn { quantity, column: excerpt(&self.labels[at].text), value: excerpt(value), remedy })
        })
    }

    pub(super) fn rate_needed(&self, has_time: bool) -> bool {
        !has_time && self.options.sample_rate.is_none() && self.table.sample_time.is_none()
    }

    /// That a column states no unit; a channel that says neither what it holds nor its unit may be a sensor's volts.
    pub(super) fn missing_unit(&self, index: usize, example: String) -> Fault {
        let guess = self.guess();
        let bare = |at: usize| {
            let label = &self.labels[at];
            label.quantity().is_none() && QUANTITIES.iter().all(|&of| label.unit_of(of).is_none())
        };
        let with_sensor = guess.displacement.filter(|displacement| bare(displacement.index));
        Fault::MissingUnit {
            column: excerpt(&self.labels[index].text),
            example,
            with_sensor: with_sensor.map(|_| guess::with_sensor(&guess, self.options.sensor)),
        }
    }

    fn may_be_volts(&self, index: usize) -> bool {
        self.labels[index].unit_of(Quantity::Displacement).is_none()
    }
}

/// Whether a text is a number but for the marks that group its digits: `1,234.5`, `1.234,5`, `47.523`, `12 345`.
fn thousands(text: &str) -> bool {
    let digits = text.trim().trim_start_matches(['+', '-']);
    let mark = |c: char| ".,' \u{a0}\u{202f}".contains(c);
    digits.starts_with(|c: char| c.is_ascii_digit())
        && digits.contains(mark)
        && digits.chars().all(|c| c.is_ascii_digit() || mark(c))
}
