//! What the user says about log files that they do not say themselves.

use anyhow::{Result, bail};
use clap::Args;
use recordings::log::{Columns, Log, ReadOptions, read};
use std::path::{Path, PathBuf};

/// What the user says about log files.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Log files")]
pub struct LogOptions {
    /// Which column holds what, where no header says so: time=1,voltage=2:mV,displacement=5:um (numbers or header names).
    #[arg(long)]
    pub columns: Option<Columns>,
    /// Sample rate, Hz, where no column holds the time.
    #[arg(long, value_name = "HZ")]
    pub fs: Option<f64>,
}

impl LogOptions {
    pub fn read(&self, path: &Path) -> Result<Log> {
        let options = ReadOptions { columns: self.columns.clone(), sample_rate: self.fs, ..ReadOptions::default() };
        Ok(read(path, &options)?)
    }

    /// Reads what is wanted: time and displacement, without a voltage.
    pub fn read_trajectory(&self, path: &Path) -> Result<Log> {
        let options = ReadOptions {
            columns: self.columns.clone(),
            sample_rate: self.fs,
            voltage_required: false,
            ..ReadOptions::default()
        };
        Ok(read(path, &options)?)
    }

    /// Reads every log; refuses none and the same file twice.
    pub fn read_all(&self, paths: &[PathBuf]) -> Result<Vec<Log>> {
        let logs: Vec<Log> = paths.iter().map(|path| self.read(path)).collect::<Result<_>>()?;
        for (index, log) in logs.iter().enumerate() {
            if let Some(twin) = logs[..index].iter().find(|other| other.sha256 == log.sha256) {
                bail!("{}: holds the same bytes as {}: name each log once", log.path.display(), twin.path.display());
            }
        }
        Ok(logs)
    }
}
