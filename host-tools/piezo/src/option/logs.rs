//! What the user says about log files that they do not say themselves.

use super::number::finite;
use anyhow::{Result, bail, ensure};
use clap::Args;
use recordings::log::{Columns, Log, LogError, Need, ReadOptions, Sensitivity, read_remarked, twins};
use std::path::{Path, PathBuf};

/// What the user says about log files.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Log files")]
pub struct LogOptions {
    /// Which column holds what, where the file does not say so: time=1,voltage=2:mV,displacement=5:um (numbers or names
    /// in the file; a sensor's volts as displacement=5:2.5um/V). What is left out is taken from the file.
    #[arg(long)]
    pub columns: Option<Columns>,
    /// How far a volt of the displacement sensor is, where its output was recorded: 2.5um/V (also nm/mV, V/um).
    #[arg(long, value_name = "SCALE", allow_hyphen_values = true)]
    pub sensor: Option<Sensitivity>,
    /// Sample rate, Hz, where the file does not say when its rows were recorded.
    #[arg(long, value_name = "HZ", value_parser = finite, allow_negative_numbers = true)]
    pub fs: Option<f64>,
}

impl LogOptions {
    /// What these options say to whoever reads a log.
    pub fn options(&self) -> ReadOptions {
        ReadOptions {
            columns: self.columns.clone(),
            sensor: self.sensor,
            sample_rate: self.fs,
            ..ReadOptions::default()
        }
    }

    fn read_by(&self, path: &Path, options: &ReadOptions) -> Result<Log> {
        let (log, remarks) = read_remarked(path, options)?;
        let said = remedy::remarked(&log, &remarks, options.voltage_required);
        said.iter().for_each(|of| eprintln!("piezo: careful: {}: {of}", path.display()));
        Ok(log)
    }

    /// Reads what is wanted: time and displacement, without a voltage.
    pub fn read_trajectory(&self, path: &Path) -> Result<Log> {
        let log = self.read_by(path, &ReadOptions { voltage_required: false, ..self.options() })?;
        let stated = self.columns.as_ref().is_some_and(Columns::state_displacement);
        ensure!(stated || !log.displacement_estimated, remedy::of_an_estimate(path));
        Ok(log)
    }

    /// Reads what is to be estimated: time and voltage, whatever else there is, where asked with holes for what
    /// is no number.
    pub fn read_voltage(&self, path: &Path, holes: bool) -> Result<Log> {
        self.read_by(path, &ReadOptions { displacement: Need::Ignored, holes, ..self.options() })
    }

    /// Reads every log, where asked with holes for what is no number; refuses none and the same file twice.
    pub fn read_all(&self, paths: &[PathBuf], holes: bool) -> Result<Vec<Log>> {
        let options = ReadOptions { holes, ..self.options() };
        let (mut logs, mut of_length, mut applied) = (Vec::new(), None, false);
        for path in paths {
            match self.read_by(path, &options) {
                Err(error) if error.downcast_ref().is_some_and(LogError::is_of_length) => {
                    logs.push(self.read_by(path, &options.clone().of_length())?);
                    of_length.get_or_insert(error);
                }
                read => {
                    logs.push(read?);
                    applied = true;
                }
            }
        }
        // A scale that none of them needs is a mistake; beside others those in µm are read as they are.
        if let Some(error) = of_length.filter(|_| !applied) {
            return Err(error);
        }
        if let Some([log, twin]) = twins(&logs) {
            bail!("{}: holds the same bytes as {}: name each log once", log.path.display(), twin.path.display());
        }
        Ok(logs)
    }
}
