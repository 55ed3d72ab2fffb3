//! What a log holds, before anything is fitted to it: its rate, the ranges and the noise of what was recorded, where it
//! stands still, and which amplitudes it has at which frequencies.
//!
//! A log passes by once: [`survey`] needs at most some 450 MB however long it is. Of a log with more than 2¹⁸ rows,
//! neighbouring rows are kept as their extremes, and of one with more than 2²² no flaws are looked for, which takes
//! 100 MB.

mod ahead;
mod beyond;
mod blocks;
mod character;
mod clock;
mod corners;
mod deadband;
mod flaw;
mod half_cycle;
mod hum;
mod implausible;
mod noise;
mod other_scale;
mod reversal_curves;
pub mod reversals;
mod rows;
mod series;
pub mod settled;
mod signal;
mod start;
mod stillness;
mod stroke;
mod swings;
mod turns;

use recordings::log::{Chosen, LogError, MOST_HOLES, Reading, Remark, Row};
use serde::Serialize;

pub use ahead::{Ahead, ahead};
pub use beyond::ends_go_beyond;
pub use blocks::Block;
pub use character::Character;
pub use clock::{Clock, RateSource};
pub use corners::{corners, corners_left_out, stands_still_s};
pub use deadband::{deadband, noise};
pub use flaw::{Flaw, Stretch, flaws, gravest, measured, sound};
pub use hum::{Hum, HumRead, hum};
pub use implausible::Implausible;
pub use noise::noise_of;
pub use other_scale::{OtherScale, middle, other_scale};
pub use reversal_curves::ReversalCurves;
pub use rows::Found;
pub use series::Series;
pub use signal::{correlation_of, falls, is_noise, range};
pub use start::{RESTS_S, begins_in_motion, prepared, repaired};
pub use stillness::Stillness;
pub use stroke::stroke;
pub use swings::{Cell, Swings};
pub use turns::{held_in_turns, read_where};

use blocks::Blocks;
use rows::Rows;
use series::SeriesTally;
use stillness::Watch;

/// What a log holds.
#[derive(Debug, Clone, Serialize)]
pub struct Survey {
    /// The columns that were read.
    pub columns: Vec<ColumnRead>,
    /// What is to be said of how they were understood.
    pub remarks: Vec<Remark>,
    /// How many rows there are.
    pub rows: u64,
    /// Rows that have no number for the voltage or the displacement.
    pub rows_without_a_number: u64,
    /// More rows have no number for one of them, or were never written, than a log may have: nothing is learnt from it.
    pub too_many_holes: bool,
    /// When the rows were recorded.
    pub clock: Clock,
    /// The voltage, V, where there is one.
    pub voltage: Option<Series>,
    /// The displacement, µm, where there is one.
    pub displacement: Option<Series>,
    /// The displacement is a device's estimate and no sensor's.
    pub displacement_estimated: bool,
    /// Without what is no measurement they do not go together in a piezo actuator.
    pub implausible: Option<Implausible>,
    /// The displacement runs ahead of the voltage; `None` also where there are too many rows to look for it.
    pub ahead: Option<Ahead>,
    /// What the sensor picks up of the mains; `None` also where there are too many rows to look for it.
    pub hum: Option<HumRead>,
    /// The longest stretch in which the displacement is one number and the voltage moves most.
    pub frozen: Option<Stillness>,
    /// What is no measurement, the gravest of each kind; `None` where there are too many rows to look for it.
    pub flaws: Option<Vec<Found>>,
    /// How long the voltage stands at first, s: little of a log that was begun in motion. `None` without a voltage or
    /// without a rate.
    pub stands_at_first_s: Option<f64>,
    /// The voltage's reversals, and the half cycles between them.
    pub swings: Swings,
    /// Rows that are kept as one: 1 unless the log is long.
    pub rows_a_block: u64,
    /// The log's course.
    #[serde(skip)]
    pub blocks: Vec<Block>,
}

/// A column that was read.
#[derive(Debug, Clone, Serialize)]
pub struct ColumnRead {
    /// What it holds: time, voltage or displacement.
    pub quantity: String,
    /// Its number, counted from 1.
    pub number: usize,
    /// Its name in the file.
    pub name: String,
    /// Its unit, or a sensor's unit and scale.
    pub unit: String,
}

impl From<Chosen> for ColumnRead {
    fn from(Chosen { quantity, number, name, unit }: Chosen) -> Self {
        Self { quantity: quantity.to_string(), number, name, unit }
    }
}

/// Reads a log once, to its end. A row that has no number for the voltage or the displacement, where it is opened with
/// holes ([`ReadOptions::holes`](recordings::log::ReadOptions::holes)), is a flaw, and counts for nothing else.
///
/// # Errors
/// The first row that is none; a stated rate that the file contradicts.
pub fn survey(reading: Reading<'_>) -> Result<Survey, LogError> {
    let remarks = reading.remarks();
    let displacement_estimated = reading.displacement_estimated();
    let columns = reading.chosen().into_iter().map(ColumnRead::from).collect();
    let stated = reading.stated_period()?.map(|seconds| (seconds, reading.sample_time().map(|time| time.name.clone())));
    let mut tally = Tally::default();
    reading.rows(&mut |row| tally.row(row))?;
    tally.kept.bridge();
    let clock = tally.clock.result(tally.rows, stated);
    let period = 1.0 / clock.hz;
    let (voltage, displacement) = (tally.voltage.result(), tally.displacement.result());
    let swings = match &voltage {
        Some(series) => swings::find(tally.blocks.all(), series, period, &tally.clock.behind_gaps()),
        None => Swings::default(),
    };
    let mut flaws = tally.kept.flaws(&clock);
    let told = |flaw: &Flaw| {
        let row = (flaw.at().to_s * clock.hz).round() as u64;
        matches!(flaw, Flaw::Missing { .. }) && tally.clock.late_near(row)
    };
    flaws.iter_mut().for_each(|flaws| flaws.retain(|flaw| !told(flaw)));
    let implausible = match &flaws {
        Some(flaws) => tally.kept.implausible(flaws, &clock),
        None => displacement.zip(voltage).and_then(|(y, v)| Implausible::of(y.high - y.low, v.high - v.low)),
    };
    Ok(Survey {
        columns,
        remarks,
        rows: tally.rows,
        rows_without_a_number: tally.without,
        too_many_holes: tally.too_many_holes(clock.hz),
        implausible,
        displacement,
        displacement_estimated,
        frozen: tally.watch.result(voltage.as_ref()),
        stands_at_first_s: voltage.filter(|_| period.is_finite()).map(|Series { low, high, noise, .. }| {
            tally.blocks.rows_at_rest(start::still_v(high - low, noise)) as f64 * period
        }),
        voltage,
        ahead: tally.kept.ahead(&clock).filter(|_| !displacement_estimated),
        hum: tally.kept.hum(&clock).filter(|_| !displacement_estimated),
        flaws: flaws.map(|flaws| Found::of(&flaws, &clock, &tally.clock)),
        clock,
        swings,
        rows_a_block: tally.blocks.rows_a_block(),
        blocks: tally.blocks.into_all(),
    })
}

/// What is known of the rows so far.
#[derive(Default)]
struct Tally {
    rows: u64,
    without: u64,
    /// Rows without a number for the voltage, and for the displacement.
    holes: [u64; 2],
    clock: clock::Tally,
    voltage: SeriesTally,
    displacement: SeriesTally,
    watch: Watch,
    kept: Rows,
    blocks: Blocks,
}

impl Tally {
    fn row(&mut self, row: Row) {
        let none = [row.voltage, row.displacement].map(|of| of.is_some_and(f64::is_nan));
        self.without += u64::from(none.contains(&true));
        self.holes.iter_mut().zip(none).for_each(|(holes, none)| *holes += u64::from(none));
        self.clock.add(row.time);
        self.voltage.add(row.voltage);
        self.displacement.add(row.displacement);
        if let (Some(voltage), Some(displacement)) = (row.voltage, row.displacement) {
            if !voltage.is_nan() && !displacement.is_nan() {
                self.watch.add(self.rows, voltage, displacement);
            }
            self.kept.add(voltage, displacement);
        }
        self.blocks.add(row.voltage.unwrap_or(f64::NAN), row.displacement.unwrap_or(f64::NAN));
        self.rows += 1;
    }

    /// Whether reading it with its holes bridged is refused, at this rate, Hz.
    fn too_many_holes(&self, hz: f64) -> bool {
        let gaps = self.clock.missing(hz).map(|(_, at)| ((at.to_s - at.from_s) * hz).round() + 1.0).sum::<f64>();
        let most = self.holes.into_iter().max().unwrap_or(0) as f64;
        gaps.max(most) > MOST_HOLES * self.rows as f64
    }
}

#[cfg(test)]
mod tests;
