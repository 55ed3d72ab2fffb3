//! Which columns are likely meant, for a message that the user corrects; never to read a log by.

use measurement_files::{Column, Quantity, Unit};

use super::channels::{Channel, Channels, QUANTITIES};
use super::label::Label;
use super::sensitivity::Sensitivity;

/// The likely columns of the wanted quantities: by name, by unit, by what the numbers do, else in order. Without
/// `time_needed` no column is taken for the time by its numbers.
pub(super) fn channels(columns: &[Column], labels: &[Label], time_needed: bool, wanted: &[Quantity]) -> Channels {
    // A setting beside the first rows is no column.
    let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
    let numeric = |at: &usize| columns[*at].numeric && columns[*at].values.len() == rows;
    let all: Vec<usize> = (0..columns.len()).filter(numeric).collect();
    // None can be spared for the time that is needed for something else.
    let seek_clock = time_needed && all.len() >= wanted.len();
    // One that rests yet is told from a setting where two others move.
    let moving = all.iter().filter(|at| is_signal(&columns[**at].values)).count() > 1;
    let mut channels = Channels::default();
    for &quantity in wanted {
        let free = || all.iter().copied().filter(|at| !channels.has(*at));
        let named = free().find(|&at| labels[at].quantity() == Some(quantity));
        let free = || free().filter(|&at| !labels[at].says_other());
        let in_unit = || free().find(|&at| labels[at].unit_of(quantity).is_some());
        let by_numbers = || match quantity {
            Quantity::Time => free().find(|&at| columns[at].stamps || (seek_clock && is_clock(&columns[at].values))),
            _ => free().find(|&at| moving && is_signal(&columns[at].values) && is_free_of(labels, at, quantity)),
        };
        let in_order = || {
            let is_number = |at: usize| Some(&at) == all.first() && counts_rows(&columns[at].values);
            let may_be = |at: usize| is_free_of(labels, at, quantity) && !is_number(at);
            free().find(|&at| quantity != Quantity::Time && may_be(at))
        };
        if let Some(index) = named.or_else(in_unit).or_else(by_numbers).or_else(in_order) {
            let unit = labels[index].unit_of(quantity).unwrap_or(quantity.base());
            channels = channels.with(quantity, Channel::new(index, unit));
        }
    }
    channels
}

/// Whether a column does not claim to be something else by name or unit; of a displacement, volts may be its sensor's.
fn is_free_of(labels: &[Label], at: usize, quantity: Quantity) -> bool {
    let others = QUANTITIES.into_iter().filter(|&other| other != quantity && other != Quantity::Voltage);
    labels[at].quantity().is_none() && others.into_iter().all(|other| labels[at].unit_of(other).is_none())
}

/// Whether values change, otherwise than a clock's.
fn is_signal(values: &[f64]) -> bool {
    values.windows(2).any(|pair| pair[0] != pair[1]) && !is_clock(values)
}

/// Whether values increase by even steps, as a clock does.
fn is_clock(values: &[f64]) -> bool {
    let [first, .., last] = values else { return false };
    let mean = (last - first) / (values.len() - 1) as f64;
    mean > 0.0 && values.windows(2).all(|pair| (pair[1] - pair[0] - mean).abs() <= 0.5 * mean)
}

/// Whether values are the rows' numbers, as a first column may have them.
fn counts_rows(values: &[f64]) -> bool {
    values.len() > 2 && values.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}

/// The columns as stated where the displacement's holds a sensor's volts: with its scale if that is known, else with a
/// place for it.
pub(super) fn with_sensor(channels: &Channels, sensor: Option<Sensitivity>) -> String {
    let Some(displacement) = channels.displacement else { return channels.to_string() };
    let others = Channels { displacement: None, ..*channels };
    let comma = if others == Channels::default() { "" } else { "," };
    let scale = sensor.map_or_else(|| format!("<N>{}/{}", Unit::Micrometre, Unit::Volt), |sensor| sensor.to_string());
    format!("{others}{comma}{}={}:{scale}", Quantity::Displacement, displacement.index + 1)
}
