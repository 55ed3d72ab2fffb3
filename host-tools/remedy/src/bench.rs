//! What goes wrong in a session on the bench.

use super::bits::faults;
use super::device::too_long;
use super::paste::{quoted, typed, verb, with};
use bench::{
    AnotherBoard, BenchError, BoardFileError, CalibrationError, Complaint, NoModel, Session, Wiring, WiringError,
};
use emulator::{Bench, EmulatorError};
use estimator_core::table::Misfit;
use excitation::ExcitationError;
use protocol::Faults;
use std::error::Error;
use std::path::Path;

/// The error with its remedy, if it is one of these.
pub fn told(error: &(dyn Error + 'static)) -> Option<String> {
    error
        .downcast_ref()
        .map(session)
        .or_else(|| error.downcast_ref().map(wiring))
        .or_else(|| error.downcast_ref().map(board_file))
        .or_else(|| error.downcast_ref().map(another))
        .or_else(|| error.downcast_ref().map(calibration))
        .or_else(|| error.downcast_ref().map(emulated))
        .or_else(|| error.downcast_ref().map(excitation))
        .or_else(|| error.downcast_ref().map(no_model))
}

/// What sent a drive to rest, each fault with its remedy.
pub fn stopped(bits: Faults) -> String {
    if bits == Faults::SAFE_OUTPUT {
        return "this machine sent no voltages for a second, and the device went back to rest: was it suspended, or too busy?".to_owned();
    }
    let said: Vec<String> =
        faults(bits & !Faults::SAFE_OUTPUT).map(|of| format!("{}: {}", of.what, of.remedy)).collect();
    format!("a fault sent the voltage back to rest: {}", said.join("; "))
}

/// What is wrong with a sensor, with its remedy.
pub fn complaint(complaint: &Complaint) -> String {
    let remedy = match complaint {
        Complaint::NoSensor => "is this the firmware of a board with a sensor's channel? `piezo info` says which it is",
        Complaint::Saturated { .. } => {
            "move the sensor's zero, choose a smaller --range, or correct sensor_span in board.toml"
        }
        Complaint::Still { .. } => {
            "is the sensor connected to the board's second channel, and the actuator to the amplifier?"
        }
    };
    format!("{complaint}: {remedy}")
}

/// What a drive by a calibration that is wrong ends with, while that is what is to be calibrated.
const NEAR: &str = "--drive-to needs spans that are right to some 5 % already: else calibrate the ADC by hand first, without --drive-to, correct \
                    drive_span in board.toml, and install the table anew (--rewired)";

/// A calibration reads as far from the range's ends, of it.
const INNER: f32 = 0.1;

/// What an emulated bench is, and what to type next, to learn from it or else to calibrate it, by these options.
pub fn introduced(bench: &Bench, wiring: &Wiring, learns: bool, options: &str) -> (String, String) {
    let (limits, sensor) = (wiring.drive().limits, wiring.sensor);
    let range = limits.range_v;
    let described = format!(
        "Its DAC drives an amplifier of {} … {} V ({} V/s, rest at {} V), its ADC reads that voltage and a sensor of {} … {} µm beside an actuator \
         that goes {:.1} µm when it first rises",
        range.min, range.max, limits.slew_v_per_s, limits.rest_v, sensor.zero_um, sensor.full_um, bench.stroke_um
    );
    // Nobody sets its voltage by hand: the board drives there.
    let inner = INNER * range.span();
    let (low, high) = (range.min + inner, range.max - inner);
    let next = match learns {
        true => format!("from board and sensor to a proven table:\n\n    piezo learn {options} --out p885"),
        false => format!("measure what it is wired with:\n\n    piezo calibrate {options} --drive-to {low}:{high}"),
    };
    (described, next)
}

/// What a session leaves that was learnt from, installed and proven.
pub fn learnt(model: &str, port: &str) -> String {
    format!(
        "\nThe board goes on without the sensor; {model}/report.html shows what it has learnt. At a known position, and live:\n\n    \
         piezo zero --port {port}\n    piezo monitor --port {port}"
    )
}

fn session(error: &BenchError) -> String {
    match error {
        BenchError::NotDriving => format!(
            "{error}: unplug the amplifier from the DAC, then `piezo install --line --rewired` with this --board and --port, and \
             plug it in again"
        ),
        BenchError::OtherConverters { .. } => format!("{error}: `piezo install` it with this --board"),
        BenchError::Misfit(misfit @ Misfit::Cycles { drives, .. }) => format!("{misfit}: {}", too_long(*drives)),
        BenchError::Misfit(_) => format!("{error}: state the device's adc_full_scale and dac_full_scale in board.toml"),
        BenchError::Sensor { complaint: of, log: None } => complaint(of),
        BenchError::Sensor { complaint: of, log: Some(log) } => {
            format!("{}; what was measured before is in {}", complaint(of), log.display())
        }
        BenchError::WouldJump { .. } => {
            let unplug =
                "unplug the amplifier's input from the DAC, or switch the amplifier off, and plug it in afterwards:";
            let (board, port) = (typed("--board"), typed("--port"));
            match verb("install") {
                true => format!("{error}: {unplug}{} --rewired", with(Path::new(""), &[])),
                false => format!("{error}: {unplug}\n    piezo install --line{board} --rewired{port}"),
            }
        }
        BenchError::FormerKept { path } => {
            let (path, port) = (quoted(&path.display().to_string()), typed("--port"));
            format!("{error}: bring it back:\n    piezo push {path} --reset{port}")
        }
        BenchError::Occupied { path } => match path.parent() {
            Some(folder) if verb("train") && bench::session(folder).is_ok_and(|session| session.complete) => {
                format!(
                    "{error}, which is whole: choose another --out, or learn from it:\n    {}{}",
                    identify(folder),
                    typed("--board")
                )
            }
            _ if verb("learn") && path.ends_with("proof") => {
                format!("{error}: choose another --out, or prove again: `piezo prove --out` another folder")
            }
            Some(folder) if verb("train") || verb("learn") => match bench::session(folder) {
                Ok(Session { unfinished: Some(unfinished), logs, .. }) if !logs.is_empty() => {
                    let folder = quoted(&folder.display().to_string());
                    let board = typed("--board");
                    format!(
                        "{error}; {unfinished}: choose another --out, or learn from what is there:\n    \
                         piezo identify {folder} --out {folder}/model{board}"
                    )
                }
                Ok(Session { unfinished: Some(unfinished), .. }) => {
                    format!("{error}; {unfinished}: choose another --out")
                }
                _ => format!("{error}: choose another --out"),
            },
            _ => format!("{error}: choose another --out"),
        },
        BenchError::BeyondDrive { range_v, .. } => {
            format!("{error}: --drive-to {}:{} at most", range_v.min, range_v.max)
        }
        BenchError::SlowRamp { .. } => {
            format!(
                "{error}, more than a minute: is drive_slew in board.toml, and the table's, what the amplifier stands?"
            )
        }
        BenchError::NothingStated => format!("{error}: say it with --max-percent, of the stroke"),
        BenchError::Stopped { ticks, faults } => {
            let said = format!("after {ticks} ticks {}", stopped(*faults));
            match verb("calibrate") && faults.contains(Faults::AMPLIFIER) {
                true => format!("{said}; {NEAR}"),
                false => said,
            }
        }
        BenchError::Recalibrated { .. } => {
            format!(
                "{error}: train again, or, where that was the right one, put it back into the board's file (of a sensor that is another one \
                 now, take the line out)"
            )
        }
        BenchError::NotTaken => format!("{error}: try again"),
        BenchError::NotAtRest { .. } => {
            let asked = "is the amplifier connected and switched on? `piezo info` says how the device is";
            match verb("calibrate") {
                true => format!("{error}: {asked}; {NEAR}"),
                false => format!("{error}: {asked}"),
            }
        }
        BenchError::Nothing(_) => format!("{error}: choose a longer --seconds"),
        _ => error.to_string(),
    }
}

/// The command that identifies a table from the logs of a session in a folder, but for the board's file.
pub fn identify(folder: &Path) -> String {
    let folder = quoted(&folder.display().to_string());
    format!("piezo identify {folder} --out {folder}/model")
}

fn another(error: &AnotherBoard) -> String {
    if verb("calibrate") {
        return format!(
            "{error}: connect that board, or name a new file for this one with --board; --another-board does not help, for the \
             file would then be of two"
        );
    }
    format!(
        "{error}: connect that board, or measure this one (`piezo calibrate` with another --board); --another-board takes it all the same"
    )
}

fn calibration(error: &CalibrationError) -> String {
    let remedy = match error {
        CalibrationError::NoSensor => {
            "is this the firmware of a board with a sensor's channel? `piezo info` says which it is"
        }
        CalibrationError::Silent => "look at it with `piezo info`",
        CalibrationError::Saturated { .. } => {
            "is it connected? Else measure where the pin is between 0.15 and 3.15 V; `piezo divider` says which resistors bring all of \
             the range there"
        }
        CalibrationError::Drifts { .. } => {
            "wait until it stands still: the amplifier, the actuator's creep, a sensor that warms up; then repeat"
        }
        CalibrationError::TooNear { .. } => {
            "measure farther apart, at a tenth and at nine tenths of the range; if it was, is the wire to this channel sound?"
        }
        CalibrationError::FarFromDriven { .. } => {
            "was it mistyped, or read at the other point, and is the multimeter at the amplifier's output, in V? If it is right, \
             drive_span in board.toml is wrong by as much: correct it there by the amplifier's data sheet, install the table anew (--rewired), \
             and repeat"
        }
        CalibrationError::OtherWay { .. } => {
            "were they swapped or mistyped? If they are right, drive_span in board.toml goes the wrong way: correct it there, install the \
             table anew (--rewired), and repeat"
        }
        CalibrationError::Inverted { .. } => {
            "were the readings swapped or mistyped? If the wiring is another one now, remove the line of the former span from board.toml"
        }
        CalibrationError::Faulty(bits) => {
            let remedies: Vec<&str> = faults(*bits).map(|of| of.remedy).collect();
            return format!("{error}: {}", remedies.join("; "));
        }
        CalibrationError::NoDrive => {
            "write drive_range = [LOWEST, HIGHEST], the V that the actuator may have, and drive_slew = V/s into the file first; \
             or calibrate by hand, without --drive-to"
        }
        CalibrationError::NoTick => "is it a firmware of this version? `piezo info` says which it is",
        CalibrationError::SameReading(..) => "does the instrument measure what the channel does?",
        CalibrationError::Interrupted => return error.to_string(),
    };
    format!("{error}: {remedy}")
}

fn wiring(error: &WiringError) -> String {
    match error {
        WiringError::Missing { field, .. } => format!("{error}: measure it, and add a line {field} = …"),
        WiringError::BeyondRange { allowed, .. } => format!("{error}: --range {}:{} at most", allowed.min, allowed.max),
        WiringError::Refused(_) => error.to_string(),
    }
}

fn no_model(error: &NoModel) -> String {
    format!("{error}: {FORMER_OF_KILLED}; else `piezo train`, `piezo identify` and `piezo install` make one")
}

/// Where the model went that a device had before it was given a straight line.
pub const FORMER_OF_KILLED: &str = "where `piezo train` was killed, its folder keeps the table of before as former-table.bin, and \
                                    `piezo push '<FOLDER>/former-table.bin' --reset` brings it back";

fn board_file(error: &BoardFileError) -> String {
    match error {
        BoardFileError::Unreadable { .. } => {
            format!("{error}: write what you have measured of your board; `piezo emulate` writes an emulated one's")
        }
        _ => error.to_string(),
    }
}

fn emulated(error: &EmulatorError) -> String {
    match error {
        EmulatorError::Socket(_) => {
            format!("{error}; is another `piezo emulate` running? --tcp-port 0 takes any port that is free")
        }
        EmulatorError::Flash(_) => error.to_string(),
    }
}

fn excitation(error: &ExcitationError) -> String {
    match error {
        ExcitationError::TooShort { least_s, .. } => {
            format!(
                "{error}: --minutes {:.1} (of prove: --seconds {:.0}), or a smaller --range",
                (least_s / 6.0).ceil() / 10.0,
                least_s.ceil()
            )
        }
        ExcitationError::TooFast { most_hz, .. } => format!("{error}: --up-to {most_hz}"),
        ExcitationError::TooLong { .. } => {
            format!("{error}: choose a smaller --range, or a drive_slew that is what the amplifier stands")
        }
        ExcitationError::Rest { .. } => format!("{error}: let --range hold drive_rest of board.toml"),
        _ => error.to_string(),
    }
}
