//! `piezo monitor --web` in a browser, while a device streams at 2 kHz: one on this machine with a sensor, and the
//! firmware in QEMU.

use std::{
    env, fs,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    time::Duration,
};

use anyhow::{Context, Result, ensure};
use device_link::{pages, table::to_record};
use emulator::{Conversion, EmulatedDevice, Emulator, PAGES};
use estimator_core::{AdcCode, DacCode, Estimator};
use parameter_store::RamFlash;
use qemu_test::Board;
use recordings::log::{ReadOptions, read};
use report_browser_test::{Page, Viewport, launch};
use table_files::TableFile;

const SCREENS: [(&str, Viewport); 3] = [
    ("scope-phone", Viewport { width: 360, height: 740, scale: 2.0, mobile: true, least_text: 9.0 }),
    ("scope-desktop", Viewport { width: 1280, height: 900, scale: 1.0, mobile: false, least_text: 9.0 }),
    ("scope-wide", Viewport { width: 1920, height: 1080, scale: 1.0, mobile: false, least_text: 9.0 }),
];
/// Voltage, displacement, error and loop.
const PLOTS: usize = 4;
const PATIENCE: Duration = Duration::from_secs(20);
/// Of the emulated sensor, µm at code 0 and at full scale.
const SENSOR_UM: (f64, f64) = (-10.0, 60.0);
const FULL_SCALE: u16 = 65_520;
/// A code of one tick in two seconds; the triangle stays far below.
const GLITCH: u16 = 58_000;

/// A device with a table that has an interval, a triangle of 1 Hz on its ADC, and a sensor that shows nearly
/// what it estimates.
fn device() -> Result<EmulatedDevice> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let (_, table) = TableFile::load(&root.join("tests/data/table/models/generalised-prandtl-ishlinskii.toml"))?;
    let mut actuator = Estimator::<f64>::new(&table);
    let mut tick = 0;
    let plant = move |_: DacCode| {
        tick = (tick + 1) % 4000;
        let phase = tick % 2000;
        // At most 45,990.
        let code = (6000 + 40 * phase.min(2000 - phase)) as u16 - 10 + 5 * (tick % 3) as u16;
        let um = f64::from(actuator.tick(AdcCode(code)).displacement) * 1.01 + 0.2;
        let share = (um - SENSOR_UM.0) / (SENSOR_UM.1 - SENSOR_UM.0);
        Conversion {
            monitor: AdcCode(if tick == 3000 { GLITCH } else { code }),
            sensor: Some(AdcCode((share * f64::from(FULL_SCALE)) as u16)),
            setpoint: None,
        }
    };
    let flash = RamFlash::new(pages::with(&to_record(&table), PAGES)?);
    Ok(Emulator::new().plant(plant).flash(flash).start()?)
}

/// `piezo monitor --web`; it ends with this value.
struct Monitor(Child);

impl Monitor {
    /// Starts it in a folder; returns the page's address, too.
    fn start(folder: &Path, port: &str, arguments: &[&str]) -> Result<(Self, String)> {
        let piezo =
            env::var_os("PIEZO").context("$PIEZO names no program: run this test with `cargo xtask test browser`")?;
        let mut command = Command::new(piezo);
        command.args(["monitor", "--web", "--port", port]).args(arguments).current_dir(folder).stdout(Stdio::piped());
        let mut monitor = Self(command.spawn()?);
        let mut said = String::new();
        BufReader::new(monitor.0.stdout.take().context("piped")?).read_line(&mut said)?;
        let url =
            said.split(' ').find(|word| word.starts_with("http://")).with_context(|| format!("no address: {said}"))?;
        Ok((monitor, url.to_owned()))
    }
}

impl Drop for Monitor {
    fn drop(&mut self) {
        // Nothing can be done about a process that is already gone.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn screenshots() -> Result<PathBuf> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("report-screenshots");
    fs::create_dir_all(&folder)?;
    Ok(folder)
}

/// Has the page record some half a second, by its button; the log's path.
fn recorded(page: &mut Page<'_>, folder: &Path) -> Result<PathBuf> {
    page.evaluate("document.getElementById('record').click()")?;
    page.until(
        "/recording into .*recording-1.csv: (0.[5-9]|[1-9])/.test(document.getElementById('recorded').textContent)",
        PATIENCE,
    )?;
    page.evaluate("document.getElementById('record').click()")?;
    page.until(
        "/recording-1.csv holds [0-9]+ samples/.test(document.getElementById('recorded').textContent)",
        PATIENCE,
    )?;
    Ok(folder.join("recording-1.csv"))
}

#[test]
fn the_scope_draws_zeroes_and_records_beside_a_sensor() -> Result<()> {
    let folder = tempfile::tempdir()?;
    fs::write(folder.path().join("board.toml"), format!("sensor_span = [{:.1}, {:.1}]\n", SENSOR_UM.0, SENSOR_UM.1))?;
    let device = device()?;
    let port = format!("tcp:{}", device.address());
    let (_monitor, url) = Monitor::start(folder.path(), &port, &["--board", "board.toml"])?;
    let screenshots = screenshots()?;
    let mut browser = launch()?;
    let mut faults = Vec::new();
    for (index, (name, viewport)) in SCREENS.into_iter().enumerate() {
        let mut page = Page::open(&mut browser, &url, viewport)?;
        page.until("window.scope?.drawn > 3", PATIENCE)?;
        if index == 0 {
            // Around a gap, too, times increase: the plot finds its columns by them.
            let times = page.evaluate(
                "(() => { const history = new History(0.005, 60); history.push([0.0005, 0.005, 0.01, 0.023, 0.025, 0.03].map((time) => [time, time === 0.023 ? 1 : 0, [0, 1], [0, 1], null, null, null]), [[], [], [], [], [], []]); const { seconds, voltage } = history.merged(0, 1000); return seconds.length === 6 && seconds.every((time, index) => index === 0 || time > seconds[index - 1]) && voltage[0].filter((volt) => volt === null).length === 1 ? '' : JSON.stringify(seconds); })()",
            )?;
            ensure!(times == "", "{times}");
            page.until("document.getElementById('mode').textContent.includes('never zeroed')", PATIENCE)?;
            page.evaluate(
                "document.getElementById('at').value = '12.5'; document.getElementById('zero-button').click()",
            )?;
            page.until(
                "document.getElementById('said').textContent.startsWith('called 12.5 µm; zeroed 0 s ago')",
                PATIENCE,
            )?;
            let log = read(&recorded(&mut page, folder.path())?, &ReadOptions::default())?;
            ensure!(
                log.displacement.is_some() && !log.displacement_estimated && log.voltage.len() >= 1000,
                "no sensor's log"
            );
        }
        // The ± is there, and so is the sensor, and the words are those of the device.
        page.until("/^± [0-9.]+ µm/.test(document.getElementById('interval').textContent)", PATIENCE)?;
        page.until("/^estimate less sensor/.test(document.getElementById('error').textContent)", PATIENCE)?;
        // A glitch of one tick is in what is drawn, whatever the screen's width.
        page.until(
            "(({ merged }) => merged.seconds.length > 100 && Math.max(...merged.voltage[1]) > 3.4 && merged.voltage[1].filter((volt) => volt > 3.4).length < 9)(window.scope)",
            PATIENCE,
        )?;
        let drawn = page.evaluate("window.scope.drawn")?;
        page.evaluate("document.getElementById('pause').click()")?;
        faults.extend(page.faults(viewport, PLOTS)?.into_iter().map(|fault| format!("{name}: {fault}")));
        let image = screenshots.join(name).with_extension("png");
        fs::write(&image, page.screenshot()?)?;
        println!("to look at: {}, after {drawn} drawings", image.display());
    }
    ensure!(faults.is_empty(), "{}", faults.join("\n"));
    Ok(())
}

#[test]
fn the_scope_keeps_up_with_the_firmware_in_qemu() -> Result<()> {
    let board = Board::power_on();
    let folder = tempfile::tempdir()?;
    let (_monitor, url) = Monitor::start(folder.path(), &board.address(), &[])?;
    let mut browser = launch()?;
    let mut page = Page::open(&mut browser, &url, SCREENS[1].1)?;
    page.until("window.scope?.merged.seconds.length > 400", PATIENCE)?;
    let board = page.evaluate("document.getElementById('board').textContent")?;
    ensure!(board.as_str().is_some_and(|board| board.starts_with("mps2-an386")), "{board}");
    let log = read(&recorded(&mut page, folder.path())?, &ReadOptions::default())?;
    ensure!(log.sample_period == 0.0005 && log.displacement_estimated, "no log of the device's");
    let lost =
        page.evaluate("document.getElementById('rate').textContent + document.getElementById('lost').textContent")?;
    println!("{lost}");
    // How many are lost is this machine's affair; that a curve has a gap only where some are, the page's. The first
    // column follows nothing, and figures come after curves.
    page.until(
        "(({ history: { columns } }) => columns.length > 400 && (Number.parseInt(document.getElementById('lost').textContent) > 0 || columns.slice(1).every(([, gap]) => gap === 0)))(window.scope)",
        PATIENCE,
    )?;
    let troubles = page.troubles()?;
    ensure!(troubles.is_empty(), "{}", troubles.join("\n"));
    Ok(())
}
