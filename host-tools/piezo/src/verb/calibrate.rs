//! `piezo calibrate`: two readings of a multimeter, or of a sensor, beside the board's codes → what they stand
//! for, in board.toml.

use super::device::note_damage;
use super::print::out;
use crate::option::link::{Interrupting, PortOption};
use crate::option::{BoardOption, choice, finite, span};
use ::calibration::span::Span;
use anyhow::{Context, Result, anyhow, bail, ensure};
use bench::calibrate::{Calibrated, Calibrating, Channel, Point, Stand, measured, writable};
use bench::{BenchError, BoardFacts, CalibrationError, Driven, Edited, Measured};
use clap::Args;
use device_link::interrupt::Interrupt;
use protocol::Identity;
use recordings::log::Sensitivity;
use result_files::{FileError, Replacement};
use serde_json::json;
use std::io::stdin;
use std::sync::mpsc::{Receiver, TryRecvError, channel};

/// Arguments of `piezo calibrate`.
#[derive(Args, Debug)]
pub struct Calibrate {
    /// What is calibrated: the monitor's channel, by a multimeter at the amplifier's output; or the sensor's, by
    /// its own display.
    #[arg(long, value_parser = choice(CHANNELS), default_value = "monitor")]
    pub channel: Channel,
    /// Have the board drive the amplifier to these two voltages, V, lowest first, and stay there for the readings; the
    /// DAC is then calibrated, too. That needs a calibration that is right to some 5 % already. Without it, bring what
    /// is measured there by hand.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V")]
    pub drive_to: Option<Span>,
    /// Reading at the first point, V (of the sensor: µm), where it is known before; else it is asked for.
    #[arg(long, value_parser = finite, allow_negative_numbers = true, value_name = "READING", requires = "high")]
    pub low: Option<f64>,
    /// Reading at the second point.
    #[arg(long, value_parser = finite, allow_negative_numbers = true, value_name = "READING", requires = "low")]
    pub high: Option<f64>,
    /// How far a volt of the sensor is, where its readings are a multimeter's, in V: 2.5um/V (also nm/mV, V/um).
    #[arg(long, value_name = "SCALE", allow_hyphen_values = true)]
    pub sensor: Option<Sensitivity>,
    /// Measure, and say what would be written, but write nothing. With --drive-to the board drives the amplifier
    /// all the same.
    #[arg(long)]
    pub dry_run: bool,
    /// Print what was measured as JSON.
    #[arg(long)]
    pub json: bool,
    /// The file that it is written to.
    #[command(flatten)]
    pub board: BoardOption,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What becomes of what the device drives, with --drive-to.
    #[command(flatten)]
    pub interrupting: Interrupting,
}

const CHANNELS: [(Channel, &str, &str); 2] = [
    (Channel::Monitor, "monitor", "The amplifier's monitor, in V at the amplifier's output"),
    (Channel::Sensor, "sensor", "The displacement sensor, in µm"),
];

/// Runs the verb.
pub fn run(arguments: &Calibrate) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let Calibrate { channel, drive_to, sensor, ref board, .. } = *arguments;
    ensure!(sensor.is_none() || channel == Channel::Sensor, "--sensor is of --channel sensor alone: leave it out");
    if let Some(Span { zero, full }) = drive_to {
        ensure!(zero < full, "--drive-to {zero}:{full}: the lower voltage stands first, and the two differ");
    }
    // A file that cannot be used, or written, is said before anything moves.
    let path = &board.board;
    let before = Edited::of(path, &Measured::default())?.before;
    writable(channel, drive_to.is_some(), &before).map_err(BenchError::from)?;
    if !arguments.dry_run {
        Replacement::of(path).map(drop).map_err(|source| FileError::Write { path: path.clone(), source })?;
    }
    let (mut client, identity) = arguments.port.connect()?;
    // What is measured here must not stand beside what was measured on another board, whatever the options say.
    before.of_board(&identity).with_context(|| path.display().to_string())?;
    let stand = match drive_to {
        Some(to) => {
            arguments.interrupting.consent(&mut client, false)?;
            let volts = [to.zero as f32, to.full as f32];
            Stand::Driven(Box::new(Driven::new(&mut client, volts, &before)?), volts)
        }
        None => Stand::ByHand,
    };
    let mut readings = Readings { arguments, lines: None, asked: 0 };
    let calibrating = Calibrating { client: &mut client, identity: &identity, channel, stand, interrupt: &interrupt };
    let Calibrated { points, home } = calibrating.points(&mut |number, doubt| readings.next(number, doubt));
    note_damage(&client);
    let points = points.map_err(|Ended(error)| beside(error, &home))?;
    let edited = write(arguments, &identity, &before, &points);
    edited.map_err(|error| beside(error, &home))?;
    // What was measured holds, wherever the amplifier is now.
    home?;
    Ok(true)
}

/// An error, and that the amplifier did not come to rest, either.
fn beside(error: anyhow::Error, home: &Result<(), BenchError>) -> anyhow::Error {
    match home {
        Err(home) if home.to_string() != error.to_string() => {
            anyhow!("{}; and then: {}", remedy::sentence(error.as_ref()), remedy::sentence(home))
        }
        _ => error,
    }
}

/// Says what was measured, and then writes it.
fn write(arguments: &Calibrate, identity: &Identity, before: &BoardFacts, points: &[Point; 2]) -> Result<()> {
    let scale = arguments.sensor.map_or(1.0, |sensor| sensor.um_per_v);
    let measured = measured(arguments.channel, scale, identity, before, points).map_err(BenchError::from)?;
    if !arguments.json {
        tell_points(identity, points, &measured)?;
    }
    let edited =
        Edited::of(&arguments.board.board, &measured).with_context(|| format!("by what was measured, {measured}"))?;
    if !arguments.dry_run {
        edited.write()?;
    }
    tell(arguments, points, &edited, &edited.unmeasured(&measured))
}

/// Why there is no calibration.
struct Ended(anyhow::Error);

impl From<BenchError> for Ended {
    fn from(error: BenchError) -> Self {
        Self(error.into())
    }
}

/// The instrument's readings: as they were stated, or a line of standard input each.
struct Readings<'a> {
    arguments: &'a Calibrate,
    lines: Option<Receiver<std::io::Result<String>>>,
    /// How many of them have been asked for.
    asked: usize,
}

impl Readings<'_> {
    /// The reading at a point, if it is there by now.
    fn next(&mut self, number: usize, doubt: Option<CalibrationError>) -> Result<Option<f64>, Ended> {
        self.look(number, doubt).map_err(Ended)
    }

    fn look(&mut self, number: usize, doubt: Option<CalibrationError>) -> Result<Option<f64>> {
        let stated = [self.arguments.low, self.arguments.high][number];
        if let (Some(doubt), Some(_)) = (doubt, stated)
            // Once it stands still, the same reading is right.
            && !matches!(doubt, CalibrationError::Drifts { .. })
        {
            return Err(BenchError::from(doubt).into());
        }
        if let (Some(_), Some(_)) = (stated, self.arguments.drive_to) {
            return Ok(stated);
        }
        if let Some(doubt) = doubt {
            let again = if stated.is_some() { "press Enter" } else { "read it" };
            eprintln!("{}; {again} once more:", remedy::sentence(&doubt));
        }
        if self.asked == number {
            self.asked += 1;
            eprintln!("{}", self.question(number, stated));
        }
        let line = match self.lines.get_or_insert_with(lines).try_recv() {
            Err(TryRecvError::Empty) => return Ok(None),
            Err(TryRecvError::Disconnected) => {
                bail!(
                    "standard input ended before both readings were there: type them, or state them with --low and --high"
                )
            }
            Ok(line) => line.context("standard input")?,
        };
        match (line.trim(), stated) {
            ("", Some(stated)) => Ok(Some(stated)),
            (text, None) => match finite(&text.replace(',', ".")) {
                Ok(reading) => Ok(Some(reading)),
                Err(why) => {
                    eprintln!("{text:?} is no reading: {why}; once more:");
                    Ok(None)
                }
            },
            (text, Some(_)) => Err(anyhow!("{text:?}: the reading was stated with the options: press Enter alone")),
        }
    }

    fn question(&self, number: usize, stated: Option<f64>) -> String {
        let &Calibrate { channel, drive_to, sensor, .. } = self.arguments;
        let instrument = match (channel, sensor) {
            (Channel::Monitor, _) => "the multimeter at the amplifier's output reads, in V",
            (Channel::Sensor, None) => "the sensor's display shows, in µm",
            (Channel::Sensor, Some(_)) => "the multimeter at the sensor's output reads, in V",
        };
        let (point, end) = [("first", "low"), ("second", "high")][number];
        let there = match (drive_to, channel) {
            (Some(to), _) => format!("The board holds the amplifier at {} V.", [to.zero, to.full][number]),
            (None, Channel::Monitor) => {
                format!("Bring the amplifier to the {point} voltage, at the {end} end of what you will use.")
            }
            (None, Channel::Sensor) => {
                format!("Bring the sensor to the {point} position, at the {end} end of its range.")
            }
        };
        match stated {
            Some(stated) => format!("{there} Press Enter when it is at {stated}."),
            None => format!("{there} Type what {instrument}, and Enter."),
        }
    }
}

/// Lines of standard input, read beside what else is going on.
fn lines() -> Receiver<std::io::Result<String>> {
    let (sender, receiver) = channel();
    // It ends with the input, or with the program.
    std::thread::spawn(move || stdin().lines().try_for_each(|line| sender.send(line)));
    receiver
}

fn tell_points(identity: &Identity, points: &[Point; 2], measured: &Measured) -> Result<()> {
    let (unit, span) = match measured.sensor_span {
        Some(span) => ("µm", Some(span)),
        None => ("V", measured.adc_span),
    };
    let a_code = span.map_or(f64::NAN, |(zero, full)| (full - zero).abs() / f64::from(identity.adc_full_scale));
    for Point { reading, channel, dac } in points {
        let dac = dac.map_or(String::new(), |code| format!(", the DAC at code {code:.1}"));
        out(&format!(
            "{reading}: code {:.1}, noise {:.1} codes ({:.4} {unit}) rms{dac}",
            channel.code,
            channel.noise,
            channel.noise * a_code
        ));
    }
    out(&format!("That makes {measured}."));
    Ok(())
}

fn tell(arguments: &Calibrate, points: &[Point; 2], edited: &Edited, unmeasured: &[&str]) -> Result<()> {
    let Edited { before, after, .. } = edited;
    if arguments.json {
        let points = points.map(|Point { reading, channel, dac }| {
            json!({ "reading": reading, "code": channel.code, "noise_codes": channel.noise, "drift_codes": channel.drift, "dac_code": dac })
        });
        out(&serde_json::to_string_pretty(&json!({
            "points": points, "before": before, "after": after, "written": !arguments.dry_run,
            "not_measured_on_this_board": unmeasured,
        }))?);
        return Ok(());
    }
    let path = arguments.board.board.display();
    let changes = edited.changes();
    match (changes.is_empty(), arguments.dry_run) {
        (true, _) => out(&format!("{path} says all of that already.")),
        (false, true) => out(&format!("{path} would say, and says still what it said (--dry-run):")),
        (false, false) => out(&format!("{path} says now:")),
    }
    changes.iter().for_each(|line| out(&format!("    {line}")));
    if !unmeasured.is_empty() {
        out(&format!(
            "{path} named no board, and nothing says that {} in it was measured on this one: measure that, too.",
            unmeasured.join(" and ")
        ));
    }
    if !arguments.dry_run && (before.adc_span, before.drive_span) != (after.adc_span, after.drive_span) {
        out("A table on the board has the calibration of before: install it anew with this file (piezo install).");
    }
    Ok(())
}
