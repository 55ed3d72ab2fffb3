//! A trajectory that a device has followed: what was wanted beside what it estimated at the same instant.
//!
//! The reference of tick k moves the DAC at tick k + 1 and the displacement a tick after that, later by the model's delay.

use device_link::streamed::{Streamed, of_tick_before};
use estimator_core::{AdcCode, Admitted, DacCode};
use feedforward::Trajectory;
use std::fmt::Write as _;

/// An estimate this near to what was wanted has met it, as a fraction of the table's span of displacements.
const MET: f64 = 1e-2;

/// An instant at which something was wanted, and what was estimated then.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Row {
    /// Since the first reference, s.
    pub seconds: f64,
    /// Read by the ADC, V.
    pub voltage: f64,
    /// µm.
    pub estimated: f64,
    /// µm.
    pub wanted: f64,
    /// What the DAC stood for, V at the amplifier.
    pub driven: f64,
}

/// From where a trajectory was met on.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Met {
    /// When, s since the first reference.
    pub after_s: f64,
    /// Mean of |estimate − wanted| from there on, µm.
    pub mae_um: f64,
    /// The largest, µm.
    pub max_um: f64,
}

/// Ticks from a reference to the displacement that it moves.
pub fn late(table: &Admitted) -> f64 {
    2.0 + f64::from(table.parameters.delay_ticks())
}

/// The instants of samples, ticks from the one that took the first reference on.
pub fn rows(table: &Admitted, trajectory: &Trajectory, samples: &[Streamed]) -> Vec<Row> {
    let (tick_s, late): (f64, f64) = (table.sample_period(), late(table));
    let row = |before: &Streamed, now: &Streamed| {
        // The code of a sample is put out a tick later.
        let driven =
            table.drive.map_or([0.0; 2], |drive| [before, now].map(|of| drive.voltage::<f64>(DacCode(of.sample.dac))));
        Row {
            seconds: now.tick as f64 * tick_s,
            voltage: table.adc.voltage(AdcCode(now.sample.code)),
            estimated: now.estimate(&before.sample).into(),
            wanted: trajectory.at(now.tick as f64 - late),
            driven: of_tick_before(driven[0], driven[1], now.every),
        }
    };
    samples.windows(2).map(|pair| row(&pair[0], &pair[1])).collect()
}

/// The instants as a log.
pub fn csv(rows: &[Row]) -> String {
    let mut text = "time_s,voltage_V,estimated_displacement_um,wanted_um,driven_V\n".to_owned();
    for Row { seconds, voltage, estimated, wanted, driven } in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{seconds:.6},{voltage:.6},{estimated:.6},{wanted:.6},{driven:.6}");
    }
    text
}

impl Met {
    /// Where the estimate met what was wanted; `None` where it never did.
    pub fn of(table: &Admitted, rows: &[Row]) -> Option<Self> {
        let near = MET * f64::from(table.displacement_limits_um.span());
        let error = |row: &Row| (row.estimated - row.wanted).abs();
        let from = rows.iter().position(|row| error(row) < near)?;
        let met = &rows[from..];
        Some(Self {
            after_s: met[0].seconds,
            mae_um: met.iter().map(error).sum::<f64>() / met.len() as f64,
            max_um: met.iter().map(error).fold(0.0, f64::max),
        })
    }
}
