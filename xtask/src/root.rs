//! Commands that need root.

use anyhow::{Result, bail};
use xshell::{Shell, cmd};

/// Whether this process is root itself.
pub fn is_root(sh: &Shell) -> bool {
    cmd!(sh, "id -u").quiet().ignore_stderr().read().is_ok_and(|uid| uid == "0")
}

/// Runs commands as root: directly, or through sudo where that asks for no password.
///
/// # Errors
/// Without the right to, the error says what to type; otherwise the first failure of a command.
pub fn run(sh: &Shell, commands: &[Vec<&str>]) -> Result<()> {
    let become_root: &[&str] = if is_root(sh) { &[] } else { &["sudo", "-n"] };
    if !become_root.is_empty() && cmd!(sh, "sudo -n true").quiet().ignore_stdout().ignore_stderr().run().is_err() {
        let typed: Vec<String> = commands.iter().map(|command| format!("    sudo {}", command.join(" "))).collect();
        bail!("this needs root; run\n\n{}\n\nand then `cargo xtask setup` again", typed.join("\n"));
    }
    for command in commands {
        // `env` without a variable: xshell wants the program's name spelt out.
        cmd!(sh, "env {become_root...} {command...}").run()?;
    }
    Ok(())
}

/// Installs Debian packages.
///
/// # Errors
/// See [`run`].
pub fn apt_install(sh: &Shell, packages: &[&str]) -> Result<()> {
    let apt = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "-q", "-o=DPkg::Lock::Timeout=600"];
    let install = [&apt[..], &["install", "-y", "--no-install-recommends"], packages].concat();
    run(sh, &[[&apt[..], &["update"]].concat(), install])
}
