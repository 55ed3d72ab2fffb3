//! `piezo`: parses arguments, runs a verb, turns what comes of it into an exit code.

#[cfg(test)]
#[path = "../../../tests/documents/commands.rs"]
mod documents;
mod option;
mod output;
mod verb;
#[cfg(test)]
#[path = "../../../tests/documents/versions.rs"]
mod versions;

use clap::error::{ContextKind, ContextValue};
use clap::{CommandFactory, Parser, Subcommand};
use std::process::ExitCode;
use verb::{
    calibrate, collect, compare, divider, emit, emulate, erase, estimate, feedforward, flash, follow, identify, info,
    install, learn, linearise, look, manual, monitor, pil, prove, pull, push, record, reproduce, reset, simulate,
    train, validate, waveform, zero,
};

/// Sensorless displacement of piezo actuators: learn the model from one recorded session with a real sensor, judge it
/// on data it had not seen, and put it on a microcontroller.
#[derive(Parser)]
#[command(name = "piezo", version, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

const EXIT_CODES: &str = "Exit codes:
  0  done
  1  done, and it came out badly: a threshold was exceeded or a trajectory not met (validate, feedforward, prove),
     a bit differs (pil, install), a unit has no table (collect), it ended before its time (record, train, prove, follow),
     a part failed (learn), a fault stopped it or it waited for the host (follow), what was only tried would be refused
     (--dry-run of push, erase, install, flash, reset, prove)
  2  not done: the arguments, a file or the device are wrong, or the link broke; no file is left half-written";

// In the order in which a newcomer meets them: logs, a board with a sensor, a board that estimates, its
// tables, the thesis.
#[derive(Subcommand)]
enum Verb {
    /// Logs → what was understood of them: columns, rate, ranges, reversals, amplitudes ×
    /// frequencies, noise, saturation.
    #[command(after_help = "Examples:
  piezo look tests/data/picma-p885-1hz.csv
  piezo look recording.csv --out recording.svg")]
    Look(look::Look),
    /// Recorded logs → parameter table (table.toml, table.rs, table.bin) and report.html.
    #[command(after_help = "Examples:
  piezo identify tests/data/picma-p885-1hz.csv --out out/demo
  piezo identify tests/data/picma-p885-1hz.csv --model enhanced --out out/enhanced
  piezo identify tests/data/picma-p885-1hz.csv --out out/two-days \\
      --validate-on tests/data/picma-p885-session2.csv --adc-span -22:22 --dac-span -8:52
  piezo identify logs/SN042.csv --unit SN042 --if-changed --out fleet/SN042")]
    Identify(Box<identify::Identify>),
    /// Units of a fleet → one table of them all: what failed or is missing, and what is unlike the rest.
    #[command(after_help = "Examples:
  piezo collect fleet --csv fleet.csv
  piezo collect fleet/SN001 fleet/SN002")]
    Collect(collect::Collect),
    /// Table + logs → errors, f64 reference and f32 core side by side.
    #[command(after_help = "Example: piezo validate out/demo/table.toml other.csv --max-percent 2")]
    Validate(validate::Validate),
    /// Table + voltage alone → the displacement, with its ±, sample by sample.
    #[command(after_help = "Example: piezo estimate out/demo/table.toml voltage.csv --out estimates.csv")]
    Estimate(estimate::Estimate),
    /// Models × logs → what each model's estimate is off on data that none has seen, and what it costs.
    #[command(
        after_help = "Example: piezo compare tests/data/picma-p885-1hz.csv --models generalised-prandtl-ishlinskii,enhanced,voigt --out out/compare"
    )]
    Compare(Box<compare::Compare>),
    /// Table + wanted trajectory → the voltages that bring the actuator there, by the model's inverse.
    #[command(after_help = "Example: piezo feedforward out/demo/table.toml wanted.csv --slew 100 --out voltages.csv")]
    Feedforward(feedforward::Feedforward),
    /// The firmware on this machine, with an emulated amplifier, actuator and sensor: a board to try everything on.
    #[command(after_help = "Example: piezo emulate --device bouc-wen --seed 3")]
    Emulate(emulate::Emulate),
    /// An amplifier's monitor or input, or a sensor → the resistors between it and the board's pin, and what they cost.
    #[command(after_help = "Examples:
  piezo divider --monitor 0:10 --amplifier 0:100
  piezo divider --monitor -10:10
  piezo divider --sensor 0:10 --displacement 0:30 --series e24
  piezo divider --input 0:10 --amplifier 0:100")]
    Divider(divider::DividerArgs),
    /// Two readings of a multimeter → what the board's converters stand for, in board.toml.
    #[command(after_help = "Examples:
  piezo calibrate --board board.toml
  piezo calibrate --board board.toml --drive-to 10:90
  piezo calibrate --board board.toml --channel sensor --low 2.5 --high 22.5")]
    Calibrate(calibrate::Calibrate),
    /// train, identify, install and prove, one after the other.
    #[command(
        after_help = "Example: piezo learn --port tcp:127.0.0.1:4740 --board board.toml --range 0:100 --out p885"
    )]
    Learn(learn::Learn),
    /// A board beside a sensor → designed voltages out, logs to identify a table from in.
    #[command(
        after_help = "Example: piezo train --port tcp:127.0.0.1:4740 --board board.toml --range 0:100 --up-to 20 --minutes 2 --out p885"
    )]
    Train(train::Train),
    /// A table → the device, with the board's calibration, in use, and compared with the host bit for bit.
    #[command(after_help = "Examples:
  piezo install p885/model --board board.toml --port tcp:127.0.0.1:4740
  piezo install --line --board board.toml --rewired --port /dev/ttyACM0")]
    Install(install::Install),
    /// A random drive → the board's own estimate beside the sensor: pass or fail.
    #[command(after_help = "Example: piezo prove --board board.toml --port tcp:127.0.0.1:4740 --out p885/proof")]
    Prove(prove::Prove),
    /// Firmware and table → the board, by a debug probe (through probe-rs).
    #[command(
        after_help = "Example: piezo flash --image target/thumbv7em-none-eabihf/release/nucleo-g474re --table out/board/table.toml"
    )]
    Flash(flash::Flash),
    /// Who the device is, which table it runs, how it is, and what to do about it.
    #[command(after_help = "Example: piezo info --port /dev/ttyACM0")]
    Info(info::Info),
    /// Displacement, voltage and faults, live: in the terminal, in a browser, in another program that plots.
    #[command(after_help = "Examples:
  piezo monitor --port /dev/ttyACM0
  piezo monitor --web --board board.toml --port /dev/ttyACM0
  piezo monitor --udp 127.0.0.1:9870 --format plotjuggler --port /dev/ttyACM0")]
    Monitor(monitor::Monitor),
    /// Calls the displacement of now, or the mean over one cycle of the voltage, 0 or what it is known to be.
    #[command(after_help = "Examples:
  piezo zero --port /dev/ttyACM0
  piezo zero --at 12.5 --port /dev/ttyACM0
  piezo zero --over-cycle --at 12.5 --port /dev/ttyACM0")]
    Zero(zero::Zero),
    /// The device's voltage and estimate → a log.
    #[command(after_help = "Example: piezo record --out log.csv --seconds 10 --port /dev/ttyACM0")]
    Record(record::Record),
    /// A wanted trajectory → the device, whose DAC drives the amplifier there; its estimate on the way as a log.
    #[command(after_help = "Example: piezo follow wanted.csv --out followed.csv --port /dev/ttyACM0")]
    Follow(follow::Follow),
    /// Has the device follow a controller's set-point, by its ADC and without a host, or leave it.
    #[command(after_help = "Examples:
  piezo linearise --port /dev/ttyACM0
  piezo linearise --stop --port /dev/ttyACM0")]
    Linearise(linearise::Linearise),
    /// A line of wanted displacements → the device's memory, from which it plays it again and again, by itself or
    /// by a trigger.
    #[command(after_help = "Examples:
  piezo waveform line.csv --on-trigger --port /dev/ttyACM0
  piezo waveform --stop --port /dev/ttyACM0")]
    Waveform(waveform::Waveform),
    /// A table → its faces, with the calibration of your board.
    #[command(after_help = "Example: piezo emit out/demo/table.toml --adc-span -22:22 --out out/board")]
    Emit(emit::Emit),
    /// A table → the device's parameter store.
    #[command(after_help = "Example: piezo push out/board/table.toml --reset --port /dev/ttyACM0")]
    Push(push::Push),
    /// The table that the device runs → a file.
    #[command(after_help = "Example: piezo pull --out table.bin --port /dev/ttyACM0")]
    Pull(pull::Pull),
    /// Empties the device's parameter store; the table of its firmware image is used from the next reset on.
    #[command(after_help = "Example: piezo erase --reset --port /dev/ttyACM0")]
    Erase(erase::Erase),
    /// Logs through the device's tick, compared bit for bit with the host (processor in the loop).
    #[command(
        after_help = "Example: piezo pil out/board/table.toml tests/data/picma-p885-1hz.csv --port tcp:127.0.0.1:4740"
    )]
    Pil(pil::Pil),
    /// Restarts the device.
    #[command(after_help = "Example: piezo reset --port /dev/ttyACM0")]
    Reset(reset::Reset),
    /// The synthetic rig → the thesis's six logs as CSV.
    #[command(after_help = "Example: piezo simulate --out out/rig --noise-nm 20 --adc-bits 12")]
    Simulate(simulate::Simulate),
    /// The thesis's tables and figures beside ours, on the synthetic rig or on your own logs.
    #[command(
        after_help = "Examples: piezo reproduce --json; piezo reproduce all --out out/thesis; piezo reproduce loops features --logs a.csv b.csv --validate-on c.csv"
    )]
    Reproduce(Box<reproduce::Reproduce>),
    /// This program's verbs and options → what a shell completes them by, printed; where it belongs, your
    /// shell's manual says.
    #[command(after_help = "Example: piezo completions bash")]
    Completions(manual::Completions),
    /// This program's help → pages of the manual.
    #[command(after_help = "Example: piezo man --out man1")]
    Man(manual::Manual),
}

impl Cli {
    /// Runs the verb; whether it succeeded.
    fn run(self) -> anyhow::Result<bool> {
        match self.verb {
            Verb::Look(arguments) => look::run(&arguments),
            Verb::Identify(mut arguments) => identify::run(&mut arguments),
            Verb::Collect(arguments) => collect::run(&arguments),
            Verb::Validate(arguments) => validate::run(&arguments),
            Verb::Estimate(arguments) => estimate::run(&arguments),
            Verb::Compare(mut arguments) => compare::run(&mut arguments),
            Verb::Feedforward(arguments) => feedforward::run(&arguments),
            Verb::Emulate(arguments) => emulate::run(&arguments),
            Verb::Divider(arguments) => divider::run(&arguments),
            Verb::Calibrate(arguments) => calibrate::run(&arguments),
            Verb::Learn(arguments) => learn::run(&arguments),
            Verb::Train(arguments) => train::run(&arguments),
            Verb::Install(arguments) => install::run(&arguments),
            Verb::Prove(arguments) => prove::run(&arguments),
            Verb::Flash(arguments) => flash::run(&arguments),
            Verb::Info(arguments) => info::run(&arguments),
            Verb::Monitor(arguments) => monitor::run(&arguments),
            Verb::Zero(arguments) => zero::run(&arguments),
            Verb::Record(arguments) => record::run(&arguments),
            Verb::Follow(arguments) => follow::run(&arguments),
            Verb::Linearise(arguments) => linearise::run(&arguments),
            Verb::Waveform(arguments) => waveform::run(&arguments),
            Verb::Emit(arguments) => emit::run(&arguments),
            Verb::Push(arguments) => push::run(&arguments),
            Verb::Pull(arguments) => pull::run(&arguments),
            Verb::Erase(arguments) => erase::run(&arguments),
            Verb::Pil(arguments) => pil::run(&arguments),
            Verb::Reset(arguments) => reset::run(&arguments),
            Verb::Simulate(arguments) => simulate::run(&arguments),
            Verb::Reproduce(arguments) => reproduce::run(&arguments),
            Verb::Completions(arguments) => manual::completions(&arguments, Self::command()),
            Verb::Man(arguments) => manual::manual(&arguments, Self::command()),
        }
    }
}

/// What was typed, or what is wrong with it: with the verb's own usage, which asks for nothing that was given or that
/// the environment gives.
fn typed() -> Cli {
    Cli::try_parse().unwrap_or_else(|mut error| {
        let mut command = Cli::command();
        command.build();
        let verb = std::env::args_os().nth(1).unwrap_or_default();
        if error.get(ContextKind::Usage).is_some()
            && let Some(verb) = command.find_subcommand_mut(verb)
        {
            error.insert(ContextKind::Usage, ContextValue::StyledStr(verb.render_usage()));
        }
        error.exit()
    })
}

fn main() -> ExitCode {
    match typed().run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("piezo: {}", remedy::sentence(error.as_ref()));
            ExitCode::from(2)
        }
    }
}
