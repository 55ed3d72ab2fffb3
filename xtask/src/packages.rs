//! Which packages cargo is asked for, and with which features, so that each of them is built once.

/// What is checked on the host. The emulated board has a step of its own: it needs a compiler that not everybody has.
/// Without default features, the firmware has no board, and is checked with the rest. Always the whole workspace: with
/// another selection, cargo would choose other features of the same foreign crates, and build them once more.
pub const HOST: [&str; 4] = ["--workspace", "--exclude", "board-emulator-test", "--no-default-features"];

/// The core with its other arithmetic: only the core has code of that feature, the others hand it on. It is selected
/// beside two programs, of which nothing is built, since they have no library: cargo then chooses the same features of
/// foreign crates as for the whole workspace, and finds them built.
pub const MICROMATH: [&str; 5] = [
    "--package=estimator-core",
    "--package=piezo",
    "--package=xtask",
    "--features",
    "estimator-core/micromath,xtask/beside-the-workspace",
];
/// The emulated board, selected like [`MICROMATH`].
pub const BOARD: [&str; 5] =
    ["--package=board-emulator-test", "--package=piezo", "--package=xtask", "--features", "xtask/beside-the-workspace"];
