//! `piezo follow`: a wanted trajectory to a device whose DAC drives the amplifier.

use super::device::note_damage;
use super::print::{out, progress};
use crate::option::link::PortOption;
use crate::option::{LogOptions, Overwrite};
use crate::output::{self, Replacement};
use ::feedforward::{Trajectory, near, plan};
use anyhow::{Context, Result, ensure};
use bench::followed::{Met, Row, csv, late, rows};
use bench::{beyond_training, caveats, held, require_model};
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::play::{Play, Played, play};
use device_link::streamed::Streamed;
use device_link::{table, words};
use estimator_core::{Admitted, Status};
use protocol::{Mode, Refusal};
use serde_json::json;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Arguments of `piezo follow`.
#[derive(Args, Debug)]
pub struct Follow {
    /// Where the displacement is wanted: a log with time and displacement (time_s,displacement_um), relative to the model's
    /// zero; straight between its samples.
    pub trajectory: PathBuf,
    /// The voltage read by the ADC, the estimate, what was wanted, and the voltage that the DAC stood for, as a log.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Stay at the last displacement instead of going back to rest.
    #[arg(long)]
    pub stay: bool,
    /// Plan it by the device's table, say what would come of it, and drive nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
    /// Reading of the trajectory.
    #[command(flatten)]
    pub log: LogOptions,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` where a fault ended it or the link fell behind.
pub fn run(arguments: &Follow) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let log = arguments.log.read_trajectory(&arguments.trajectory)?;
    // A log that cannot be written is no reason to have driven an actuator.
    let file = arguments.out.as_deref().map(|path| beside(path, arguments)).transpose()?;
    let (mut client, _) = arguments.port.connect()?;
    let table = table::running(&mut client)?;
    require_model(&table)?;
    let trajectory = Trajectory::of(&log, table.sample_period());
    possible(&table, &trajectory, arguments.dry_run)?;
    if arguments.dry_run {
        return Ok(true);
    }
    let references: Vec<f32> = trajectory.0.iter().map(|&wanted| wanted as f32).collect();
    let ticks = references.len() + late(&table).ceil() as usize;
    let bar = progress(ticks as u64);
    let what = Play { mode: Mode::Follow, goes_on: None, references: &references, hold: arguments.stay, ticks };
    let mut samples = Vec::with_capacity(ticks);
    let followed = play(&mut client, &what, &interrupt, &mut |of| {
        samples.push(*of);
        bar.set_position(of.tick as u64 + 1);
        true
    });
    bar.finish_and_clear();
    // Whatever happened, it goes to rest, but where it is to stay.
    let rested = match (&followed, arguments.stay) {
        (Ok(followed), true) if followed.stopped.is_empty() => client.stream(false),
        _ => client.set_mode(Mode::Estimate),
    };
    let followed = followed?;
    rested?;
    note_damage(&client);
    let rows = rows(&table, &trajectory, &samples);
    if let (Some(mut file), Some(path)) = (file, &arguments.out) {
        let cannot = || format!("{}: cannot be written", path.display());
        file.write_all(csv(&rows).as_bytes()).with_context(cannot)?;
        file.commit().with_context(cannot)?;
    }
    tell(arguments, &table, &samples, &followed, &rows)
}

/// The file that becomes the log.
fn beside(path: &Path, arguments: &Follow) -> Result<Replacement> {
    ensure!(!path.is_dir(), "{}: is a folder, --out names a file", path.display());
    output::not_over(path, &[&arguments.trajectory])?;
    arguments.overwrite.of(path, "time_s,voltage_V,estimated_displacement_um,")?;
    Replacement::of(path).with_context(|| format!("{}: cannot be written", path.display()))
}

/// Refuses a trajectory that the device's own model never meets; says what comes of one that it does, where that is wanted.
fn possible(table: &Admitted, trajectory: &Trajectory, told: bool) -> Result<()> {
    let drive = table.drive.with_context(|| remedy::refusal(&Refusal::NoDrive))?;
    let plan = plan(table, &drive.limits, trajectory)?;
    ensure!(
        plan.met(0, near(table)).is_some(),
        "the device's model never meets this trajectory, and nothing was driven: is it relative to the model's zero? {}",
        held(table, &drive.limits)
    );
    if told {
        let (ticks, beyond) = (plan.voltage.len(), plan.out_of_reach);
        out(&format!(
            "{ticks} ticks, on {beyond} of them the voltage or its slew rate would stand at a limit; nothing was driven"
        ));
        caveats(table, &drive.limits).iter().chain(&beyond_training(table, &plan)).for_each(|line| out(line));
    }
    Ok(())
}

fn tell(arguments: &Follow, table: &Admitted, samples: &[Streamed], followed: &Played, rows: &[Row]) -> Result<bool> {
    let status = samples.iter().fold(Status::empty(), |all, of| all | of.sample.status);
    let met = Met::of(table, rows);
    let good = followed.stopped.is_empty() && followed.starved == 0;
    if arguments.json {
        let summary = json!({
            "out": arguments.out,
            "ticks": followed.ticks,
            "samples": samples.len(),
            "starved": followed.starved,
            "stopped": followed.stopped.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "status": status.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "met_after_s": met.map(|met| met.after_s),
            "estimate_off_mae_um": met.map(|met| met.mae_um),
            "estimate_off_max_um": met.map(|met| met.max_um),
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(good);
    }
    match met {
        Some(Met { after_s, mae_um, max_um }) => out(&format!(
            "{} ticks; the estimate was {mae_um:.4} µm off what was wanted on average, {max_um:.4} µm at most, from {after_s:.3} s on",
            followed.ticks
        )),
        None => out(&format!(
            "{} ticks; the estimate never came near what was wanted: does the DAC drive this amplifier, and the ADC read it?",
            followed.ticks
        )),
    }
    if let Some(path) = &arguments.out {
        out(&path.display().to_string());
    }
    remedy::status(status).for_each(|meaning| out(&format!("- {}\n  → {}", meaning.what, meaning.remedy)));
    if followed.starved > 0 {
        out(&format!(
            "FAILED: the device waited for {} ticks in all for references and held the last one: what was wanted stands too early in \
             the log by as much. Is this machine too busy? (An emulated board may be faster than its host.)",
            followed.starved
        ));
    }
    if !followed.stopped.is_empty() {
        out(&format!(
            "FAILED: a fault sent the drive back to rest after {} ticks: {}",
            followed.ticks,
            words::list(words::faults(followed.stopped).map(|(_, what)| what))
        ));
    }
    Ok(good)
}
