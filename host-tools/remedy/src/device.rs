//! What goes wrong between host and device.

use super::bits::{Meaning, faults, status};
use super::paste::{typed, verb, with};
use device_link::busy::Busy;
use device_link::cycle::CycleError;
use device_link::pil::{Comparison, FeedError};
use device_link::play::PlayError;
use device_link::port::PortError;
use device_link::probe::ProbeError;
use device_link::stlink::Plugged;
use device_link::table::RunningTableError;
use device_link::told::ToldError;
use device_link::write::{RESTARTING, UNSURE, WRITTEN, WriteError, sentences};
use device_link::{Address, LinkError, words};
use estimator_core::Admitted;
use estimator_core::table::Misfit;
use protocol::{Mode, Refusal, TableSource, VERSION};
use std::error::Error;
use std::path::Path;
use table_files::in_folder;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    error
        .downcast_ref()
        .map(link)
        .or_else(|| error.downcast_ref().map(play))
        .or_else(|| error.downcast_ref().map(telling))
        .or_else(|| error.downcast_ref().map(cycle))
        .or_else(|| error.downcast_ref().map(feed))
        .or_else(|| error.downcast_ref().map(running))
        .or_else(|| error.downcast_ref().map(write))
        .or_else(|| error.downcast_ref().map(busy))
        .or_else(|| error.downcast_ref().map(probe))
}

/// Why the table in a file does not fit a board, and the command that makes one that does.
pub fn board(misfit: &Misfit, table: &Admitted, file: &Path) -> String {
    let name = file.display();
    match misfit {
        Misfit::Tick { board_us, .. }
            if table.at_tick(*board_us).is_ok_and(|table| table.admit().is_ok() && table.in_time().is_ok()) =>
        {
            format!("{name}: {misfit}: piezo emit {} --tick-us {board_us} --out FOLDER", for_people(file))
        }
        Misfit::Tick { board_us, .. } => format!("{name}: {misfit}: identify with --tick-us {board_us}"),
        Misfit::Cycles { drives, .. } => format!("{name}: {misfit}: {}", too_long(*drives)),
        Misfit::Converters { table: of, board } => {
            let scales = [
                ("--adc-full-scale", of.adc_full_scale, board.adc_full_scale),
                ("--dac-full-scale", of.dac_full_scale, board.dac_full_scale),
            ];
            let wrong = scales.iter().filter(|(_, theirs, ours)| theirs != ours);
            let options: String = wrong.map(|(option, _, ours)| format!(" {option} {ours}")).collect();
            format!(
                "{name}: {misfit}: piezo emit {}{options} --out FOLDER (and say --adc-span and --dac-span, if you have \
                 measured them)",
                for_people(file)
            )
        }
    }
}

/// The table for people of a table's file: beside it, where it is.
fn for_people(file: &Path) -> String {
    let beside = in_folder(file).with_extension("toml");
    if beside.is_file() { beside.display().to_string() } else { "<TABLE>.toml".to_owned() }
}

/// What helps where the tick takes too long, with or without a search for the voltage.
pub(super) fn too_long(drives: bool) -> &'static str {
    if drives {
        "drive with another model's table (identify with --model generalised-prandtl-ishlinskii), let this one estimate (emit the \
         table that has no drive yet), or compute the voltages on the host (piezo feedforward)"
    } else {
        "identify with another --model"
    }
}

/// Why a device that does not estimate cannot be told anything, and what makes it estimate again; `None` where it does.
pub fn not_estimating(mode: Mode, port: &Address) -> Option<String> {
    let does = words::mode(mode);
    let said = || format!("{port}: the device {does}; make it estimate again: piezo reset --port {port}");
    (!mode.measures()).then(said)
}

/// Whether a device's parameter store would be emptied, if nothing refuses that here. By which wires its image's own
/// table has its DAC is not known before, unless they are said to be `rewired` for it.
pub fn would_erase(board: &str, allowed: bool, rewired: bool) -> String {
    let would = match (allowed, rewired) {
        (false, _) => "would be refused",
        (true, true) => "can be done",
        (true, false) => "can be done, unless its image's own table wants the DAC wired otherwise: then with --rewired",
    };
    format!("emptying the parameter store of {board} {would}; nothing was erased")
}

/// What a device does whose parameter store was emptied, after a restart by the table from this source.
pub fn erased(board: &str, restarted: Option<&TableSource>, port: &Address) -> String {
    let now = match restarted {
        Some(source) => format!("Its table is now {}", words::source(source)),
        None => format!("The table in use stays until the next reset: piezo reset --port {port}"),
    };
    format!("the parameter store of {board} is empty\n{now}")
}

/// How a rehearsal of a table went, a device beside the host.
pub fn rehearsed(of: &Comparison) -> String {
    let Comparison { ticks, identical, max_difference_um, .. } = of;
    match ticks - identical {
        0 => format!("bit-exact: over {ticks} ticks of a random voltage the device's every bit is the host's"),
        differ => format!(
            "FAILED: {differ} of {ticks} ticks differ, by at most {max_difference_um:e} µm: are the firmware and this program built from \
             the same sources?"
        ),
    }
}

/// Why a device refuses, with its remedy.
pub fn refusal(refusal: &Refusal) -> String {
    format!("{refusal}{}", remedy(refusal))
}

fn remedy(refusal: &Refusal) -> String {
    let remedy = match refusal {
        Refusal::NoDrive => ": piezo emit --drive-span, then push",
        Refusal::NoSetpoint => ": piezo emit --setpoint-span, then push",
        Refusal::NoSetpointInput => ": it takes a board that has one, as the NUCLEO-G474RE",
        Refusal::Playing => return format!(": {}", stop()),
        Refusal::NotByMode => return format!(": piezo waveform '<FILE>'{}", typed("--port")),
        Refusal::NotLoaded { .. } => return format!(": load it again (piezo waveform '<FILE>'{})", typed("--port")),
        Refusal::NoTriggerInput => ": play it without --on-trigger",
        Refusal::TooSoon => ": let the actuator rest for a second, and zero again",
        Refusal::NotBelieved => ": piezo info and piezo monitor say what is wrong; mend that, and zero then",
        Refusal::BeyondSpan { .. } => ": give µm; `piezo info` says the limits",
        Refusal::Faulty => ": piezo info says which",
        Refusal::Rewired => ": unplug it, then repeat with --rewired",
        _ => "",
    };
    remedy.to_owned()
}

/// The command that ends what the device plays.
pub(super) fn stop() -> String {
    format!("piezo waveform --stop{}", typed("--port"))
}

pub(super) fn link(error: &LinkError) -> String {
    match error {
        LinkError::Port(error) => port(error),
        // Whoever was first has it, and it lets nobody else in.
        LinkError::Silent { port: at @ Address::Tcp(_) } => format!(
            "{at}: no answer. Is another program connected to it, as `piezo monitor` may be (an emulated board answers one \
             at a time)? Is it a board's port, is this project's firmware on the board (`piezo flash`), made from the same \
             sources as this program (protocol version {VERSION})?"
        ),
        LinkError::Silent { port: at } => format!(
            "{at}: no answer. Is it the board's port, is this project's firmware on the board (`piezo flash`), made from \
             the same sources as this program (protocol version {VERSION}), and is no other program connected to it?"
        ),
        LinkError::Version { found, .. } if *found < VERSION => {
            format!("{error}; build it (`cargo fw`) and flash it (`piezo flash --image`)")
        }
        LinkError::Refused { refusal, .. } => format!("{error}{}", remedy(refusal)),
        _ => error.to_string(),
    }
}

fn port(error: &PortError) -> String {
    match error {
        // A socket's address is no port's name.
        PortError::Missing { port, .. } if format!("tcp:{port}").parse::<Address>().is_ok() => {
            format!("{error}; a socket's is --port tcp:{port}")
        }
        PortError::Nobody { .. } => {
            format!("{error}; start an emulated board with `piezo emulate`, or in QEMU with `cargo xtask emulate`")
        }
        PortError::NoBoard { .. } => format!(
            "{error}. Is the cable one for data, and at the connector of the probe (USB ST-LINK)? Is the lamp LD1 lit? Another \
             serial port is named with --port, an emulated board with --port tcp:HOST:PORT"
        ),
        PortError::Several { boards } => {
            let line = |board: &Plugged| {
                let serial = if board.serial.is_empty() { "no serial number" } else { &board.serial };
                format!("{}   # {serial}", with(Path::new(""), &[("--port", &board.port)]))
            };
            format!("{error}: name one{}", boards.iter().map(line).collect::<String>())
        }
        _ => error.to_string(),
    }
}

/// Where the voltage goes that nobody is seen to drive any more.
const ALONE: &str = "A board that still has power misses this machine, and begins to bring its voltage to rest, at drive_slew, within five \
                     seconds (of follow --stay, once its last reference is there, it holds that until piezo reset).";

fn play(error: &PlayError) -> String {
    match error {
        PlayError::Link(error @ LinkError::Refused { .. }) => link(error),
        PlayError::Link(error) => format!("{} {ALONE}", link(error)),
        PlayError::LetGo => format!("{error}; was this machine suspended, or too busy?"),
        PlayError::Silent => format!("{error}: look at it with `piezo info`"),
        _ => error.to_string(),
    }
}

fn telling(error: &ToldError) -> String {
    let port = typed("--port");
    match error {
        ToldError::Link(LinkError::Unknown { .. }) => {
            format!("{error}: `piezo info{port}` says how long ago it was zeroed; zero again if need be")
        }
        ToldError::Link(error) => link(error),
        ToldError::NotTaken { .. } => format!("{error}: `piezo info{port}` says why; then zero again"),
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

/// Where that is not known.
const INFO: &str = "`piezo info` says which table is in use.";

fn write(error: &WriteError) -> String {
    match error {
        WriteError::Link(error) => link(error),
        WriteError::Unsure(error) => format!("{} {INFO}", sentences(&link(error), UNSURE)),
        WriteError::Written(error) => sentences(&link(error), WRITTEN),
        WriteError::Restarting(error) => format!("{} {INFO}", sentences(&link(error), RESTARTING)),
        WriteError::Estimating => format!(
            "{error}: --pause interrupts the estimate, --reset restarts the device after it, --while-estimating writes all \
             the same"
        ),
    }
}

fn busy(error: &Busy) -> String {
    let port = typed("--port");
    let ends = match error {
        Busy::Link(error) => return link(error),
        Busy::Drives(Mode::Waveform) => format!("`{}` ends it", stop()),
        Busy::Drives(Mode::Linearise) => format!("`piezo linearise --stop{port}` ends it"),
        Busy::Drives(_) => format!("Ctrl-C there, or `piezo reset --force{port}`, ends it"),
    };
    match ["push", "erase", "install", "pil", "reset", "prove", "calibrate"].into_iter().any(verb) {
        true => format!("{error}: {ends}, and so does this, typed with --force"),
        false => format!("{error}: {ends}"),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_boards_each_has_a_line_to_paste_with_its_serial_number() {
        let board = |port: &str, serial: &str| Plugged { port: port.to_owned(), serial: serial.to_owned() };
        let boards = vec![board("/dev/ttyACM0", "0039"), board("/dev/ttyACM1", "")];
        let said = link(&LinkError::Port(PortError::Several { boards }));
        let lines: Vec<&str> = said.lines().skip(1).collect();
        assert!(
            said.starts_with("2 boards are plugged in, with the ST-Links 0039, at /dev/ttyACM1: name one"),
            "{said}"
        );
        assert!(lines[0].ends_with("--port /dev/ttyACM0   # 0039") && lines[0].contains("    piezo "), "{said}");
        assert!(lines[1].ends_with("--port /dev/ttyACM1   # no serial number") && lines.len() == 2, "{said}");
    }

    #[test]
    fn where_nothing_listens_a_board_is_emulated() {
        let said = link(&LinkError::Port(PortError::Nobody { socket: "127.0.0.1:4740".to_owned() }));
        assert!(
            said.starts_with("tcp:127.0.0.1:4740: nothing listens there; start") && said.contains("`piezo emulate`")
        );
    }
}
