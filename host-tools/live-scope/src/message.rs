//! What the page is sent, as JSON.

use crate::column::{Column, Extent};
use serde::Serialize;

/// The board, its table and the names of what is drawn; sent once.
#[derive(Serialize)]
pub struct Facts {
    /// Of the board, in a line.
    pub board: String,
    /// Of the table, in a line.
    pub table: String,
    /// Length of a column, s.
    pub column_s: f64,
    /// Whether there is a sensor.
    pub sensor: bool,
    /// Whether its table has a ± for an estimate that was zeroed.
    pub interval: bool,
    /// Why it cannot be zeroed, where it cannot.
    pub no_zero: Option<String>,
}

/// A column, as an array: seconds; 1 where ticks are missing before or in it; least and largest voltage, V; least and
/// largest estimate, its largest half-width, least and largest of sensor and of error, µm, `null` where there is none.
#[derive(Serialize)]
pub struct Drawn(f64, u8, [f32; 2], [f32; 2], Option<f32>, Option<[f32; 2]>, Option<[f32; 2]>);

impl From<&Column> for Drawn {
    fn from(column: &Column) -> Self {
        let two = |Extent { min, max }: Extent| [min, max];
        Self(
            column.seconds,
            u8::from(column.gap),
            two(column.voltage_v),
            two(column.displacement_um),
            column.half_width_um,
            column.sensor_um.map(two),
            column.error_um.map(two),
        )
    }
}

/// Columns that have come since the message before.
#[derive(Default, Serialize)]
pub struct Columns {
    /// What is drawn over time.
    pub columns: Vec<Drawn>,
    /// Points of the loop, for each column: V, µm, V, µm …
    pub points: Vec<Vec<f32>>,
}

impl Columns {
    /// Adds a column and its points of the loop.
    pub fn push(&mut self, column: &Column) {
        self.columns.push(column.into());
        self.points.push(column.extremes.iter().flat_map(|tick| [tick.voltage_v, tick.displacement_um]).collect());
    }
}

/// The device's status in words, and what the page may ask for now.
#[derive(Default, Serialize)]
pub struct State {
    /// Why there is nothing to be seen, where there is not.
    pub gone: Option<String>,
    /// Estimate of the last tick, and least and largest of the last second, µm.
    pub displacement_um: Option<[f32; 3]>,
    /// Half-width of the last tick's estimate, µm.
    pub half_width_um: Option<f32>,
    /// Of the last tick, and least and largest voltage of the last second, V.
    pub voltage_v: Option<[f32; 3]>,
    /// What the sensor showed at the last tick, µm.
    pub sensor_um: Option<f32>,
    /// Estimate less sensor of the last tick, µm.
    pub error_um: Option<f32>,
    /// Samples of the last second.
    pub rate: f64,
    /// Ticks from one to the next; 0 where there are none.
    pub every: u8,
    /// Samples lost since the start, over all links.
    pub lost: u64,
    /// What is so, and what to do about it; nothing where all is well.
    pub words: Vec<Words>,
    /// What the device does.
    pub mode: String,
    /// When it was zeroed, and to what.
    pub bias: String,
    /// The recording that is under way.
    pub recording: Option<Recording>,
    /// What became of the one before.
    pub recorded: Option<String>,
}

/// What is so, and what to do about it.
#[derive(Serialize)]
pub struct Words {
    /// What the status bit or fault means.
    pub what: &'static str,
    /// What the user can do about it.
    pub remedy: &'static str,
    /// Whether it is a fault of the device, or of the estimate.
    pub fault: bool,
}

/// A recording under way.
#[derive(Serialize)]
pub struct Recording {
    /// Where it will be.
    pub file: String,
    /// How long it is.
    pub seconds: f64,
}
