//! What the user says about log files that they do not say themselves.

use anyhow::{Result, bail};
use clap::Args;
use recordings::log::{Columns, Log, ReadOptions, Sensitivity, read_remarked, twins};
use std::path::{Path, PathBuf};

/// What the user says about log files.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Log files")]
pub struct LogOptions {
    /// Which column holds what, where the file does not say so: time=1,voltage=2:mV,displacement=5:um (numbers or names in
    /// the file; a sensor's volts as displacement=5:2.5um/V). What is left out is taken from the file.
    #[arg(long)]
    pub columns: Option<Columns>,
    /// How far a volt of the displacement sensor is, where its output was recorded: 2.5um/V (also nm/mV, V/um).
    #[arg(long, value_name = "SCALE", allow_hyphen_values = true)]
    pub sensor: Option<Sensitivity>,
    /// Sample rate, Hz, where the file does not say when its rows were recorded.
    #[arg(long, value_name = "HZ")]
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

    pub fn read(&self, path: &Path) -> Result<Log> {
        self.read_by(path, &self.options())
    }

    fn read_by(&self, path: &Path, options: &ReadOptions) -> Result<Log> {
        let (log, remarks) = read_remarked(path, options)?;
        remarks.iter().for_each(|of| eprintln!("piezo: careful: {}: {}", path.display(), remedy::remark(of)));
        Ok(log)
    }

    /// Reads what is wanted: time and displacement, without a voltage.
    pub fn read_trajectory(&self, path: &Path) -> Result<Log> {
        self.read_by(path, &ReadOptions { voltage_required: false, ..self.options() })
    }

    /// Reads every log; refuses none and the same file twice.
    pub fn read_all(&self, paths: &[PathBuf]) -> Result<Vec<Log>> {
        let logs: Vec<Log> = paths.iter().map(|path| self.read(path)).collect::<Result<_>>()?;
        if let Some([log, twin]) = twins(&logs) {
            bail!("{}: holds the same bytes as {}: name each log once", log.path.display(), twin.path.display());
        }
        Ok(logs)
    }
}
