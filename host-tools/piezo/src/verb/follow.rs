//! `piezo follow`: a wanted trajectory to a device whose DAC drives the amplifier.

use super::device::note_damage;
use super::print::{out, progress};
use crate::option::link::{PortOption, careful};
use crate::option::{LogOptions, Overwrite, not_negative};
use ::feedforward::Trajectory;
use anyhow::{Context, Result, bail};
use bench::followed::{Following, Met, late, told};
use bench::{Foreseen, Reached, beyond_training, caveats, require_model, rest};
use clap::Args;
use device_link::busy::{Busy, idle};
use device_link::interrupt::Interrupt;
use device_link::play::{Play, PlayError, Played, play};
use device_link::{table, words};
use estimator_core::Status;
use protocol::Mode;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `piezo follow`.
#[derive(Args, Debug)]
pub struct Follow {
    /// Where the displacement is wanted: a log with time and displacement (time_s,displacement_um), relative to the
    /// model's zero; straight between its samples.
    pub trajectory: PathBuf,
    /// The voltage read by the ADC, the estimate and what was wanted, both relative to the model's zero whatever `piezo
    /// zero` has told, and the voltage that the DAC stood for, as a log.
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Stay at the last displacement instead of going back to rest. The next `follow` goes back first, at the drive's
    /// slew rate, and then by its plan.
    #[arg(long)]
    pub stay: bool,
    /// Plan it by the device's table, say what would come of it, and drive nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Drive it although a limit keeps the device's model off by up to this, µm, and exit with 1 where the estimate is
    /// more off. Without it, nothing is driven where a limit is in the way.
    #[arg(long, value_name = "µm", value_parser = not_negative, allow_negative_numbers = true)]
    pub max_error: Option<f64>,
    /// Print what was done as JSON.
    #[arg(long)]
    pub json: bool,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// Reading of the trajectory.
    #[command(flatten)]
    pub log: LogOptions,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb; `false` where a fault ended it, the link fell behind, or the trajectory was not met.
pub fn run(arguments: &Follow) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let wanted = arguments.log.read_trajectory(&arguments.trajectory)?;
    // A log that cannot be written is no reason to have driven an actuator.
    let out_file = arguments.out.as_deref().filter(|_| !arguments.dry_run);
    let log = |path| arguments.overwrite.growing(path, &[&arguments.trajectory]);
    let mut file = out_file.map(log).transpose()?;
    let (mut client, _) = arguments.port.connect()?;
    let table = table::running(&mut client)?;
    require_model(&table)?;
    let foreseen = Foreseen::of(&table, &Trajectory::of(&wanted, table.sample_period()), arguments.max_error)?;
    if arguments.dry_run {
        out(&if arguments.json { serde_json::to_string_pretty(&foreseen)? } else { foreseen.to_string() });
        if let (false, Some(drive)) = (arguments.json, table.drive) {
            let beyond = beyond_training(&table, &foreseen.plan);
            caveats(&table, &drive.limits).iter().chain(&beyond).for_each(|line| out(line));
        }
        return Ok(true);
    }
    let trajectory = Trajectory(foreseen.plan.wanted.clone());
    let references: Vec<f32> = trajectory.0.iter().map(|&wanted| wanted as f32).collect();
    let ticks = references.len() + late(&table).ceil() as usize;
    let what = Play { mode: Mode::Follow, goes_on: None, references: &references, hold: arguments.stay, ticks };
    if let Err(busy @ Busy::Drives(Mode::Waveform | Mode::Linearise)) = idle(&mut client) {
        careful(&busy);
    }
    // The plan begins at rest, where the voltage need not be: it may just be on the way there.
    if let Some(drive) = table.drive {
        rest(&mut client, table.adc, drive.limits)?;
    }
    let bar = progress(ticks as u64);
    // A mode that is set while a fault lasts takes the bias away, and so does a fault later: it is asked
    // for between them.
    client.set_mode(Mode::Follow)?;
    let mut following = Following::new(&table, &trajectory, client.health()?.bias_um);
    let mut unwritten = None;
    let followed = play(&mut client, &what, &interrupt, &mut |of| {
        bar.set_position(of.tick as u64 + 1);
        unwritten = following.take(of, file.as_mut()).err();
        unwritten.is_none()
    });
    bar.finish_and_clear();
    // Whatever happened, it goes to rest, but where it is to stay.
    let rested = match (&followed, arguments.stay) {
        (Ok(followed), true) if followed.stopped.is_empty() && !followed.enough => client.stream(false),
        _ => client.set_mode(Mode::Estimate),
    };
    note_damage(&client);
    if let (Some(file), Some(path)) = (file, &arguments.out) {
        if let Some(error) = unwritten {
            let unrested = rested
                .err()
                .map_or(String::new(), |error| format!("; and the device was not brought to rest: {error}"));
            bail!("{}{unrested}", remedy::cut_short(path, file, &error));
        }
        // A device that no longer answers must not cost what it has already given.
        if !following.rows.is_empty() {
            arguments.overwrite.grown(path, file)?;
        }
    }
    let followed = match (followed, &arguments.out) {
        (Err(why @ PlayError::Interrupted { .. }), written) => {
            rested.with_context(|| format!("{why}, and the device was not brought to rest"))?;
            let written = written.as_deref().filter(|_| !following.rows.is_empty());
            if arguments.json {
                out(&serde_json::to_string_pretty(&json!({ "passed": false, "complete": false, "out": written }))?);
            }
            eprintln!("piezo: {}", remedy::follow_interrupted(&why, written));
            return Ok(false);
        }
        (Err(error), Some(path)) if !following.rows.is_empty() => {
            let before = format!("{} holds the {} samples before", path.display(), following.rows.len());
            return Err(anyhow::Error::from(error).context(before));
        }
        (followed, _) => followed?,
    };
    rested?;
    tell(arguments, &following, &followed, Met::of(&table, &following.rows, &foreseen), &foreseen)
}

fn tell(
    arguments: &Follow,
    following: &Following<'_>,
    followed: &Played,
    met: Option<Met>,
    foreseen: &Foreseen,
) -> Result<bool> {
    let Reached { status, limited, ticks } = foreseen.reached(&following.samples);
    let written = arguments.out.as_ref().filter(|_| !following.rows.is_empty());
    let beyond = met.zip(arguments.max_error).filter(|(met, most)| met.max_um > *most);
    let good = followed.stopped.is_empty() && followed.starved == 0 && met.is_some() && beyond.is_none();
    if arguments.json {
        let summary = json!({
            "passed": good,
            "complete": true,
            "out": written,
            "ticks": followed.ticks,
            "samples": following.samples.len(),
            "starved": followed.starved,
            "stopped": followed.stopped.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "status": status.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "approach_ticks": foreseen.begins,
            "limited_ticks": limited,
            "met_after_s": met.map(|met| met.after_s),
            "estimate_off_mae_um": met.map(|met| met.mae_um),
            "estimate_off_max_um": met.map(|met| met.max_um),
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(good);
    }
    if met.is_some() || followed.stopped.is_empty() {
        out(&told(foreseen, followed.ticks, met));
    }
    if let Some(path) = written {
        out(&path.display().to_string());
    }
    let often = format!(" (on {limited} of {ticks} ticks)");
    for (bits, often) in [(status - Status::OUT_OF_REACH, ""), (status & Status::OUT_OF_REACH, &often)] {
        remedy::status(bits).for_each(|meaning| out(&format!("- {}{often}\n  → {}", meaning.what, meaning.remedy)));
    }
    if let Some((_, most)) = beyond {
        out(&format!("FAILED: more than {most} µm off"));
    }
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
