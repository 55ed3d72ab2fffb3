//! Which column holds what: from names such as `displacement (µm)`, from units, or as the user says.

use measurement_files::{Column, Place, Quantity, Table, Unit, excerpt};

use super::channels::{Channel, Channels, QUANTITIES};
use super::columns::{Columns, Position};
use super::fault::Fault;
use super::guess;
use super::label::{Label, find};
use super::read_options::{Need, ReadOptions};
use super::sensitivity::Sensitivity;

/// The columns of a table that hold the log: as stated, and where nothing is stated as the table says itself.
pub(super) fn choose(table: &Table<'_>, options: &ReadOptions) -> Result<Channels, Fault> {
    let labels: Vec<Label> = table.columns.iter().map(|column| Label::new(&column.name)).collect();
    let chooser = Chooser { table, labels: &labels, options };
    let mut channels = match &options.columns {
        Some(columns) => chooser.stated(columns)?,
        None => Channels::default(),
    };
    if table.named {
        channels = chooser.named(channels)?;
    } else if options.columns.is_none() {
        channels = chooser.unnamed()?;
    }
    chooser.check_complete(&channels)?;
    // It was chosen nevertheless, so that no other quantity is taken from its column.
    if options.displacement == Need::Ignored {
        channels.displacement = None;
    }
    channels.displacement_estimated =
        table.named && channels.displacement.is_some_and(|displacement| labels[displacement.index].says_estimated());
    Ok(channels)
}

/// What a choice is made from.
pub(super) struct Chooser<'a> {
    pub table: &'a Table<'a>,
    pub labels: &'a [Label],
    pub options: &'a ReadOptions,
}

impl Chooser<'_> {
    /// The columns that the user states.
    fn stated(&self, columns: &Columns) -> Result<Channels, Fault> {
        let mut channels = Channels::default();
        let count = self.labels.len();
        for (quantity, column) in columns.stated() {
            let index = match &column.at {
                Position::Number(number) => (1..=count).contains(number).then(|| number - 1),
                Position::Name(name) => find(self.labels, name).filter(|_| self.table.named),
            };
            let index = index.ok_or_else(|| Fault::NoSuchColumn {
                wanted: excerpt(&column.at.to_string()),
                columns: self.listed(),
            })?;
            let scaled =
                (quantity == Quantity::Displacement).then_some(column.sensor.or(self.options.sensor)).flatten();
            let channel = match (column.unit, scaled) {
                (None, Some(sensor)) => self.sensor_channel(index, sensor)?,
                (Some(unit), _) => self.restated(index, unit)?,
                (None, None) => Channel::new(index, self.unit(index, quantity)?.unwrap_or(quantity.base())),
            };
            channels = channels.with(quantity, channel);
        }
        Ok(channels)
    }

    /// A column in the unit that the user states, which measures what the column's own unit does.
    fn restated(&self, index: usize, unit: Unit) -> Result<Channel, Fault> {
        let header = match self.unit(index, unit.quantity()) {
            Err(fault @ Fault::WrongDimension { .. }) => return Err(fault),
            header => header.ok().flatten(),
        };
        Ok(Channel { overruled: header.filter(|&header| header != unit), ..Channel::new(index, unit) })
    }

    /// The unit that a column states, if it states one.
    fn unit(&self, index: usize, quantity: Quantity) -> Result<Option<Unit>, Fault> {
        match self.table.named {
            true if !self.table.columns[index].stamps => self.labels[index].unit_as(quantity, &self.example(None)),
            _ => Ok(None),
        }
    }

    /// A column that holds a sensor's volts.
    fn sensor_channel(&self, index: usize, sensor: Sensitivity) -> Result<Channel, Fault> {
        let label = &self.labels[index];
        if let Some(unit) = label.unit_of(Quantity::Displacement) {
            return Err(Fault::SensitivityOfLength { column: excerpt(&label.text), unit });
        }
        let unit = label.unit_of(Quantity::Voltage).unwrap_or(Unit::Volt);
        Ok(Channel { sensor: Some(sensor), ..Channel::new(index, unit) })
    }

    /// What names and units add to what is stated.
    fn named(&self, mut channels: Channels) -> Result<Channels, Fault> {
        let rate_stated = self.options.columns.is_some() && self.options.sample_rate.is_some();
        for quantity in QUANTITIES {
            let left_out = quantity == Quantity::Time && rate_stated;
            if channels.get(quantity).is_some() || left_out {
                continue;
            }
            let found = match self.by_name(quantity, &channels) {
                Ok(None) if quantity == Quantity::Voltage && !self.options.voltage_required => Ok(None),
                Ok(None) => self.by_unit(quantity, &channels),
                claimed => claimed,
            };
            // What is wrong with a column that is not looked at does not matter.
            let ignored = quantity == Quantity::Displacement && self.options.displacement == Need::Ignored;
            if let Some(channel) = if ignored { found.ok().flatten() } else { found? } {
                channels = channels.with(quantity, channel);
            }
        }
        Ok(channels)
    }

    fn by_name(&self, quantity: Quantity, channels: &Channels) -> Result<Option<Channel>, Fault> {
        let mut claims: Vec<usize> = self.free(channels).filter(|&at| self.claims(at, quantity)).collect();
        // Numbers tell the time better than stamps; and several channels may each bring the same time.
        if claims.iter().any(|&at| !self.table.columns[at].stamps) {
            claims.retain(|&at| !self.table.columns[at].stamps);
        }
        // A name that its own unit contradicts is none where another column is what it says.
        let other =
            |at: usize| self.labels[at].quantity().is_none_or(|of| of == quantity) && !self.labels[at].says_other();
        let has_unit = |at: usize| other(at) && self.labels[at].unit_of(quantity).is_some();
        if self.free(channels).any(has_unit) {
            claims.retain(|&at| !self.labels[at].contradicts_itself());
        }
        let columns = &self.table.columns;
        claims.dedup_by(|later, first| columns[*later].values == columns[*first].values);
        let index = match claims[..] {
            [] => return Ok(None),
            [index] => index,
            [first, second, ..] => {
                let name = |at: usize| excerpt(&self.labels[at].text);
                let example = self.example(None);
                return Err(Fault::TwoClaims { quantity, first: name(first), second: name(second), example });
            }
        };
        let label = &self.labels[index];
        let in_volts = quantity == Quantity::Displacement && label.unit_of(Quantity::Voltage).is_some();
        match self.options.sensor {
            Some(sensor) if quantity == Quantity::Displacement => return self.sensor_channel(index, sensor).map(Some),
            None if in_volts => return Err(self.no_sensitivity(index)),
            _ => {}
        }
        if columns[index].stamps {
            return Ok(Some(Channel::new(index, Unit::Second)));
        }
        let example = self.example(None);
        let unit = label.unit_as(quantity, &example)?;
        let unit = unit.ok_or_else(|| self.missing_unit(index, example))?;
        Ok(Some(Channel::new(index, unit)))
    }

    /// The only column that can be a quantity by its unit.
    fn by_unit(&self, quantity: Quantity, channels: &Channels) -> Result<Option<Channel>, Fault> {
        let with_unit = |of: Quantity| {
            let fits = move |&at: &usize| {
                let label = &self.labels[at];
                label.unit_of(of).is_some() && label.quantity().is_none() && !label.says_other()
            };
            self.free(channels).filter(fits).collect::<Vec<usize>>()
        };
        let mut found = with_unit(quantity);
        if quantity == Quantity::Voltage {
            found.retain(|&at| !self.labels[at].is_sensor());
        }
        if quantity == Quantity::Displacement && (found.is_empty() || self.options.sensor.is_some()) {
            return match (self.sensor(&with_unit(Quantity::Voltage))?, found.first(), self.options.sensor) {
                (None, Some(&index), Some(sensor)) => self.sensor_channel(index, sensor).map(Some),
                (found, ..) => Ok(found),
            };
        }
        match found[..] {
            [] => Ok(None),
            [index] => Ok(self.labels[index].unit_of(quantity).map(|unit| Channel::new(index, unit))),
            _ => Err(Fault::Ambiguous { quantity, columns: self.listed(), example: self.example(Some(quantity)) }),
        }
    }

    /// The displacement sensor among columns in volts: the one that is named so, else the only one.
    fn sensor(&self, in_volts: &[usize]) -> Result<Option<Channel>, Fault> {
        let named: Vec<usize> = in_volts.iter().copied().filter(|&at| self.labels[at].is_sensor()).collect();
        let found = if named.is_empty() { in_volts } else { &named };
        match (found, self.options.sensor) {
            ([], _) => Ok(None),
            ([index], Some(sensor)) => self.sensor_channel(*index, sensor).map(Some),
            ([_], None) if self.options.displacement != Need::Required => Ok(None),
            ([index], None) => Err(self.no_sensitivity(*index)),
            _ => Err(Fault::Ambiguous {
                quantity: Quantity::Displacement,
                columns: self.listed(),
                example: self.example(Some(Quantity::Displacement)),
            }),
        }
    }

    fn no_sensitivity(&self, index: usize) -> Fault {
        let label = &self.labels[index];
        let unit = label.unit_of(Quantity::Voltage).unwrap_or(Unit::Volt);
        Fault::NoSensitivity { column: excerpt(&label.text), unit }
    }

    /// Columns of a table that nothing names: a MATLAB array of three signals has them in the documented order.
    fn unnamed(&self) -> Result<Channels, Fault> {
        let count = self.labels.len();
        if count == 3 && matches!(self.table.first_row, Place::Sample(_)) {
            return Ok(Channels::in_order(count));
        }
        let guess = self.guess();
        Err(Fault::NoHeader {
            count,
            columns: self.listed(),
            rate_needed: self.rate_needed(guess.time.is_some()),
            example: guess.to_string(),
        })
    }

    fn claims(&self, at: usize, quantity: Quantity) -> bool {
        let by_stamps = self.table.columns[at].stamps && quantity == Quantity::Time;
        by_stamps || (self.labels[at].quantity() == Some(quantity) && !self.table.columns[at].stamps)
    }

    /// Indices of the columns of numbers that have not been chosen.
    fn free<'c>(&'c self, channels: &'c Channels) -> impl Iterator<Item = usize> + 'c {
        let columns = self.table.columns.iter().enumerate();
        columns.filter(|(at, column)| column.numeric && !channels.has(*at)).map(|(at, _)| at)
    }

    pub(super) fn guess(&self) -> Channels {
        let wanted = |quantity: &Quantity| match quantity {
            Quantity::Time => true,
            Quantity::Voltage => self.options.voltage_required,
            Quantity::Displacement => self.options.displacement != Need::Ignored,
        };
        let wanted: Vec<Quantity> = QUANTITIES.into_iter().filter(wanted).collect();
        guess::channels(&self.table.columns, self.labels, self.table.sample_time.is_none(), &wanted)
    }

    /// The likely columns as they are stated; where volts can be the sensor's, with a place for its scale.
    fn example(&self, ambiguous: Option<Quantity>) -> String {
        let guess = self.guess();
        let in_volts = |displacement: Channel| self.labels[displacement.index].unit_of(Quantity::Voltage).is_some();
        match guess.displacement {
            Some(displacement) if ambiguous.is_some() && in_volts(displacement) => {
                guess::with_sensor(&guess, self.options.sensor)
            }
            _ => guess.to_string(),
        }
    }

    /// The columns, each with number, name and range, for a message.
    pub(super) fn listed(&self) -> String {
        listed(&self.table.columns)
    }
}

/// The columns of a file, each with its number, its name and the range of its values, as far as it has been read.
pub(super) fn listed(columns: &[Column]) -> String {
    const MOST: usize = 12;
    let one = |(at, column): (usize, &Column)| {
        let name = if column.name.is_empty() { String::new() } else { format!(" {:?}", excerpt(&column.name)) };
        let range = match column.values.iter().copied().filter(|value| value.is_finite()).fold(None, wider) {
            Some((low, high)) => format!(" {} … {}", super::Number(low), super::Number(high)),
            None => " no numbers".to_owned(),
        };
        format!("{}{name}{range}", at + 1)
    };
    let mut shown: Vec<String> = columns.iter().enumerate().take(MOST).map(one).collect();
    if columns.len() > MOST {
        shown.push("…".to_owned());
    }
    let rows = columns.first().map_or(0, |column| column.values.len());
    format!("{}, in the first {rows} rows", shown.join("; "))
}

fn wider(range: Option<(f64, f64)>, value: f64) -> Option<(f64, f64)> {
    Some(range.map_or((value, value), |(low, high): (f64, f64)| (low.min(value), high.max(value))))
}
