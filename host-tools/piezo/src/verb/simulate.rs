//! `piezo simulate`: the synthetic rig's six logs.

use super::print::out;
use crate::option::{Overwrite, RigArgs};
use crate::output::{self, Replacement};
use anyhow::{Context, Result, ensure};
use clap::Args;
use recordings::log::{Displacement, csv_beside};
use recordings::rig::{EXCITATIONS, Recording, Rig};
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo simulate`.
#[derive(Args, Debug)]
pub struct Simulate {
    /// Folder for the logs.
    #[arg(long, default_value = "out/rig")]
    pub out: PathBuf,
    /// Print what was written as JSON.
    #[arg(long)]
    pub json: bool,
    /// What the rig is made of.
    #[command(flatten)]
    pub rig: RigArgs,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Simulate) -> Result<bool> {
    let rig = Rig::from(&arguments.rig);
    let positive = |name: &str, value: f64| {
        ensure!(value.is_finite() && value > 0.0, "--{name} must be a positive number, not {value}");
        Ok(())
    };
    positive("amplitude", rig.amplitude)?;
    positive("duration", rig.duration)?;
    positive("fs", rig.fs)?;
    positive("cutoff", rig.cutoff)?;
    ensure!(rig.asymmetry.is_finite(), "--asymmetry must be a number, not {}", rig.asymmetry);
    let rest = [
        ("noise-nm", rig.noise_nm),
        ("voltage-noise", rig.voltage_noise),
        ("hysteresis", rig.hysteresis),
        ("creep", rig.creep),
    ];
    for (name, value) in rest {
        ensure!(value.is_finite() && value >= 0.0, "--{name} must be 0 or a positive number, not {value}");
    }
    let samples = rig.duration * rig.fs;
    ensure!(
        (16.0..=1e8).contains(&samples),
        "{samples:.0} samples a log: choose --duration and --fs for 16 to 100 million"
    );
    let _held = output::to_folder(&arguments.out)?;
    let (mut logs, mut files) = (Vec::new(), Vec::new());
    for excitation in EXCITATIONS {
        let path = arguments.out.join(format!("{}.csv", excitation.name));
        arguments.overwrite.of(&path, "time_s,voltage_V,displacement_um\n")?;
        let Recording { voltage, displacement } = rig.record(excitation);
        let file = csv_beside(&path, 1.0 / rig.fs, &voltage, &displacement, Displacement::Measured);
        files.push(file.with_context(|| format!("{}: cannot be written", path.display()))?);
        logs.push((path, voltage.len()));
    }
    Replacement::commit_set(files)?;
    if arguments.json {
        let log = |(path, samples)| json!({ "path": path, "samples": samples, "sample_rate_hz": rig.fs });
        out(&serde_json::to_string_pretty(&logs.into_iter().map(log).collect::<Vec<_>>())?);
        return Ok(true);
    }
    logs.iter().for_each(|(path, samples)| out(&format!("{}  {samples} samples at {} Hz", path.display(), rig.fs)));
    Ok(true)
}
