//! `piezo monitor`: what the device measures and estimates, live.
//!
//! In a terminal one block of lines that refreshes itself; elsewhere a line, or a JSON object, a second.

use super::device::{note_damage, require_estimating};
use super::print::out;
use crate::option::link::PortOption;
use crate::option::not_negative;
use anyhow::Result;
use clap::Args;
use device_link::interrupt::Interrupt;
use device_link::table;
use device_link::window::Window;
use device_link::{Client, words};
use estimator_core::Range;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use protocol::Mode;
use serde_json::json;
use std::io::IsTerminal;
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
    /// The device.
    #[command(flatten)]
    pub port: PortOption,
}

/// How often the block is drawn.
const REFRESH: Duration = Duration::from_millis(100);
const SECOND: Duration = Duration::from_secs(1);
/// Characters of the bar.
const BAR: usize = 50;

/// Runs the verb.
pub fn run(arguments: &Monitor) -> Result<bool> {
    let interrupt = Interrupt::watch()?;
    let (mut client, identity) = arguments.port.connect()?;
    let health = client.health()?;
    if health.mode == Mode::Linearise {
        eprintln!("piezo: the device {}", words::mode(health.mode));
    } else {
        require_estimating(&health, &arguments.port.port)?;
    }
    let table = table::running(&mut client)?;
    if bench::is_line(&table) {
        eprintln!("piezo: careful: {}", bench::NO_MODEL);
    }
    let window = Window::new(table.adc, (1_000_000 / identity.tick_us.max(1)) as usize);
    client.stream(true)?;
    let end =
        arguments.seconds.and_then(|seconds| Instant::now().checked_add(Duration::try_from_secs_f64(seconds).ok()?));
    let over = || interrupt.wanted() || end.is_some_and(|end| Instant::now() >= end);
    let people = !arguments.json && std::io::stdout().is_terminal() && std::io::stdin().is_terminal();
    let shown = if people {
        block(&mut client, window, table.displacement_limits_um, &over)
    } else {
        lines(&mut client, window, arguments.json, &over)
    };
    let stopped = client.stream(false);
    shown?;
    stopped?;
    note_damage(&client);
    Ok(true)
}

/// Takes samples until `until`, or until it is over.
fn watch(client: &mut Client, window: &mut Window, until: Instant, over: &impl Fn() -> bool) -> Result<()> {
    while !over() && Instant::now() < until {
        if let Some(samples) = client.samples(REFRESH.min(until.saturating_duration_since(Instant::now())))? {
            window.take(&samples);
        }
    }
    Ok(())
}

/// A line a second.
fn lines(client: &mut Client, mut window: Window, json: bool, over: &impl Fn() -> bool) -> Result<()> {
    let start = Instant::now();
    let mut next = start;
    while !over() {
        let (received, lost) = (window.received(), window.lost());
        window.clear();
        next += SECOND;
        watch(client, &mut window, next, over)?;
        let (received, lost) = (window.received() - received, window.lost() - lost);
        // What is left of a second at the end is said where it has something to say.
        if received > 0 || !over() {
            let time = start.elapsed().as_secs_f64();
            out(&if json { object(&window, time, received, lost) } else { line(&window, received, lost) });
        }
    }
    Ok(())
}

fn line(window: &Window, received: u64, lost: u64) -> String {
    let (Some(y), Some(v), Some(code)) = (window.displacement(), window.voltage(), window.code()) else {
        return format!("no samples; {lost} lost");
    };
    format!(
        "{:9.3} µm{} ({:.3} … {:.3})  {:8.4} V ({:.4} … {:.4})  code {code:5}  {received} samples, {lost} lost{}",
        y.last,
        beside(window),
        y.min,
        y.max,
        v.last,
        v.min,
        v.max,
        said(window).map_or(String::new(), |said| format!("  {said}"))
    )
}

/// The interval beside the estimate, if there is one.
fn beside(window: &Window) -> String {
    window.half_width().map_or(String::new(), |half| format!(" ± {half:.3} µm"))
}

fn object(window: &Window, time_s: f64, samples: u64, lost: u64) -> String {
    let (y, v) = (window.displacement(), window.voltage());
    json!({
        "time_s": time_s,
        "displacement_um": y.map(|y| y.last),
        "half_width_um": window.half_width(),
        "displacement_min_um": y.map(|y| y.min),
        "displacement_max_um": y.map(|y| y.max),
        "voltage_V": v.map(|v| v.last),
        "voltage_min_V": v.map(|v| v.min),
        "voltage_max_V": v.map(|v| v.max),
        "code": window.code(),
        "samples": samples,
        "lost": lost,
        "status": window.status().iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
        "faults": window.faults().iter_names().map(|(name, _)| name).collect::<Vec<_>>(),
    })
    .to_string()
}

/// Status and faults of the last second in words, if there are any.
fn said(window: &Window) -> Option<String> {
    let faults = words::faults(window.faults()).map(|(_, what)| what);
    let words = words::list(faults.chain(words::status(window.status()).map(|(_, what)| what)));
    (!words.is_empty()).then_some(words)
}

/// A block that refreshes itself, until Ctrl-C or the end.
fn block(client: &mut Client, mut window: Window, limits: Range, over: &impl Fn() -> bool) -> Result<()> {
    let shown = ProgressBar::with_draw_target(None, ProgressDrawTarget::stdout());
    shown.set_style(ProgressStyle::with_template("{msg}")?);
    let (mut second, mut before, mut rate) = (Instant::now(), 0, None);
    while !over() {
        watch(client, &mut window, Instant::now() + REFRESH, over)?;
        let elapsed = second.elapsed();
        if elapsed >= SECOND {
            let received = window.received() - before;
            rate = Some(received as f64 / elapsed.as_secs_f64());
            (second, before) = (Instant::now(), window.received());
            if received == 0 {
                window.clear();
            }
        }
        shown.set_message(picture(&window, limits, rate).join("\n"));
    }
    shown.abandon();
    Ok(())
}

fn picture(window: &Window, limits: Range, rate: Option<f64>) -> Vec<String> {
    let (Some(y), Some(v), Some(code)) = (window.displacement(), window.voltage(), window.code()) else {
        return vec!["waiting for samples …".to_owned(), "Ctrl-C ends".to_owned()];
    };
    let rate = rate.map_or("…".to_owned(), |rate| format!("{rate:.0}"));
    vec![
        format!("displacement {:10.3} µm{}   last second {:.3} … {:.3} µm", y.last, beside(window), y.min, y.max),
        format!("voltage      {:10.4} V    last second {:.4} … {:.4} V   ADC code {code}", v.last, v.min, v.max),
        format!("{:.1} {} {:.1} µm", limits.min, bar(y.last, limits), limits.max),
        format!("{rate} samples a second, {} lost", window.lost()),
        said(window).unwrap_or("all is well".to_owned()),
        "Ctrl-C ends".to_owned(),
    ]
}

/// Where a value stands within limits.
fn bar(value: f32, limits: Range) -> String {
    let part = ((value - limits.min) / (limits.max - limits.min)).clamp(0.0, 1.0);
    // Of a NaN this is 0.
    let place = (part * (BAR - 1) as f32).round() as usize;
    (0..BAR).map(|k| if k == place { '█' } else { '·' }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use emulator::faults::lose_samples_at;
    use emulator::{Emulator, FaultyLine, TABLE};
    use estimator_core::{AdcCode, DacCode};
    use std::cell::Cell;

    const LIMITS: Range = Range { min: -5.0, max: 45.0 };

    #[test]
    fn the_bar_shows_where_it_is_and_never_leaves_itself() {
        let place = |value| bar(value, LIMITS).chars().position(|c| c == '█');
        assert_eq!((place(-5.0), place(45.0), place(-1e9), place(f32::NAN)), (Some(0), Some(49), Some(0), Some(0)));
        assert_eq!(bar(20.0, LIMITS).chars().count(), BAR);
    }

    #[test]
    fn a_second_of_samples_in_figures_and_words() {
        // A saw over a quarter of the range.
        let mut tick = 0;
        let saw = move |_: DacCode| {
            tick = (tick + 1) % 1000;
            AdcCode(24_000 + 16 * tick).into()
        };
        let device = Emulator::new().plant(saw).speed(8.0).start().unwrap();
        let faulty = FaultyLine::to(device.address(), lose_samples_at(100)).unwrap();
        let (mut client, _) = Client::connect(&faulty.address().into()).unwrap();
        client.stream(true).unwrap();
        let mut window = Window::new(TABLE.adc, 2000);
        assert!(picture(&window, LIMITS, None)[0].contains("waiting"));
        assert_eq!(line(&window, 0, 0), "no samples; 0 lost");
        let looks = Cell::new(0);
        let over = || looks.replace(looks.get() + 1) > 20;
        watch(&mut client, &mut window, Instant::now() + SECOND, &over).unwrap();
        assert!(window.received() > 100 && window.lost() > 0);
        let object: serde_json::Value = serde_json::from_str(&object(&window, 1.0, 7, 8)).unwrap();
        assert!(object["displacement_um"].is_number() && object["voltage_V"].is_number(), "{object}");
        assert_eq!((&object["samples"], &object["lost"]), (&json!(7), &json!(8)));
        let picture = picture(&window, LIMITS, Some(1999.7)).join("\n");
        for part in ["µm", " V ", "█", "2000 samples a second", "had not turned at either end"] {
            assert!(picture.contains(part), "{part:?} is missing in\n{picture}");
        }
    }
}
