//! A log that is being read: which columns were chosen, and its rows one after the other.

use std::io::Read;
use std::path::{Path, PathBuf};

use measurement_files::{
    Column, Fault as FileFault, Format, PlacedFault as PlacedFileFault, Quantity, SampleTime, Table, place,
};

use super::channels::{Channel, Channels, QUANTITIES, Remark};
use super::choose::choose;
use super::error::PlacedFault;
use super::fault::Fault;
use super::read_options::ReadOptions;
use super::recording::{MINIMUM_ROWS, Recording};
use super::{LogError, clock};

/// A log whose columns are known and whose rows have not been read.
pub struct Reading<'a> {
    path: PathBuf,
    table: Table<'a>,
    channels: Channels,
    stated_rate: Option<f64>,
    holes: bool,
}

/// One row of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Time, s, where a column holds it.
    pub time: Option<f64>,
    /// Voltage, V, where a column holds it.
    pub voltage: Option<f64>,
    /// Displacement, µm, where a column holds it.
    pub displacement: Option<f64>,
}

/// A column that was chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Chosen {
    /// The quantity that the column holds.
    pub quantity: Quantity,
    /// Its number, counted from 1.
    pub number: usize,
    /// Its name in the file, empty where there is none.
    pub name: String,
    /// Its unit, or the scale of a sensor's volts.
    pub unit: String,
}

impl<'a> Reading<'a> {
    pub(super) fn new(bytes: impl Read + 'a, path: &Path, options: &ReadOptions) -> Result<Self, PlacedFault> {
        if let Some(rate) = options.sample_rate {
            clock::check_rate(rate)?;
        }
        let table = measurement_files::open(bytes).map_err(|fault| placed(fault, &[]))?;
        let channels = choose(&table, options).map_err(|fault| fault.at(table.header))?;
        let &ReadOptions { sample_rate: stated_rate, holes, .. } = options;
        Ok(Self { path: path.to_owned(), table, channels, stated_rate, holes })
    }

    /// Every column of the file.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.table.columns
    }

    /// The columns that were chosen.
    #[must_use]
    pub fn chosen(&self) -> Vec<Chosen> {
        let chosen = |quantity: &Quantity| {
            let Channel { index, unit, sensor, .. } = self.channels.get(*quantity)?;
            let unit = sensor.map_or_else(|| unit.to_string(), |sensor| format!("{unit}, {sensor}"));
            Some(Chosen { quantity: *quantity, number: index + 1, name: self.table.columns[index].name.clone(), unit })
        };
        QUANTITIES.iter().filter_map(chosen).collect()
    }

    /// What is to be said of how the columns were understood.
    #[must_use]
    pub fn remarks(&self) -> Vec<Remark> {
        self.channels.remarks()
    }

    /// Whether the displacement is an estimate and no sensor's, by the name of its column.
    #[must_use]
    pub fn displacement_estimated(&self) -> bool {
        self.channels.displacement_estimated
    }

    /// What the file says about its sample time outside its columns.
    #[must_use]
    pub fn sample_time(&self) -> Option<&SampleTime> {
        self.table.sample_time.as_ref()
    }

    /// The sample period that no column states, s: the file's, or that of the stated rate.
    ///
    /// # Errors
    /// The file and the stated rate disagree.
    pub fn stated_period(&self) -> Result<Option<f64>, LogError> {
        if self.channels.time.is_some() || (self.table.sample_time.is_none() && self.stated_rate.is_none()) {
            return Ok(None);
        }
        let period = clock::without_time(self.table.sample_time.as_ref(), self.stated_rate);
        period.map(Some).map_err(|fault| fault.in_file(&self.path))
    }

    /// Hands each row to `visit`, to the file's end. Nothing is kept.
    ///
    /// # Errors
    /// The first row that is none.
    pub fn rows(self, visit: &mut dyn FnMut(Row)) -> Result<(), LogError> {
        let path = self.path.clone();
        self.visit(visit).map_err(|fault| fault.in_file(&path))
    }

    /// The same, with the fault's place.
    fn visit(self, visit: &mut dyn FnMut(Row)) -> Result<(), PlacedFault> {
        let chosen: Vec<(Quantity, Channel)> =
            QUANTITIES.iter().filter_map(|&quantity| Some((quantity, self.channels.get(quantity)?))).collect();
        let wanted: Vec<usize> = chosen.iter().map(|(_, channel)| channel.index).collect();
        let quantities: Vec<Quantity> = chosen.iter().map(|(quantity, _)| *quantity).collect();
        let slot = |quantity| quantities.iter().position(|&other| other == quantity);
        let slots = QUANTITIES.map(slot);
        // A finite number of a large unit may be none of a small one; what is none in the file is a hole, but
        // for a time.
        let refused = |(quantity, channel): &(Quantity, Channel), value: f64| {
            channel.to_base(value).is_infinite() || value.is_nan() && *quantity == Quantity::Time
        };
        let mut overflow = None;
        let mut rows = 0;
        let first_row = self.table.first_row;
        let read = self.table.rows(&wanted, self.holes, &mut |values| {
            let base = |slot: Option<usize>| slot.map(|slot| chosen[slot].1.to_base(values[slot]));
            let [time, voltage, displacement] = slots.map(base);
            if overflow.is_none() {
                let slot = (0..values.len()).find(|&slot| refused(&chosen[slot], values[slot]));
                overflow = slot.map(|slot| (rows, chosen[slot].0, values[slot]));
            }
            rows += 1;
            visit(Row { time, voltage, displacement });
        });
        if let Some((row, quantity, value)) = overflow {
            let fault = Fault::NotFinite { quantity, value: super::Number(value).to_string() };
            return Err(fault.at(place(first_row, row)));
        }
        read.map_err(|fault| placed(fault, &quantities))
    }

    /// Reads every row.
    pub(super) fn recording(self) -> Result<Recording, PlacedFault> {
        let channels = self.channels;
        let mut recording = Recording {
            channels,
            first_row: self.table.first_row,
            sample_time: self.table.sample_time.clone(),
            time: channels.time.map(|_| Vec::new()),
            voltage: Vec::new(),
            displacement: channels.displacement.map(|_| Vec::new()),
            holes: Vec::new(),
            put_back: Vec::new(),
        };
        self.visit(&mut |row| {
            recording.voltage.extend(row.voltage);
            let Recording { time, displacement, .. } = &mut recording;
            for (series, value) in [(time, row.time), (displacement, row.displacement)] {
                if let Some(series) = series {
                    series.extend(value);
                }
            }
        })?;
        Ok(recording)
    }
}

/// A file's fault as a log's: by the quantity that a column holds.
fn placed(PlacedFileFault(at, fault): PlacedFileFault, quantities: &[Quantity]) -> PlacedFault {
    // A fault of a field names one of the columns that were asked for.
    let quantity = |column: usize| quantities.get(column).copied().unwrap_or(Quantity::Displacement);
    let fault = match fault {
        FileFault::Unreadable(error) => Fault::Unreadable(error),
        FileFault::Empty => Fault::Empty,
        FileFault::Binary { what } => Fault::Binary { what },
        FileFault::NoRows => Fault::FewRows { rows: 0, minimum: MINIMUM_ROWS },
        FileFault::DecimalCommas => Fault::DecimalCommas,
        FileFault::UnevenRow { found, expected } => Fault::UnevenRow { found, expected },
        FileFault::EmptyLine => Fault::EmptyLine,
        FileFault::NotANumber { column, value } => Fault::NotANumber { quantity: quantity(column), value },
        FileFault::NotFinite { column, value } => Fault::NotFinite { quantity: quantity(column), value },
        FileFault::MissingField { column } => Fault::MissingField { quantity: quantity(column) },
        FileFault::MatVersion { what } => Fault::MatVersion { what },
        FileFault::Damaged { format: Format::Matlab, what } => Fault::MatDamaged { what },
        FileFault::Damaged { format: Format::Tdms, what } => Fault::TdmsDamaged { what },
        FileFault::NoSignals { format: Format::Matlab, variables } => Fault::MatNoLog { variables },
        FileFault::NoSignals { format: Format::Tdms, variables } => Fault::TdmsNoLog { variables },
        FileFault::SeveralArrays { variables, first } => Fault::MatSeveral { variables, first },
    };
    fault.at(at)
}
