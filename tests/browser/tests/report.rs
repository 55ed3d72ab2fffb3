//! The report of a short identification, in a browser.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};
use report_browser_test::{Viewport, inspect, launch};

const PHONE: Viewport = Viewport { width: 360, height: 740, scale: 2.0, mobile: true, least_text: 9.0 };
const DESKTOP: Viewport = Viewport { width: 1280, height: 900, scale: 1.0, mobile: false, least_text: 9.0 };

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn identify(out: &Path) -> Result<PathBuf> {
    let piezo =
        env::var_os("PIEZO").context("$PIEZO names no program: run this test with `cargo xtask test browser`")?;
    let status = Command::new(piezo)
        .current_dir(root())
        .args([
            "identify",
            "tests/data/picma-p885-1hz.csv",
            "--generations",
            "20",
            "--rounds",
            "1",
            "--evaluations",
            "50",
            "--devices",
            "0",
            "--out",
        ])
        .arg(out)
        .status()?;
    ensure!(status.success(), "piezo identify failed: {status}");
    Ok(out.join("report.html"))
}

#[test]
fn report_is_sound_on_a_phone_and_on_a_desktop() -> Result<()> {
    let out = tempfile::tempdir()?;
    let report = identify(out.path())?;
    let screenshots = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("report-screenshots");
    fs::create_dir_all(&screenshots)?;
    let mut browser = launch()?;
    let mut faults = Vec::new();
    for (name, viewport) in [("phone", PHONE), ("desktop", DESKTOP)] {
        let (mut page, found) = inspect(&mut browser, &format!("file://{}", report.display()), viewport)?;
        faults.extend(found.into_iter().map(|fault| format!("{name}: {fault}")));
        let image = screenshots.join(name).with_extension("png");
        fs::write(&image, page.screenshot()?)?;
        println!("to look at: {}", image.display());
        let pdf = page.pdf()?;
        if !pdf.starts_with(b"%PDF-") || pdf.len() <= 10_000 {
            faults.push(format!("{name}: prints as {} bytes, which is no report", pdf.len()));
        }
    }
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    Ok(())
}
