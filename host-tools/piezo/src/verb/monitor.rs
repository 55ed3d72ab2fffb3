//! `piezo monitor`: what the device measures and estimates, live.
//!
//! In a terminal one block of lines that refreshes itself; elsewhere a line, or a JSON object, a second. With --web a
//! page for a browser instead; with --udp the same samples as datagrams, besides.

use super::device::{note_damage, require_estimating};
use super::print::{out, still_read};
use crate::option::link::PortOption;
use crate::option::{choice, count, not_negative};
use anyhow::{Result, ensure};
use bench::BoardFacts;
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::sensor::Sensor;
use device_link::window::Window;
use device_link::{table, words};
use estimator_core::Range;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use live_scope::terminal::{line, object, picture};
use live_scope::{Datagrams, Device, Format, Gone, Scope, Server, server};
use protocol::Mode;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Arguments of `piezo monitor`.
#[derive(Args, Debug)]
pub struct Monitor {
    /// End after so many seconds.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Print a JSON object a second, each on a line of its own.
    #[arg(long)]
    pub json: bool,
    /// Serve a page that shows it all in a browser, zeroes and records, and print its address. Without ADDRESS nobody
    /// but this machine reaches it, at a free port; at another address of this machine whoever knows the page's address
    /// may use it.
    #[arg(long, value_name = "ADDRESS", num_args = 0..=1, default_missing_value = server::HERE, conflicts_with = "json")]
    pub web: Option<String>,
    /// Folder of the page's recordings, recording-1.csv and so on; none is written over.
    #[arg(long, value_name = "FOLDER", default_value = ".", requires = "web")]
    pub out: PathBuf,
    /// Send the samples as UDP datagrams, too: 127.0.0.1:47269 is Teleplot's port, 9870 PlotJuggler's.
    #[arg(long, value_name = "HOST:PORT")]
    pub udp: Option<String>,
    /// What the datagrams are for.
    #[arg(long, value_parser = choice(FORMATS), default_value = "teleplot", requires = "udp")]
    pub format: Format,
    /// Of so many ticks, at most a second's, send those at which a quantity is least or largest; 1 sends all.
    #[arg(long, value_name = "TICKS", default_value_t = 10, value_parser = |text: &str| count::<u32>(text, "; 1 sends all"), requires = "udp", allow_negative_numbers = true)]
    pub every: u32,
    /// What the board's wires stand for: a board.toml. Where it says a sensor_span, page and datagrams have
    /// the sensor, too.
    #[arg(long, value_name = "FILE")]
    pub board: Option<PathBuf>,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
}

const FORMATS: [(Format, &str, &str); 2] = [
    (Format::Teleplot, "teleplot", "Teleplot: a line a quantity, its times in ms"),
    (
        Format::PlotJuggler,
        "plotjuggler",
        "PlotJuggler's UDP server, JSON: an object a tick, its time in s as timestamp",
    ),
];

/// How often the block is drawn.
const REFRESH: Duration = Duration::from_millis(100);
const SECOND: Duration = Duration::from_secs(1);

/// Runs the verb.
pub fn run(arguments: &Monitor) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let facts = arguments.board.as_deref().map(BoardFacts::read).transpose()?;
    let span = facts.and_then(|facts| facts.sensor_span);
    let mut device = open(arguments, span)?;
    if let (Some(path), Some(Err(other))) = (&arguments.board, facts.map(|facts| facts.of_board(&device.identity))) {
        eprintln!("piezo: careful: {}: {other}: the sensor's µm are by its span", path.display());
    }
    if bench::is_line(&device.table) {
        eprintln!("piezo: careful: {}", bench::NO_MODEL);
    }
    let second = device.ticks_in(1_000_000);
    ensure!(arguments.udp.is_none() || arguments.every <= second, "--every: at most {second}, the ticks of a second");
    let send = |to: &String| Datagrams::to(to, arguments.format, arguments.every, device.feed());
    let datagrams = arguments.udp.as_ref().map(send).transpose()?;
    let end =
        arguments.seconds.and_then(|seconds| Instant::now().checked_add(Duration::try_from_secs_f64(seconds).ok()?));
    let over = || interrupt.wanted() || end.is_some_and(|end| Instant::now() >= end);
    if let Some(address) = &arguments.web {
        let server = Server::start(address)?;
        result_files::folder(&arguments.out)?;
        if !server.is_loopback() {
            eprintln!("piezo: careful: other machines reach this page; whoever knows its address can zero and record");
        }
        out(&format!("The scope is at {} until Ctrl-C", server.url()));
        let mut scope = Scope::new(&server, &arguments.out, datagrams);
        let mut again = || open(arguments, span).map_err(|error| Gone(remedy::sentence(error.as_ref())));
        let ended = live_scope::run(device, &mut scope, &mut again, &over);
        ended.device.iter().for_each(|device| note_damage(&device.client));
        if let Some(recorded) = ended.recorded {
            out(&recorded?);
        }
        return Ok(true);
    }
    let window = device.window();
    let people = !arguments.json && std::io::stdout().is_terminal() && std::io::stdin().is_terminal();
    let limits = device.table.displacement_limits_um;
    let drives = device.table.drive.map(|_| device.client.health()).transpose()?.map(|health| health.mode);
    device.client.stream(true)?;
    let mut watched = Watched { device: &mut device, drives, datagrams, over: &over };
    let shown = if people { block(&mut watched, window, limits) } else { lines(&mut watched, window, arguments.json) };
    let stopped = device.client.stream(false);
    shown?;
    stopped?;
    note_damage(&device.client);
    Ok(true)
}

/// Opens the link to a device that estimates.
fn open(arguments: &Monitor, span: Option<(f64, f64)>) -> Result<Device> {
    let (mut client, identity) = arguments.port.connect()?;
    let health = client.health()?;
    if matches!(health.mode, Mode::Linearise | Mode::Waveform) {
        eprintln!("piezo: the device {}", words::state(&health));
    } else {
        require_estimating(&health, &arguments.port.port)?;
    }
    let table = table::running(&mut client)?;
    let sensor = span.map(|(zero_um, full_um)| Sensor { zero_um, full_um, full_scale: identity.adc_full_scale });
    Ok(Device { client, identity, table, sensor })
}

/// A device that is looked at, who else is told, and until when.
struct Watched<'a, F> {
    device: &'a mut Device,
    drives: Option<Mode>,
    datagrams: Option<Datagrams>,
    over: &'a F,
}

impl<F: Fn() -> bool> Watched<'_, F> {
    /// Takes samples until `until`, or until it is over.
    fn watch(&mut self, window: &mut Window, until: Instant) -> Result<()> {
        while !(self.over)() && Instant::now() < until {
            let patience = REFRESH.min(until.saturating_duration_since(Instant::now()));
            if let Some(samples) = self.device.client.samples(patience)? {
                window.take(&samples);
                self.datagrams.iter_mut().for_each(|datagrams| datagrams.take(&samples));
            }
        }
        Ok(())
    }
}

/// A line a second.
fn lines(watched: &mut Watched<'_, impl Fn() -> bool>, mut window: Window, json: bool) -> Result<()> {
    let start = Instant::now();
    let mut next = start;
    while !(watched.over)() {
        let (received, lost) = (window.received(), window.lost());
        window.clear();
        next += SECOND;
        watched.watch(&mut window, next)?;
        let (received, lost) = (window.received() - received, window.lost() - lost);
        // What is left of a second at the end is said where it has something to say.
        if received > 0 || !(watched.over)() {
            let time = start.elapsed().as_secs_f64();
            let said = match json {
                true => object(&window, time, received, lost),
                false => line(&window, watched.drives, received, lost),
            };
            // A pipe whose reader has gone, as `head` does, holds no port.
            if !still_read(&said) {
                break;
            }
        }
    }
    Ok(())
}

/// A block that refreshes itself, until Ctrl-C or the end.
fn block(watched: &mut Watched<'_, impl Fn() -> bool>, mut window: Window, limits: Range) -> Result<()> {
    let shown = ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout());
    shown.set_style(ProgressStyle::with_template("{msg}")?);
    let (mut second, mut before, mut rate) = (Instant::now(), 0, None);
    while !(watched.over)() {
        watched.watch(&mut window, Instant::now() + REFRESH)?;
        let elapsed = second.elapsed();
        if elapsed >= SECOND {
            let received = window.received() - before;
            rate = Some(received as f64 / elapsed.as_secs_f64());
            (second, before) = (Instant::now(), window.received());
            if received == 0 {
                window.clear();
            }
        }
        shown.set_message(picture(&window, watched.drives, limits, rate).join("\n"));
    }
    shown.abandon();
    Ok(())
}
