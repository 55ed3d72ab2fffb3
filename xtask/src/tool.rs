//! What the checks need beyond cargo, and how it gets there.

use std::{
    env,
    path::{Path, PathBuf},
};

use anyhow::{Context, Result, bail, ensure};
use xshell::{Shell, cmd};

use crate::{embedded, root};

/// Something a check needs that cargo does not bring.
pub struct Tool {
    /// What it is called where tools are listed.
    pub name: &'static str,
    /// Says what is there, or what is missing.
    find: fn(&Shell) -> Result<String>,
    source: Source,
}

enum Source {
    /// Steps of its own.
    Steps(fn(&Shell) -> Result<()>),
    /// A Debian package; elsewhere, what to do. Nothing is installed where the variable that names another
    /// place is set.
    Package { debian: &'static str, elsewhere: &'static str, variable: Option<&'static str> },
}

const CHROME: &str = "CHROME";
const LIBCLANG_PATH: &str = "LIBCLANG_PATH";

/// A compiler for the microcontroller.
pub const EMBEDDED: Tool = Tool { name: "embedded", find: embedded::describe, source: Source::Steps(embedded::setup) };
/// The emulator of a Cortex-M machine.
pub const QEMU: Tool = Tool {
    name: "qemu",
    find: |_| program("qemu-system-arm"),
    source: Source::Package {
        debian: "qemu-system-arm",
        elsewhere: "install QEMU with qemu-system-arm (Homebrew: `brew install qemu`)",
        variable: None,
    },
};
/// What counts instructions of the host's programs.
pub const VALGRIND: Tool = Tool {
    name: "valgrind",
    find: |_| program("valgrind"),
    source: Source::Package {
        debian: "valgrind",
        elsewhere: "install Valgrind 3.19 or newer; there is none for macOS on Arm, where only --skip kernels helps",
        variable: None,
    },
};
/// A compiler of C for the microcontroller.
pub const ARM_GCC: Tool = Tool {
    name: "arm-gcc",
    find: |_| program("arm-none-eabi-gcc"),
    source: Source::Package {
        debian: "gcc-arm-none-eabi",
        elsewhere: "install Arm's GNU toolchain with arm-none-eabi-gcc (Homebrew: `brew install --cask gcc-arm-embedded`)",
        variable: None,
    },
};
/// A browser that runs without a screen.
pub const CHROMIUM: Tool = Tool {
    name: "chromium",
    find: |_| chromium().map(|path| path.display().to_string()),
    source: Source::Package {
        debian: "chromium",
        elsewhere: "install Chromium or Chrome, or set $CHROME to the path of one",
        variable: Some(CHROME),
    },
};
/// The first of four that compile the CPU emulator of the board's test, which is written in C.
pub const CMAKE: Tool = Tool {
    name: "cmake",
    find: |_| program("cmake"),
    source: Source::Package { debian: "cmake", elsewhere: "install CMake", variable: None },
};
/// Another of the four that [`CMAKE`] begins.
pub const MAKE: Tool = Tool {
    name: "make",
    find: |_| program("make"),
    source: Source::Package { debian: "make", elsewhere: "install make", variable: None },
};
/// Another of the four that [`CMAKE`] begins.
pub const PKG_CONFIG: Tool = Tool {
    name: "pkg-config",
    find: |_| program("pkg-config"),
    source: Source::Package { debian: "pkg-config", elsewhere: "install pkg-config or pkgconf", variable: None },
};
/// Another of the four that [`CMAKE`] begins.
pub const LIBCLANG: Tool = Tool {
    name: "libclang",
    find: |_| libclang(),
    source: Source::Package {
        debian: "libclang-dev",
        elsewhere: "install Clang's library, or set $LIBCLANG_PATH to the folder it is in",
        variable: Some(LIBCLANG_PATH),
    },
};

/// Python, with what makes environments of it.
pub const PYTHON: Tool = Tool {
    name: "python",
    find: python,
    source: Source::Package {
        debian: "python3-venv",
        elsewhere: "install Python 3.11 or newer as python3, with its modules venv and ensurepip",
        variable: None,
    },
};

/// Gets those of the tools that are missing, and says of each what there is.
///
/// # Errors
/// Some tool could not be had; the others have been seen to, and each has said why.
pub fn setup(sh: &Shell, tools: &[&Tool]) -> Result<()> {
    let missing: Vec<&Tool> = tools.iter().copied().filter(|tool| (tool.find)(sh).is_err()).collect();
    let packages: Vec<&str> = missing.iter().filter_map(|tool| tool.source.package()).collect();
    if !packages.is_empty()
        && which::which("apt-get").is_ok()
        && let Err(error) = root::apt_install(sh, &packages)
    {
        println!("{error:#}");
    }
    let mut ready = true;
    for tool in tools {
        if let Source::Steps(steps) = tool.source
            && (tool.find)(sh).is_err()
            && let Err(error) = steps(sh)
        {
            println!("{error:#}");
        }
        match (tool.find)(sh) {
            Ok(found) => println!("{}: {found}", tool.name),
            Err(error) => {
                ready = false;
                println!("{}: {error:#}{}", tool.name, tool.source.remedy());
            }
        }
    }
    ensure!(ready, "this machine is not ready yet; see above");
    Ok(())
}

/// Sees to it that the tools are there before a check: gets them where nobody could be asked, on CI and as root.
///
/// # Errors
/// A tool is missing and may not or cannot be installed.
pub fn require(sh: &Shell, tools: &[&Tool]) -> Result<()> {
    let Some(missing) = tools.iter().find_map(|tool| (tool.find)(sh).err()) else {
        return Ok(());
    };
    if root::is_root(sh) || env::var_os("CI").is_some_and(|ci| ci == "true") {
        println!("{missing}: installing");
        setup(sh, tools)
    } else {
        bail!("{missing}; run `cargo xtask setup`")
    }
}

impl Source {
    fn package(&self) -> Option<&'static str> {
        match self {
            Self::Steps(_) => None,
            Self::Package { variable: Some(variable), .. } if env::var_os(variable).is_some() => None,
            Self::Package { debian, .. } => Some(debian),
        }
    }

    fn remedy(&self) -> String {
        match self {
            Self::Steps(_) => String::new(),
            Self::Package { elsewhere, .. } => format!("; {elsewhere}"),
        }
    }
}

fn program(name: &str) -> Result<String> {
    let path = which::which(name).with_context(|| format!("no {name} on PATH"))?;
    Ok(path.display().to_string())
}

/// A Python that the pinned packages run on, and that makes environments.
fn python(sh: &Shell) -> Result<String> {
    const ASKED: &str =
        "import ensurepip, sys, venv; assert sys.version_info >= (3, 11), sys.version; print(sys.executable)";
    let path = which::which("python3").context("no python3 on PATH")?;
    let found = cmd!(sh, "{path} -c {ASKED}").quiet().ignore_stderr().read();
    found.with_context(|| format!("{} is older than 3.11, or has no module venv or ensurepip", path.display()))
}

/// The browser's path: `$CHROME`, or the first of the usual names on `PATH`.
///
/// # Errors
/// No browser found, or `$CHROME` names none.
pub fn chromium() -> Result<PathBuf> {
    const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
    if let Some(chrome) = env::var_os(CHROME) {
        return which::which(&chrome)
            .with_context(|| format!("$CHROME is {}: not a program; correct or unset it", chrome.display()));
    }
    NAMES
        .iter()
        .find_map(|name| which::which(name).ok())
        .with_context(|| format!("none of {} on PATH, and $CHROME is not set", NAMES.join(", ")))
}

/// Clang's library, by the name that only its development package installs: bindgen needs the headers as well.
fn libclang() -> Result<String> {
    const PLACES: [&str; 3] = ["/usr/lib*/libclang.so", "/usr/lib/llvm*/lib/libclang.so", "/usr/local/lib/libclang.so"];
    if let Some(folder) = env::var_os(LIBCLANG_PATH) {
        ensure!(Path::new(&folder).is_dir(), "$LIBCLANG_PATH is {}: no folder", folder.display());
        return Ok(folder.display().to_string());
    }
    let found = PLACES.iter().flat_map(|pattern| glob::glob(pattern)).flatten().find_map(Result::ok);
    Ok(found.with_context(|| format!("none of {} exists", PLACES.join(", ")))?.display().to_string())
}
