//! Linker arguments of the binaries, the memory map of the chosen board, and the commit that the image is built from.

use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

fn main() {
    println!("cargo:rustc-env=GIT_COMMIT={}", commit());
    let board = match (env::var_os("CARGO_FEATURE_NUCLEO_G474RE"), env::var_os("CARGO_FEATURE_MPS2_AN386")) {
        (Some(_), None) => "NUCLEO_G474RE",
        (None, Some(_)) => "MPS2_AN386",
        (None, None) => return,
        (Some(_), Some(_)) => panic!("choose one board: --no-default-features --features mps2-an386"),
    };
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let aliases: String = ["FLASH", "STACK", "RAM", "WAVEFORM", "PARAMETERS"]
        .map(|region| format!("REGION_ALIAS({region}, {board}_{region});\n"))
        .concat();
    fs::write(out.join("board.x"), aliases).expect("OUT_DIR can be written");
    // A device crate of the emulated board would have this; its vectors stand in the board's own file.
    if board == "MPS2_AN386" {
        fs::write(out.join("device.x"), "").expect("OUT_DIR can be written");
    }
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed=../memory.x");
    for argument in ["--nmagic", "-Tlink.x", "-Tdefmt.x"] {
        println!("cargo:rustc-link-arg-bins={argument}");
    }
}

/// The commit, marked when the sources differ from it; "unknown" away from a repository.
fn commit() -> String {
    // Whatever the image is made of decides whether it is the commit's.
    for package in ["estimator-core", "firmware", "parameter-store", "protocol"] {
        println!("cargo:rerun-if-changed=../{package}/src");
        println!("cargo:rerun-if-changed=../{package}/Cargo.toml");
    }
    for path in ["Cargo.lock", "Cargo.toml", ".cargo/config.toml", "firmware/build.rs"] {
        println!("cargo:rerun-if-changed=../{path}");
    }
    // Git knows where they are; a file that is not there would have cargo build the package anew each time.
    for path in git(&["rev-parse", "--git-path", "HEAD", "--git-path", "index"]).unwrap_or_default().lines() {
        println!("cargo:rerun-if-changed={path}");
    }
    git(&["describe", "--always", "--dirty", "--abbrev=10"]).unwrap_or_else(|| "unknown".to_owned())
}

/// What git prints, if it is there and this is a repository.
fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    Some(String::from_utf8(output.stdout).ok()?.trim().to_owned())
}
