//! A debug probe, through the command-line program of probe-rs (options as of its version 0.31).
//!
//! It is started and not linked: whoever has a probe has that program, and who has none need not build it.

use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

/// The program that speaks to the debug probe.
const PROGRAM: &str = "probe-rs";

/// Why the program did not do it.
#[derive(Debug, thiserror::Error)]
pub enum ProbeError {
    /// It is not there.
    #[error("probe-rs, which writes the flash, is not installed (not on PATH)")]
    NotInstalled(#[from] which::Error),
    /// It does not start.
    #[error("probe-rs cannot be started")]
    NotStarted(#[from] std::io::Error),
    /// It failed, having said why.
    #[error(
        "probe-rs failed ({status}): {command}\nCheck that the board is powered and its debug USB plugged in (`probe-rs list` \
         shows the probe), that no other debugger holds it, and, on Linux, that the udev rules of \
         https://probe.rs/docs/getting-started/probe-setup are installed"
    )]
    Failed {
        /// How it ended.
        status: ExitStatus,
        /// The command as it would be typed.
        command: String,
    },
}

/// Which probe, and which chip behind it.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The chip, as probe-rs names it.
    pub chip: String,
    /// `VID:PID` or `VID:PID:SERIAL`, where there are several probes.
    pub selector: Option<String>,
}

impl Probe {
    /// The arguments that write a firmware image.
    pub fn image(&self, image: &Path) -> Vec<OsString> {
        self.arguments("download", [OsString::from("--verify"), image.into()])
    }

    /// The arguments that write bytes at an address.
    pub fn bytes(&self, file: &Path, address: u32) -> Vec<OsString> {
        let address = format!("0x{address:08x}");
        let how = ["--verify", "--binary-format", "bin", "--base-address", &address].map(OsString::from);
        self.arguments("download", how.into_iter().chain([file.into()]))
    }

    /// The arguments that restart the chip.
    pub fn reset(&self) -> Vec<OsString> {
        self.arguments("reset", [])
    }

    fn arguments(&self, verb: &str, more: impl IntoIterator<Item = OsString>) -> Vec<OsString> {
        let mut arguments = vec![verb, "--non-interactive", "--chip", &self.chip];
        if let Some(selector) = &self.selector {
            arguments.extend(["--probe", selector]);
        }
        arguments.into_iter().map(OsString::from).chain(more).collect()
    }
}

/// The whole command, for people to read or repeat.
pub fn line(arguments: &[OsString]) -> String {
    let quoted = |argument: &OsString| {
        let text = argument.to_string_lossy();
        if text.contains(|c: char| c.is_whitespace() || "'\"\\$&;()*?<>|".contains(c)) {
            format!("'{}'", text.replace('\'', r"'\''"))
        } else {
            text.into_owned()
        }
    };
    let words = arguments.iter().map(quoted);
    std::iter::once(PROGRAM.to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// Whether the program is there.
///
/// # Errors
/// It is not; the message says where to get it.
pub fn installed() -> Result<(), ProbeError> {
    which::which(PROGRAM)?;
    Ok(())
}

/// Runs the program; what it says goes to standard error.
///
/// # Errors
/// It cannot be started or fails, having said why.
pub fn run(arguments: &[OsString]) -> Result<(), ProbeError> {
    let status = Command::new(PROGRAM).args(arguments).stdout(Stdio::from(std::io::stderr())).status()?;
    if status.success() { Ok(()) } else { Err(ProbeError::Failed { status, command: line(arguments) }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_read_as_they_are_typed() {
        let probe = Probe { chip: "STM32G474RETx".to_owned(), selector: Some("0483:374e".to_owned()) };
        assert_eq!(
            line(&probe.bytes(Path::new("my pages.bin"), 0x0807_f000)),
            "probe-rs download --non-interactive --chip STM32G474RETx --probe 0483:374e --verify --binary-format bin \
             --base-address 0x0807f000 'my pages.bin'"
        );
        let probe = Probe { selector: None, ..probe };
        assert_eq!(line(&probe.reset()), "probe-rs reset --non-interactive --chip STM32G474RETx");
    }
}
