//! `piezo flash`: a firmware image, a table, or both, by a debug probe.

use super::device::{self, Doubts};
use super::print::out;
use crate::option::link::Doubted;
use anyhow::{Context, Result, ensure};
use clap::Args;
use device_link::pages;
use device_link::probe::{self, Probe};
use device_link::table::to_record;
use estimator_core::table::Interface;
use serde_json::json;
use std::ffi::OsString;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Arguments of `piezo flash`.
#[derive(Args, Debug)]
#[group(id = "what", required = true, multiple = true, args = ["image", "table"])]
pub struct Flash {
    /// The firmware: the ELF image that `cargo fw` builds.
    #[arg(long, value_name = "ELF")]
    pub image: Option<PathBuf>,
    /// A table (table.toml, its folder, or table.bin) for the parameter pages; what they held is lost.
    #[arg(long)]
    pub table: Option<PathBuf>,
    /// The chip, as probe-rs names it.
    #[arg(long, default_value = "STM32G474RETx")]
    pub chip: String,
    /// Which debug probe, where there are several: VID:PID or VID:PID:SERIAL.
    #[arg(long)]
    pub probe: Option<String>,
    /// Address of the parameter pages. With --image its symbols say; else that of the NUCLEO-G474RE, 0x0807f000.
    #[arg(long, value_parser = address, conflicts_with = "image", value_name = "ADDRESS", allow_negative_numbers = true)]
    pub parameters_at: Option<u32>,
    /// What becomes of a table that has doubts.
    #[command(flatten)]
    pub doubts: Doubted,
    /// Check the files and print the commands, and write nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// Print the commands as JSON.
    #[arg(long)]
    pub json: bool,
}

/// The NUCLEO-G474RE as the firmware sets it up: a code of the ADC is a sixteenth of one of 12 bits, the DAC
/// has 12 bits.
const NUCLEO_G474RE: Interface = Interface { tick_us: 500, adc_full_scale: 65_520, dac_full_scale: 4095 };
/// Ticks of images that are built for other rates, µs.
const OTHER_TICKS_US: [u32; 3] = [1_000, 200, 100];
/// What the parameter pages are called where they are not written.
const PAGES: &str = "parameter-pages.bin";

fn address(text: &str) -> Result<u32, String> {
    let digits = text.strip_prefix("0x").or(text.strip_prefix("0X"));
    let parsed = digits.map_or_else(|| text.parse(), |digits| u32::from_str_radix(digits, 16));
    parsed.map_err(|_| "expected an address, as 0x0807f000".to_owned())
}

/// What goes into the parameter pages.
struct Content<'f> {
    bytes: Vec<u8>,
    /// The doubts about the table, in words.
    doubts: Vec<String>,
    /// What they leave to be answered.
    doubted: Doubts<'f>,
}

/// Runs the verb.
pub fn run(arguments: &Flash) -> Result<bool> {
    let place = place(arguments)?;
    let content = arguments.table.as_deref().map(|table| content(table, arguments, &place)).transpose()?;
    let folder = tempfile::tempdir().context("cannot create a temporary folder")?;
    let file = if arguments.dry_run { PathBuf::from(PAGES) } else { folder.path().join(PAGES) };
    let commands = commands(arguments, content.is_some().then_some(&file), place.start);
    if !arguments.dry_run {
        probe::installed()?;
        if let Some(content) = &content {
            content.doubted.ask(|| Ok(()))?;
            std::fs::write(&file, &content.bytes).with_context(|| format!("{}: cannot be written", file.display()))?;
        }
        commands.iter().try_for_each(|command| probe::run(command))?;
    }
    tell(arguments, &commands, &place, content)
}

/// Where the parameter pages are.
fn place(arguments: &Flash) -> Result<Range<u32>> {
    match (&arguments.image, arguments.parameters_at) {
        (Some(image), _) => Ok(pages::of_image(image)?),
        (None, Some(start)) => {
            let length = pages::NUCLEO_G474RE.len() as u32;
            let end = start.checked_add(length).context("--parameters-at: there is no memory behind this address")?;
            ensure!(
                start.is_multiple_of(length / 2),
                "--parameters-at 0x{start:08x}: is not the start of a page of flash"
            );
            Ok(start..end)
        }
        (None, None) => Ok(pages::NUCLEO_G474RE),
    }
}

/// The content of the parameter pages with a table in them.
fn content<'f>(path: &'f Path, arguments: &Flash, place: &Range<u32>) -> Result<Content<'f>> {
    let (table, doubts) = table_files::read_doubted(path)?;
    // By the probe nobody can ask the device how fast it ticks. One that ticks otherwise refuses the table,
    // and says so.
    let tick_us = OTHER_TICKS_US.into_iter().find(|us| *us == table.sample_period_us).unwrap_or(NUCLEO_G474RE.tick_us);
    device::fits(&Interface { tick_us, ..NUCLEO_G474RE }, &table, path)?;
    if tick_us != NUCLEO_G474RE.tick_us {
        let hz = 1_000_000 / tick_us;
        eprintln!("piezo: careful: {} is for an image that was built with TICK_HZ={hz}", path.display());
    }
    // By the probe nobody can ask the device what its DAC is wired to.
    let output = if table.drive.is_some() { "drives the amplifier" } else { "shows the displacement" };
    eprintln!("piezo: careful: with {} the DAC {output}: wire it so before the board starts", path.display());
    let doubted = device::doubted(path, &doubts, arguments.doubts.doubted, arguments.dry_run)?;
    let bytes = pages::with(&to_record(&table), place.len());
    let bytes = bytes.with_context(|| format!("{}: cannot be stored", path.display()))?;
    Ok(Content { bytes, doubts, doubted })
}

fn commands(arguments: &Flash, pages: Option<&PathBuf>, at: u32) -> Vec<Vec<OsString>> {
    let probe = Probe { chip: arguments.chip.clone(), selector: arguments.probe.clone() };
    let image = arguments.image.iter().map(|image| probe.image(image));
    let pages = pages.map(|file| probe.bytes(file, at));
    image.chain(pages).chain([probe.reset()]).collect()
}

fn tell(
    arguments: &Flash,
    commands: &[Vec<OsString>],
    place: &Range<u32>,
    content: Option<Content<'_>>,
) -> Result<bool> {
    let (doubts, doubted) = content.map_or((Vec::new(), Doubts::Settled), |content| (content.doubts, content.doubted));
    let refused = Vec::from_iter(doubted.refused());
    let commands: Vec<String> = commands.iter().map(|command| probe::line(command)).collect();
    if arguments.json {
        let written = !arguments.dry_run;
        let summary = json!({ "commands": commands, "written": written, "doubts": doubts, "refused": refused });
        out(&serde_json::to_string_pretty(&summary)?);
        return Ok(refused.is_empty());
    }
    if arguments.dry_run {
        commands.iter().for_each(|command| out(command));
    }
    let did = if arguments.dry_run { "would be" } else { "is" };
    if let Some(image) = &arguments.image {
        out(&format!("{} {did} written and verified", image.display()));
    }
    if let Some(table) = &arguments.table {
        let Range { start, end } = place;
        out(&format!("{} {did} in the parameter pages, 0x{start:08x} … 0x{:08x}", table.display(), end - 1));
    }
    if !arguments.dry_run {
        out("The device has been restarted; look at it with `piezo info --port …`");
    }
    Ok(refused.is_empty())
}
