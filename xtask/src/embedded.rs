//! A compiler for the microcontroller: any rustc that has `core` for [`TARGET`].
//!
//! Ordinarily rustup fetches that. Where it cannot, Debian's rustc comes with its own sources, so that `core` can be
//! compiled for the target with the very compiler that will use it: no unstable option afterwards, unlike `build-std`.

use std::{
    env,
    fs::{self, File},
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use fs4::FileExt;
use tempfile::{NamedTempFile, TempDir};
use xshell::{Cmd, Shell, cmd};

use crate::{artifact, root};

/// Cortex-M4F, hard float.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// The name by which rustup knows Debian's compiler once [`setup`] has linked it.
const LINKED: &str = "+debian";
/// The environment variable that chooses the firmware's rate.
pub const TICK_HZ: &str = "TICK_HZ";
const RUSTC: &str = "/usr/bin/rustc";
const PACKAGES: [&str; 4] = ["rustc-web", "cargo-web", "rust-web-src", "rust-web-llvm"];

/// The cargo that can build for [`TARGET`]: the one in use, or Debian's, with a target directory of its own so that the
/// two compilers do not discard each other's work.
///
/// # Errors
/// Neither has `core` for the target.
pub fn cargo(sh: &Shell) -> Result<Cmd<'_>> {
    if has_core(cmd!(sh, "rustc"))? {
        Ok(cmd!(sh, "cargo"))
    } else if which::which("rustup").is_ok() && has_core(clean(cmd!(sh, "rustc {LINKED}")))? {
        let target_dir = target_dir(sh).join("debian");
        Ok(clean(cmd!(sh, "cargo {LINKED}")).env("CARGO_TARGET_DIR", target_dir))
    } else {
        bail!("no compiler here has core for {TARGET}");
    }
}

/// A board the firmware runs on; its name is also that of the binary and of the feature.
#[derive(Clone, Copy)]
pub enum Board {
    /// The board itself: ST's NUCLEO-G474RE.
    NucleoG474re,
    /// Arm's AN386 image of the MPS2, as QEMU emulates it.
    Mps2An386,
}

impl Board {
    /// Both boards that there are images for.
    pub const ALL: [Self; 2] = [Self::NucleoG474re, Self::Mps2An386];

    fn name(self) -> &'static str {
        match self {
            Self::NucleoG474re => "nucleo-g474re",
            Self::Mps2An386 => "mps2-an386",
        }
    }

    /// What makes cargo build for this board and for no other.
    pub fn arguments(self) -> [&'static str; 5] {
        ["--no-default-features", "--features", self.name(), "--bin", self.name()]
    }
}

/// The firmware's rate where nothing chooses another, Hz.
const USUAL_HZ: &str = "2000";

/// Builds the firmware for a board, at 2 kHz; returns the image's path.
///
/// # Errors
/// It does not build, here and below.
pub fn image(sh: &Shell, board: Board) -> Result<PathBuf> {
    build(sh, board, USUAL_HZ)
}

/// The same at the rate that the environment chooses.
pub fn image_as_chosen(sh: &Shell, board: Board) -> Result<PathBuf> {
    build(sh, board, &env::var(TICK_HZ).unwrap_or_else(|_| USUAL_HZ.to_owned()))
}

/// Builds the firmware for the board itself at another rate; returns the image's path.
pub fn image_at(sh: &Shell, hz: u32) -> Result<PathBuf> {
    build(sh, Board::NucleoG474re, &hz.to_string())
}

/// Builds an image and puts it aside under a name of its own: checks that run beside this one build for other rates,
/// and cargo links each image to the same path.
fn build(sh: &Shell, board: Board, hz: &str) -> Result<PathBuf> {
    let cargo = cargo(sh)?.arg("fw").args(board.arguments());
    let lock = File::create(target_dir(sh).join("firmware-image.lock"))?;
    FileExt::lock(&lock)?;
    let built =
        artifact::build(if hz == USUAL_HZ { cargo.env_remove(TICK_HZ) } else { cargo.env(TICK_HZ, hz) }, board.name())?;
    let aside = built.with_file_name(format!("{}-{hz}", board.name()));
    // Another check may be reading it.
    let copy = NamedTempFile::new_in(built.parent().unwrap_or(Path::new(".")))?;
    fs::copy(&built, copy.path())?;
    copy.persist(&aside)?;
    Ok(aside)
}

/// Makes [`cargo`] succeed.
///
/// # Errors
/// Whatever the last resort, Debian's packages, failed on.
pub fn setup(sh: &Shell) -> Result<()> {
    if cargo(sh).is_err() && !rustup_add(sh) {
        println!("embedded: no rustup here fetches {TARGET}; taking Debian's compiler");
        debian(sh)?;
    }
    Ok(())
}

/// Which [`cargo`] it is.
///
/// # Errors
/// See [`cargo`].
pub fn describe(sh: &Shell) -> Result<String> {
    let version = cargo(sh)?.arg("--version").quiet().read()?;
    Ok(format!("{version} builds for {TARGET}"))
}

fn rustup_add(sh: &Shell) -> bool {
    which::which("rustup").is_ok() && cmd!(sh, "rustup target add {TARGET}").env("RUST_BACKTRACE", "0").run().is_ok()
}

fn debian(sh: &Shell) -> Result<()> {
    ensure!(
        which::which("apt-get").is_ok(),
        "this is no Debian; make `rustup target add {TARGET}` work, or install core for {TARGET} some other way"
    );
    if cmd!(sh, "dpkg --status {PACKAGES...}").quiet().ignore_stdout().ignore_stderr().run().is_err() {
        root::apt_install(sh, &PACKAGES)?;
    }
    if !has_core(clean(cmd!(sh, "{RUSTC}")))? {
        compile_core(sh)?;
    }
    if which::which("rustup").is_ok() {
        cmd!(sh, "rustup toolchain link debian /usr").run()?;
    }
    Ok(())
}

/// Compiles core, alloc and `compiler_builtins` into the sysroot of Debian's rustc.
fn compile_core(sh: &Shell) -> Result<()> {
    let sysroot = PathBuf::from(clean(cmd!(sh, "{RUSTC} --print sysroot")).quiet().read()?);
    let built = target_dir(sh).join("debian-core");
    {
        // Away from this repository, whose cargo settings are not meant for the compiler's library.
        let _library = sh.push_dir(sysroot.join("lib/rustlib/src/rust/library"));
        clean(cmd!(sh, "/usr/bin/cargo build --release --locked --target {TARGET} --manifest-path alloc/Cargo.toml"))
            .args(["--package=core", "--package=alloc", "--package=compiler_builtins"])
            .args(["--features", "compiler-builtins-mem"])
            .env("RUSTC", RUSTC)
            // The library is written in unstable Rust; its users are not.
            .env("RUSTC_BOOTSTRAP", "1")
            .env("RUSTFLAGS", "-Cembed-bitcode=yes -Zforce-unstable-if-unmarked")
            .env("CARGO_PROFILE_RELEASE_DEBUG", "0")
            .env("CARGO_PROFILE_RELEASE_PANIC", "abort")
            .env("CARGO_TARGET_DIR", &built)
            .run()?;
    }
    let mut install = vec!["install", "-D", "-m", "644", "-t"];
    let destination = sysroot.join("lib/rustlib").join(TARGET).join("lib");
    let libraries: Vec<PathBuf> = sh
        .read_dir(built.join(TARGET).join("release/deps"))?
        .into_iter()
        .filter(|file| file.extension().is_some_and(|extension| extension == "rlib"))
        .collect();
    for path in [&destination].into_iter().chain(&libraries) {
        install.push(path.to_str().with_context(|| format!("{}: not UTF-8", path.display()))?);
    }
    root::run(sh, &[install])?;
    Ok(sh.remove_path(built)?)
}

/// Whether this rustc can compile the least program for the target. A file found in its sysroot would prove less: it
/// may be an earlier compiler's.
fn has_core(rustc: Cmd<'_>) -> Result<bool> {
    let scratch = TempDir::new()?;
    Ok(rustc
        .args(["--target", TARGET, "--crate-type=rlib", "--emit=metadata", "--out-dir"])
        .arg(scratch.path())
        .arg("-")
        .stdin("#![no_std]")
        .quiet()
        .ignore_stdout()
        .ignore_stderr()
        .run()
        .is_ok())
}

/// Takes out of a command's environment what the cargo that runs this program put in for its own compiler.
fn clean(command: Cmd<'_>) -> Cmd<'_> {
    ["RUSTUP_TOOLCHAIN", "RUSTC", "CARGO", "LD_LIBRARY_PATH"].into_iter().fold(command, Cmd::env_remove)
}

fn target_dir(sh: &Shell) -> PathBuf {
    sh.current_dir().join(env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}
