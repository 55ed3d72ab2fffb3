//! `examples/tick.c`, compiled by a C compiler for a Cortex-M4F, linked with the static library and run in QEMU, gives
//! the bits that the core gives on the host, with every model.
//!
//! `STATIC_LIBRARY` names the library; `cargo xtask test c` builds it.

use estimator_core::{AdcCode, Admitted, Commanded, DriveLimits, Estimate, Estimator, Inverse, Model, Range};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const HERE: &str = env!("CARGO_MANIFEST_DIR");
const COMPILER: &str = "arm-none-eabi-gcc";
const MACHINE: [&str; 4] = ["-mcpu=cortex-m4", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv4-sp-d16"];
const STRICT: [&str; 7] = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-ffp-contract=off"];

/// Those of `tick.c`.
const TICKS: u32 = 3000;
const TOLD_AT: u32 = 1500;

fn static_library() -> PathBuf {
    let path = std::env::var_os("STATIC_LIBRARY").map(PathBuf::from);
    path.filter(|path| path.is_file())
        .unwrap_or_else(|| panic!("$STATIC_LIBRARY names no file: run this test with `cargo xtask test c`"))
}

/// What the program prints with a table, line by line.
fn in_qemu(table: &Admitted) -> Vec<String> {
    let folder = tempfile::tempdir().unwrap();
    let (record, image) = (folder.path().join("table.bin"), folder.path().join("tick.elf"));
    std::fs::write(&record, table_files::record(table)).unwrap();
    let here = Path::new(HERE);
    let compiled = Command::new(COMPILER)
        .args(MACHINE)
        .args(STRICT)
        .arg(format!("-DTABLE=\"{}\"", record.display()))
        .args(["-ffreestanding", "-nostdlib", "-Wl,--gc-sections", "-T"])
        .arg(here.join("tests/cortex_m/an386.ld"))
        .arg("-I")
        .arg(here.join("include"))
        .arg("-I")
        .arg(here.join("tests/cortex_m"))
        .args([here.join("examples/tick.c"), here.join("tests/cortex_m/port.c"), static_library()])
        .args(["-lgcc", "-o"])
        .arg(&image)
        .output()
        .expect("arm-none-eabi-gcc starts: `cargo xtask setup` installs it");
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    let run = Command::new("qemu-system-arm")
        .args(["-M", "mps2-an386", "-cpu", "cortex-m4", "-nographic", "-monitor", "none", "-serial", "null"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(&image)
        .output()
        .expect("qemu-system-arm starts: `cargo xtask setup` installs it");
    // QEMU hands semihosting's output to its standard error or output, by version.
    let printed = String::from_utf8([run.stdout, run.stderr].concat()).unwrap();
    assert!(run.status.success(), "{}: {printed}", run.status);
    printed.lines().map(str::to_owned).collect()
}

fn line(letter: char, first: f32, second: f32, third: u32, fourth: u32) -> String {
    let mut line = letter.to_string();
    for number in [first.to_bits(), second.to_bits(), third, fourth] {
        write!(line, " {number:08x}").unwrap();
    }
    line
}

/// What it ought to print, by the core on the host.
fn on_the_host(table: &Admitted) -> Vec<String> {
    let zero = table.voltage_zero_v;
    let range_v = Range { min: table.voltage_range_v.min + zero, max: table.voltage_range_v.max + zero };
    let limits = DriveLimits { range_v, rest_v: range_v.min, slew_v_per_s: 100.0 * range_v.span() };
    let mut estimator = Estimator::<f32>::new(table);
    let mut inverse: Option<Inverse<f32>> = table.inverse(&limits).ok();
    let displacements = table.displacement_limits_um;
    let (mut lines, mut noise) = (Vec::new(), 1u32);
    for tick in 0..TICKS {
        noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let phase = tick % 800;
        let triangle = 160 * if phase < 400 { phase } else { 800 - phase };
        let code = u16::try_from(if tick < 2000 { triangle } else { noise >> 16 }).unwrap();
        let Estimate { displacement, half_width, dac, status } = estimator.tick(AdcCode(code));
        let half_width = half_width.unwrap_or(f32::NAN);
        lines.push(line('E', displacement, half_width, dac.0.into(), status.bits().into()));
        if let Some(inverse) = &mut inverse {
            let wanted = displacements.min + displacements.span() * (f32::from(code) / 65536.0);
            let Commanded { voltage, displacement, reached } = inverse.tick(wanted);
            lines.push(line('C', voltage, displacement, 0, reached.into()));
        }
        if tick == TOLD_AT {
            let _ = estimator.set_zero(1.0);
        }
    }
    lines
}

#[test]
fn a_program_in_c_gives_the_bits_of_the_host() {
    let tables = Path::new(HERE).join("../tests/data/table/models");
    for model in Model::ALL {
        let (_, table) = table_files::TableFile::load(&tables.join(format!("{}.toml", model.name()))).unwrap();
        let printed = in_qemu(&table);
        let (stack, ticks) = printed.split_first().expect("the program prints");
        let expected = on_the_host(&table);
        assert_eq!(table.interval.is_some(), model == Model::GeneralisedPrandtlIshlinskii, "one has an interval");
        let wrong = ticks.iter().zip(&expected).position(|(printed, expected)| printed != expected);
        assert_eq!(wrong.map(|at| (&ticks[at], &expected[at])), None, "{}", model.name());
        assert_eq!(ticks.len(), expected.len(), "{}", model.name());
        let used = stack.rsplit(' ').next().and_then(|bytes| usize::from_str_radix(bytes, 16).ok()).unwrap();
        println!("{}: {used} bytes of stack, {} ticks", model.name(), TICKS);
        assert!(used <= piezo_estimator::PIEZO_BEGIN_STACK_BYTES, "{used} bytes of stack");
    }
}
