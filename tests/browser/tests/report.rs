//! The report of a short identification, and the page of a short comparison, in a browser.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use anyhow::{Context, Result, ensure};
use report_browser_test::{Browser, Page, Viewport, inspect, launch};

const PHONE: Viewport = Viewport { width: 360, height: 740, scale: 2.0, mobile: true, least_text: 9.0 };
const DESKTOP: Viewport = Viewport { width: 1280, height: 900, scale: 1.0, mobile: false, least_text: 9.0 };
const WIDE: Viewport = Viewport { width: 1920, height: 1080, scale: 1.0, mobile: false, least_text: 9.0 };
/// Pictures of a report, and the plots of its whole log.
const PICTURES: usize = 8;
const OF_WHOLE_LOG: usize = 3;
/// A drag over a picture's middle, as a mouse makes it.
const DRAG: &str = "(() => {
    const over = document.querySelector('#zoom-error .u-over'), { left, top, width } = over.getBoundingClientRect();
    for (const [type, part, on] of [['mousedown', 0.4, over], ['mousemove', 0.6, over], ['mouseup', 0.6, document]]) {
        on.dispatchEvent(new MouseEvent(type, { bubbles: true, clientX: left + part * width, clientY: top + 20, movementX: 9 }));
    }
})()";
/// Clicks on one of the buttons below the list of logs.
const CLICK: fn(&str) -> String = |button| format!("document.getElementById('zoom-{button}').click()");
/// What the canvas of the error shows, in short.
const DRAWN: &str = "document.querySelector('#zoom-error canvas').toDataURL()";

/// The repository's root.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Has `piezo` make pages of the measured log.
fn piezo(verb: &str, options: &str, out: &Path) -> Result<()> {
    let piezo =
        env::var_os("PIEZO").context("$PIEZO names no program: run this test with `cargo xtask test browser`")?;
    let mut command = Command::new(piezo);
    command.current_dir(root()).args([verb, "tests/data/picma-p885-1hz.csv"]).args(options.split(' '));
    let status = command.arg("--out").arg(out).status()?;
    ensure!(status.success(), "piezo {verb} failed: {status}");
    Ok(())
}

/// What is wrong with a page of so many plots at each width; its screenshots are kept to be looked at, under names
/// that begin so.
fn faults(browser: &mut Browser, page: &Path, plots: usize, named: &str) -> Result<Vec<String>> {
    let screenshots = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("report-screenshots");
    fs::create_dir_all(&screenshots)?;
    let mut faults = Vec::new();
    for (width, viewport) in [("phone", PHONE), ("desktop", DESKTOP), ("wide", WIDE)] {
        let name = format!("{named}{width}");
        let (mut page, found) = inspect(browser, &format!("file://{}", page.display()), viewport, plots)?;
        faults.extend(found.into_iter().map(|fault| format!("{name}: {fault}")));
        let image = screenshots.join(&name).with_extension("png");
        fs::write(&image, page.screenshot()?)?;
        println!("to look at: {}", image.display());
        let pdf = page.pdf()?;
        if !pdf.starts_with(b"%PDF-") || pdf.len() <= 10_000 {
            faults.push(format!("{name}: prints as {} bytes, which is no report", pdf.len()));
        }
    }
    Ok(faults)
}

#[test]
fn report_is_sound_on_a_phone_and_on_a_desktop() -> Result<()> {
    let out = tempfile::tempdir()?;
    piezo("identify", "--generations 20 --rounds 1 --evaluations 50 --devices 0", out.path())?;
    let report = out.path().join("report.html");
    let mut browser = launch()?;
    let faults = faults(&mut browser, &report, PICTURES + OF_WHOLE_LOG, "")?;
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    zooms(&mut browser, &report)?;
    reads_without_scripts(&mut browser, &report)
}

#[test]
fn comparison_is_sound_on_a_phone_and_on_a_desktop() -> Result<()> {
    let out = tempfile::tempdir()?;
    piezo("compare", "--budget 12", out.path())?;
    let faults = faults(&mut launch()?, &out.path().join("compare.html"), 0, "compare-")?;
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    Ok(())
}

/// The whole log is drawn of what is in its link, and what of it is shown follows mouse and buttons.
fn zooms(browser: &mut Browser, report: &Path) -> Result<()> {
    let mut page = Page::open(browser, &format!("file://{}", report.display()), DESKTOP)?;
    let mut holds = |what: &str| -> Result<()> {
        let true_ = page.evaluate(&format!("Boolean({what})"))?;
        ensure!(true_ == true, "{what} is not so: {}", page.evaluate("JSON.stringify(window.zoom)")?);
        Ok(())
    };
    holds(
        "window.zoom.rows > 1000 && window.zoom.view[0] === window.zoom.whole[0] && window.zoom.view[1] === window.zoom.whole[1]",
    )?;
    holds(
        "document.getElementById('zoom-rows').textContent.includes(`of the log's ${document.querySelector('a[data-log]').dataset.of} rows`)",
    )?;
    holds(
        "(async () => { const link = document.querySelector('a[data-log]'); const lines = (await (await fetch(link.href)).text()).trim().split('\\n'); return lines[0] === 'time_s,voltage_v,sensor_um,estimate_um' && lines.length - 1 === Number(link.dataset.rows); })()",
    )?;
    holds(&format!("(window.before = {DRAWN}, true)"))?;
    let share = "((window.zoom.view[1] - window.zoom.view[0]) / (window.zoom.whole[1] - window.zoom.whole[0]))";
    holds(&format!("({DRAG}, Math.abs({share} - 0.2) < 0.01)"))?;
    // It draws at the browser's next turn.
    holds(&format!("new Promise((drawn) => requestAnimationFrame(() => drawn({DRAWN} !== window.before)))"))?;
    holds(&format!("(window.from = window.zoom.view[0], {}, window.zoom.view[0] > window.from)", CLICK("after")))?;
    holds(&format!("({}, Math.abs({share} - 0.1) < 0.01)", CLICK("closer")))?;
    holds(&format!("({}, {share} === 1)", CLICK("whole")))?;
    holds(&format!("({}, {share} === 1)", CLICK("wider")))?;
    // Another log of the list.
    holds(
        "((list) => { const before = window.zoom.log; list.selectedIndex = 1; list.dispatchEvent(new Event('change')); return list.length > 1 && window.zoom.log !== before && window.zoom.view[0] === window.zoom.whole[0] && window.zoom.view[1] === window.zoom.whole[1]; })(document.getElementById('zoom-log'))",
    )?;
    let troubles = page.troubles()?;
    // The link's own address is what was fetched.
    ensure!(troubles.is_empty(), "{}", troubles.join("\n"));
    Ok(())
}

/// What a browser shows that runs no script: every picture, where the numbers are, and no empty place.
fn reads_without_scripts(browser: &mut Browser, report: &Path) -> Result<()> {
    let mut page = Page::open(browser, &format!("file://{}", report.display()), PHONE)?;
    page.without_scripts()?;
    let shown = page.evaluate("JSON.stringify([document.querySelectorAll('figure svg').length, document.getElementById('zoom').checkVisibility(), document.body.innerText.includes('runs no script'), typeof window.zoom.view])")?;
    ensure!(shown == format!("[{PICTURES},false,true,\"undefined\"]"), "{shown}");
    Ok(())
}
