//! `piezo follow`: a wanted trajectory to a device whose DAC drives the amplifier.
//!
//! The reference of tick k moves the DAC at tick k + 1 and the displacement a tick after that, later by the model's delay;
//! the log sets what was wanted beside what was estimated at the same instant.

use super::device::note_damage;
use super::feedforward::caveats;
use super::print::{out, progress};
use crate::option::LogOptions;
use crate::option::link::PortOption;
use crate::output;
use crate::remedy;
use anyhow::{Context, Result, ensure};
use clap::Args;
use device_link::follow::{Followed, follow};
use device_link::interrupt::Interrupt;
use device_link::{table, words};
use estimator_core::{AdcCode, Admitted, DacCode, Status};
use identification::feedforward::{Trajectory, near, plan};
use protocol::{Mode, Refusal};
use serde_json::json;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

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
}

/// Runs the verb; `false` where a fault ended it or the link fell behind.
pub fn run(arguments: &Follow) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let log = arguments.log.read_trajectory(&arguments.trajectory)?;
    // A log that cannot be written is no reason to have driven an actuator.
    let file = arguments.out.as_deref().map(|path| beside(path, &arguments.trajectory)).transpose()?;
    let (mut client, _) = arguments.port.connect()?;
    let table = table::running(&mut client)?;
    let trajectory = Trajectory::of(&log, table.sample_period());
    possible(&table, &trajectory, arguments.dry_run)?;
    if arguments.dry_run {
        return Ok(true);
    }
    let references: Vec<f32> = trajectory.0.iter().map(|&wanted| wanted as f32).collect();
    let late = 2.0 + f64::from(table.parameters.delay_ticks());
    let ticks = references.len() + late.ceil() as usize;
    let bar = progress(ticks as u64);
    let followed = follow(&mut client, &references, arguments.stay, ticks, &interrupt, &mut |ticks| {
        bar.set_position(ticks as u64)
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
    let rows = rows(&table, &trajectory, &followed, late);
    if let (Some(mut file), Some(path)) = (file, &arguments.out) {
        let cannot = || format!("{}: cannot be written", path.display());
        file.write_all(csv(&rows).as_bytes()).with_context(cannot)?;
        file.persist(path).map_err(|error| error.error).with_context(cannot)?;
    }
    tell(arguments, &table, &followed, &rows)
}

/// The file that becomes the log.
fn beside(path: &Path, trajectory: &Path) -> Result<NamedTempFile> {
    ensure!(!path.is_dir(), "{}: is a folder, --out names a file", path.display());
    output::not_over(path, &[trajectory])?;
    output::beside(path).with_context(|| format!("{}: cannot be written", path.display()))
}

/// Refuses a trajectory that the device's own model never meets; says what comes of one that it does, where that is wanted.
fn possible(table: &Admitted, trajectory: &Trajectory, told: bool) -> Result<()> {
    let drive = table.drive.with_context(|| remedy::refusal(&Refusal::NoDrive))?;
    let plan = plan(table, &drive.limits, trajectory)?;
    let caveats = caveats(table, &drive.limits);
    ensure!(
        plan.met(near(table)).is_some(),
        "the device's model never meets this trajectory, and nothing was driven: is it relative to the model's zero? {}",
        caveats[0]
    );
    if told {
        let (ticks, beyond) = (plan.voltage.len(), plan.out_of_reach);
        out(&format!(
            "{ticks} ticks, on {beyond} of them the voltage or its slew rate would stand at a limit; nothing was driven"
        ));
        caveats.iter().for_each(|line| out(line));
    }
    Ok(())
}

/// An instant.
struct Row {
    seconds: f64,
    voltage: f64,
    estimated: f64,
    wanted: f64,
    /// What the DAC stands for, V at the amplifier.
    driven: f64,
}

fn rows(table: &Admitted, trajectory: &Trajectory, followed: &Followed, late: f64) -> Vec<Row> {
    let tick_s: f64 = table.sample_period();
    let pairs = followed.samples.windows(2).enumerate();
    pairs
        .map(|(before, pair)| Row {
            seconds: (before + 1) as f64 * tick_s,
            voltage: table.adc.voltage(AdcCode(pair[1].code)),
            // Each estimate is of the tick after its sample's.
            estimated: pair[0].displacement.into(),
            wanted: trajectory.at((before + 1) as f64 - late),
            // The code of a sample is put out a tick later.
            driven: table.drive.map_or(0.0, |drive| drive.voltage(DacCode(pair[0].dac))),
        })
        .collect()
}

fn csv(rows: &[Row]) -> String {
    let mut text = "time_s,voltage_V,estimated_displacement_um,wanted_um,driven_V\n".to_owned();
    for Row { seconds, voltage, estimated, wanted, driven } in rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{seconds:.6},{voltage:.6},{estimated:.6},{wanted:.6},{driven:.6}");
    }
    text
}

fn tell(arguments: &Follow, table: &Admitted, followed: &Followed, rows: &[Row]) -> Result<bool> {
    let status = followed.samples.iter().fold(Status::empty(), |all, sample| all | sample.status);
    let near = 1e-2 * f64::from(table.displacement_limits_um.span());
    let error = |row: &Row| (row.estimated - row.wanted).abs();
    let met = rows.iter().position(|row| error(row) < near);
    let met_rows = met.map_or(&[][..], |from| &rows[from..]);
    let mean = met_rows.iter().map(error).sum::<f64>() / met_rows.len().max(1) as f64;
    let most = met_rows.iter().map(error).fold(0.0, f64::max);
    let good = followed.stopped.is_empty() && followed.starved == 0;
    if arguments.json {
        let summary = json!({
            "out": arguments.out,
            "ticks": followed.samples.len(),
            "starved": followed.starved,
            "stopped": followed.stopped.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "status": status.iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
            "met_after_s": met.and_then(|row| rows.get(row)).map(|row| row.seconds),
            "estimate_off_mae_um": met.map(|_| mean),
            "estimate_off_max_um": met.map(|_| most),
        });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(good);
    }
    match met.and_then(|row| rows.get(row)) {
        Some(first) => out(&format!(
            "{} ticks; the estimate was {mean:.4} µm off what was wanted on average, {most:.4} µm at most, from {:.3} s on",
            followed.samples.len(),
            first.seconds
        )),
        None => out(&format!(
            "{} ticks; the estimate never came near what was wanted: does the DAC drive this amplifier, and the ADC read it?",
            followed.samples.len()
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
            followed.samples.len(),
            words::list(words::faults(followed.stopped).map(|(_, what)| what))
        ));
    }
    Ok(good)
}

#[cfg(test)]
mod tests {
    use super::*;
    use device_link::pages;
    use device_link::table::to_record;
    use emulator::{Emulator, Plant, TABLE, amplifier};
    use estimator_core::{DriveCalibration, DriveLimits, Range, Table};
    use parameter_store::RamFlash;

    const LIMITS: DriveLimits = DriveLimits { range_v: Range { min: 0.0, max: 3.6 }, rest_v: 0.5, slew_v_per_s: 40.0 };
    /// An amplifier of 0 … 4 V on the DAC's scale.
    const DRIVE: DriveCalibration =
        DriveCalibration { gain_codes_per_v: 4095.0 / 4.0, offset_code: 0.0, limits: LIMITS };

    /// Follows a swing about a displacement (µm); the device's queue of references lasts for half a second.
    fn followed_about(about: f64, dry_run: bool, plant: impl Plant) -> (Result<bool>, Option<String>) {
        let table = Table { drive: Some(DRIVE), ..TABLE }.admit().unwrap();
        let flash = RamFlash::new(pages::with(&to_record(&table), 4096).unwrap());
        let device = Emulator::new().flash(flash).plant(plant).speed(0.25).start().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let trajectory = folder.path().join("wanted.csv");
        let wave = (0..500).map(|k| {
            let t = f64::from(k) * 1e-3;
            format!("{t:.3},{}\n", about + 5.0 * (t * 20.0).sin())
        });
        std::fs::write(&trajectory, "time_s,displacement_um\n".to_owned() + &wave.collect::<String>()).unwrap();
        let log = folder.path().join("followed.csv");
        let arguments = Follow {
            trajectory,
            out: Some(log.clone()),
            stay: false,
            dry_run,
            json: true,
            port: PortOption { port: device.address().into() },
            log: LogOptions { columns: None, sensor: None, fs: None },
        };
        (run(&arguments), std::fs::read_to_string(log).ok())
    }

    fn sound() -> impl Plant {
        amplifier(DRIVE, TABLE.adc)
    }

    #[test]
    fn a_dry_run_drives_nothing_and_the_impossible_is_not_tried() {
        assert!(matches!(followed_about(20.0, true, sound()), (Ok(true), None)));
        let (refused, log) = followed_about(200.0, false, sound());
        let complaint = format!("{:#}", refused.unwrap_err());
        assert!(
            complaint.contains("nothing was driven") && complaint.contains("hold about") && log.is_none(),
            "{complaint}"
        );
    }

    #[test]
    fn what_was_wanted_stands_beside_what_was_estimated() {
        let (done, log) = followed_about(20.0, false, sound());
        assert!(done.unwrap());
        let log = log.unwrap();
        let row = |line: &str| line.split(',').map(|x| x.parse().unwrap()).collect::<Vec<f64>>();
        let rows: Vec<Vec<f64>> = log.lines().skip(1).map(row).collect();
        assert_eq!(rows.len(), 1000);
        assert!(rows.iter().skip(400).all(|row| (row[2] - row[3]).abs() < 0.3));
    }

    #[test]
    fn a_fault_on_the_way_is_a_failure_and_the_log_is_kept() {
        // Saturated from the 80th tick on at which the amplifier has moved, which is a fault after twenty.
        let (mut amplifier, mut moved) = (sound(), 0);
        let rest = DRIVE.code(LIMITS.rest_v, TABLE.dac.full_scale);
        let breaks = move |dac| {
            moved += u32::from(moved > 0 || dac != rest);
            let conversion = amplifier.sample(dac);
            if moved < 80 { conversion } else { AdcCode(TABLE.adc.full_scale).into() }
        };
        let (done, log) = followed_about(20.0, false, breaks);
        assert!(!done.unwrap());
        assert_eq!(log.unwrap().lines().count(), 100);
    }
}
