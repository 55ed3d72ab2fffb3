//! The emulated board: Arm's AN386 image of the MPS2 in QEMU, with the firmware's UART on a socket of this machine.

use std::{
    io::{Read, Write},
    net::{Ipv4Addr, TcpListener},
    path::Path,
    process::{Child, Command, Stdio},
};

use anyhow::{Context, Result, ensure};

/// What to say where QEMU does not start.
pub const NO_QEMU: &str = "qemu-system-arm does not start; run `cargo xtask setup`";

/// QEMU with an image in it; `serial` says, in QEMU's words, where its UART is found.
pub fn command(image: &Path, serial: &str) -> Command {
    let mut command = Command::new("qemu-system-arm");
    command
        .args(["-M", "mps2-an386", "-cpu", "cortex-m4", "-nographic"])
        // Time goes by instructions, 64 ns each, so that a busy machine makes no tick late.
        .args(["-icount", "shift=6,sleep=on", "-serial", serial, "-kernel"])
        .arg(image);
    command
}

/// The UART as a socket that nobody but this machine reaches.
pub fn socket(port: u16) -> String {
    format!("tcp:127.0.0.1:{port},server=on,wait=off,nodelay=on")
}

/// This port, or any for 0, if nobody else listens on it.
///
/// # Errors
/// Somebody does.
pub fn free_port(port: u16) -> Result<u16> {
    let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
        .with_context(|| format!("port {port} is taken; choose another with --port"))?;
    Ok(listener.local_addr()?.port())
}

/// QEMU running beside this program; it ends with this value.
pub struct Qemu(Child);

impl Qemu {
    /// Starts QEMU and waits until its UART can be reached.
    ///
    /// # Errors
    /// There is no QEMU, or it refuses; it has then said why.
    pub fn start(command: &mut Command) -> Result<Self> {
        let child = command.args(["-monitor", "stdio"]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let mut qemu = Self(child.context(NO_QEMU)?);
        // The first prompt comes while QEMU still opens its devices. An order is taken when all of them are ready, and
        // the next prompt follows it.
        qemu.order("info chardev")?;
        let output = qemu.0.stdout.as_mut().context("QEMU's monitor has no output")?;
        let prompt = b"\n(qemu)";
        for _ in ["at its start", "after the order"] {
            let mut said = Vec::new();
            while !said.ends_with(prompt) {
                let mut byte = [0];
                output.read_exact(&mut byte).context("QEMU ended at once")?;
                said.extend(byte);
            }
        }
        Ok(qemu)
    }

    /// Has QEMU end by itself, as it must for its plugins to have their say.
    ///
    /// # Errors
    /// It had ended already, or fails.
    pub fn quit(mut self) -> Result<()> {
        self.order("quit")?;
        let status = self.0.wait()?;
        ensure!(status.success(), "QEMU: {status}");
        Ok(())
    }

    /// Types an order into QEMU's monitor.
    fn order(&mut self, order: &str) -> Result<()> {
        let monitor = self.0.stdin.as_mut().context("QEMU's monitor has no input")?;
        writeln!(monitor, "{order}").context("QEMU has ended before its time")
    }
}

impl Drop for Qemu {
    fn drop(&mut self) {
        // Where it has ended already, there is nothing left to do.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
