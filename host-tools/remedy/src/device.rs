//! What goes wrong between host and device.

use super::bits::{Meaning, faults, status};
use device_link::LinkError;
use device_link::cycle::CycleError;
use device_link::pil::FeedError;
use device_link::play::PlayError;
use device_link::probe::ProbeError;
use device_link::table::RunningTableError;
use device_link::write::WriteError;
use estimator_core::table::Misfit;
use protocol::{Refusal, VERSION};
use std::error::Error;
use std::path::Path;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    error
        .downcast_ref()
        .map(link)
        .or_else(|| error.downcast_ref().map(play))
        .or_else(|| error.downcast_ref().map(cycle))
        .or_else(|| error.downcast_ref().map(feed))
        .or_else(|| error.downcast_ref().map(running))
        .or_else(|| error.downcast_ref().map(write))
        .or_else(|| error.downcast_ref().map(probe))
}

/// Why the table in a file does not fit a board, and the command that makes one that does.
pub fn board(misfit: &Misfit, file: &Path) -> String {
    let name = file.display();
    match misfit {
        Misfit::Tick { board_us, .. } => format!("{name}: {misfit}: identify with --tick-us {board_us}"),
        Misfit::Converters { table, board } => {
            let scales = [
                ("--adc-full-scale", table.adc_full_scale, board.adc_full_scale),
                ("--dac-full-scale", table.dac_full_scale, board.dac_full_scale),
            ];
            let wrong = scales.iter().filter(|(_, theirs, ours)| theirs != ours);
            let options: String = wrong.map(|(option, _, ours)| format!(" {option} {ours}")).collect();
            format!(
                "{name}: {misfit}: piezo emit {}{options} --out FOLDER (and say --adc-span and --dac-span, if you have \
                 measured them)",
                file.with_extension("toml").display()
            )
        }
    }
}

/// Why a device refuses, with its remedy.
pub fn refusal(refusal: &Refusal) -> String {
    format!("{refusal}{}", remedy(refusal))
}

fn remedy(refusal: &Refusal) -> &'static str {
    match refusal {
        Refusal::NoDrive => ": piezo emit --drive-span, then push",
        Refusal::TooSoon => ": let the actuator rest for a second, and zero again",
        Refusal::BeyondSpan { .. } => ": give µm; `piezo info` says the limits",
        Refusal::Faulty => ": piezo info says which",
        Refusal::Rewired => ": unplug it, then repeat with --rewired",
        _ => "",
    }
}

fn link(error: &LinkError) -> String {
    match error {
        LinkError::Silent { port } => format!(
            "{port}: no answer. Is it the board's port, is this project's firmware on the board (`piezo flash`), made from \
             the same sources as this program (protocol version {VERSION}), and is no other program connected to it?"
        ),
        LinkError::Version { found, .. } if *found < VERSION => {
            format!("{error}; build it (`cargo fw`) and flash it (`piezo flash --image`)")
        }
        LinkError::Refused { refusal, .. } => format!("{error}{}", remedy(refusal)),
        _ => error.to_string(),
    }
}

fn play(error: &PlayError) -> String {
    match error {
        PlayError::Link(error) => link(error),
        PlayError::Silent => format!("{error}: look at it with `piezo info`"),
        _ => error.to_string(),
    }
}

fn cycle(error: &CycleError) -> String {
    let remedies = |meanings: &mut dyn Iterator<Item = Meaning>| {
        let remedies: Vec<_> = meanings.map(|meaning| meaning.remedy).collect();
        format!("{error}: {}", remedies.join("; "))
    };
    match error {
        CycleError::Link(error) => link(error),
        CycleError::NoCycle { .. } => format!(
            "{error}: drive it up and down meanwhile, wait longer with --seconds, or leave --over-cycle out and tell the \
             displacement of now with --at"
        ),
        CycleError::SamplesLost(_) => format!("{error} Try again"),
        CycleError::Restarted | CycleError::Silent => format!("{error}: look at it with `piezo info`"),
        CycleError::Faulty(bits) => remedies(&mut faults(*bits)),
        CycleError::Worthless(bits) => remedies(&mut status(*bits)),
        CycleError::Interrupted => error.to_string(),
    }
}

fn feed(error: &FeedError) -> String {
    match error {
        FeedError::Link(error) => link(error),
        FeedError::Silent { .. } => format!("{error}: look at it with `piezo info`"),
        FeedError::Unasked { .. } => format!("{error} piezo reset, and try again"),
        _ => error.to_string(),
    }
}

fn running(error: &RunningTableError) -> String {
    match error {
        RunningTableError::Link(error) => link(error),
        RunningTableError::None => format!("{error}; give it one with `piezo push`"),
        RunningTableError::Refused(_) => error.to_string(),
    }
}

fn write(error: &WriteError) -> String {
    match error {
        WriteError::Link(error) => link(error),
        WriteError::Estimating => format!(
            "{error}: --pause interrupts the estimate, --reset restarts the device after it, --while-estimating writes all \
             the same"
        ),
    }
}

fn probe(error: &ProbeError) -> String {
    match error {
        ProbeError::NotInstalled(_) => format!(
            "{error}: `cargo install probe-rs-tools --locked`, or see https://probe.rs/docs/getting-started/installation"
        ),
        _ => error.to_string(),
    }
}
