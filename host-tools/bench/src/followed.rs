//! A trajectory that a device has followed: what was wanted beside what it estimated at the same instant.
//!
//! The reference of tick k moves the DAC at tick k + 1 and the displacement a tick after that, later by
//! the model's delay.

use crate::foreseen::Foreseen;
use device_link::streamed::{Streamed, of_tick_before};
use estimator_core::{AdcCode, Admitted, DacCode};
use feedforward::Trajectory;
use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};

/// An estimate this near to what was wanted has met it, as a fraction of the table's span of displacements.
const MET: f64 = 1e-2;

/// An instant at which something was wanted, and what was estimated then.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Row {
    /// Since the first reference, s.
    pub seconds: f64,
    /// Read by the ADC, V.
    pub voltage: f64,
    /// The board's estimate, µm.
    pub estimated: f64,
    /// What was asked for, µm.
    pub wanted: f64,
    /// What the DAC stood for, V at the amplifier.
    pub driven: f64,
}

/// How well a trajectory was met, the way there left aside.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Met {
    /// When it first was, s since the first reference.
    pub after_s: f64,
    /// Mean of |estimate − wanted| over all of it that counts, µm.
    pub mae_um: f64,
    /// The largest |estimate − wanted| of what counts, µm.
    pub max_um: f64,
}

/// How a trajectory was met by as many ticks, in words.
pub fn told(foreseen: &Foreseen, ticks: usize, met: Option<Met>) -> String {
    match met {
        Some(Met { after_s, mae_um, max_um }) => format!(
            "{ticks} ticks, the first {} of them from rest to where the trajectory begins; the estimate was {mae_um:.4} µm off the trajectory \
             on average,{} {max_um:.4} µm at most, and first met it after {after_s:.3} s",
            foreseen.begins,
            foreseen.aside()
        ),
        None => format!(
            "FAILED: {ticks} ticks, and the estimate never came near what was wanted: does the DAC drive this amplifier, and the ADC read it?"
        ),
    }
}

/// Ticks from a reference to the displacement that it moves.
pub fn late(table: &Admitted) -> f64 {
    2.0 + f64::from(table.parameters.delay_ticks())
}

/// Names of a log's columns.
const HEADING: &str = "time_s,voltage_V,estimated_displacement_um,wanted_um,driven_V";

/// What a device has done of a trajectory so far, of which a log can be written as it comes.
#[derive(Debug)]
pub struct Following<'t> {
    table: &'t Admitted,
    trajectory: &'t Trajectory,
    /// The device's: what is wanted is relative to the model's zero, and so are the estimates of the log.
    bias_um: f64,
    /// What it has sent.
    pub samples: Vec<Streamed>,
    /// The instants of those that have one before them.
    pub rows: Vec<Row>,
}

impl<'t> Following<'t> {
    /// Nothing yet, of a device whose estimate has this bias, µm.
    pub fn new(table: &'t Admitted, trajectory: &'t Trajectory, bias_um: f32) -> Self {
        Self { table, trajectory, bias_um: bias_um.into(), samples: Vec::new(), rows: Vec::new() }
    }

    /// Takes the next sample, and writes its row, where there is a log; the heading is above the first one.
    ///
    /// # Errors
    /// The log cannot be written.
    pub fn take(&mut self, now: &Streamed, log: Option<&mut impl Write>) -> io::Result<()> {
        let before = self.samples.last().copied();
        self.samples.push(*now);
        let Some(before) = before else { return Ok(()) };
        let row = self.row(&before, now);
        // A line is handed over at once: a program that is killed leaves whole ones.
        let line = if self.rows.is_empty() { format!("{HEADING}\n{row}\n") } else { format!("{row}\n") };
        self.rows.push(row);
        log.map_or(Ok(()), |log| log.write_all(line.as_bytes()))
    }

    fn row(&self, before: &Streamed, now: &Streamed) -> Row {
        let Self { table, trajectory, bias_um, .. } = self;
        // The code of a sample is put out a tick later.
        let driven =
            table.drive.map_or([0.0; 2], |drive| [before, now].map(|of| drive.voltage::<f64>(DacCode(of.sample.dac))));
        Row {
            seconds: now.tick as f64 * table.sample_period::<f64>(),
            voltage: table.adc.voltage(AdcCode(now.sample.code)),
            estimated: f64::from(now.estimate(&before.sample)) - bias_um,
            wanted: trajectory.at(now.tick as f64 - late(table)),
            driven: of_tick_before(driven[0], driven[1], now.every),
        }
    }
}

impl Display for Row {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { seconds, voltage, estimated, wanted, driven } = self;
        write!(f, "{seconds:.6},{voltage:.6},{estimated:.6},{wanted:.6},{driven:.6}")
    }
}

impl Met {
    /// How the estimate met what was foreseen; `None` where it never did.
    pub fn of(table: &Admitted, rows: &[Row], foreseen: &Foreseen) -> Option<Self> {
        let begin_s = (foreseen.counts() as f64 + late(table) - 0.5) * table.sample_period::<f64>();
        let met = &rows[rows.partition_point(|row| row.seconds < begin_s)..];
        let near = MET * f64::from(table.displacement_limits_um.span());
        let error = |row: &Row| (row.estimated - row.wanted).abs();
        Some(Self {
            after_s: met.iter().find(|row| error(row) < near)?.seconds,
            mae_um: met.iter().map(error).sum::<f64>() / met.len() as f64,
            max_um: met.iter().map(error).fold(0.0, f64::max),
        })
    }
}
