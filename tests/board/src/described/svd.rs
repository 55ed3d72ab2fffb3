//! The crate `stm32g4`, which svd2rust wrote of ST's SVD file and stm32-rs's mends. It is read as text: compiled, it
//! takes longer than all of this package, and its types do not say where a field lies. Each register's and field's
//! place stands in the documentation of the function that gives it.

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use serde_json::Value;

use super::Description;
use crate::bases;

/// The crate, and the chip's folder in it.
const CRATE: &str = "stm32g4";
const CHIP: &str = "src/stm32g474";
/// How a peripheral takes a register from another.
const BORROWED: &str = "pub use crate::stm32g474::";

/// A cluster's registers and an array's are named as what they are in.
const SPELLING: &[(&str, &[(&str, &str)])] = &[
    ("INTERRUPT", &[("TIM6_DAC", "TIM6_DACUNDER"), ("LPUART1", "LPUART")]),
    ("DAC1", &[("DHR12R1.DACC1DHR", "DHR12R1.DACCDHR")]),
    (
        "DMA1",
        &[
            ("CCR1", "CH1.CR"),
            ("CNDTR1", "CH1.NDTR"),
            ("CPAR1", "CH1.PAR"),
            ("CMAR1", "CH1.MAR"),
            ("CCR2", "CH2.CR"),
            ("CCR8", "CH8.CR"),
            ("CMAR8", "CH8.MAR"),
        ],
    ),
    ("DMAMUX", &[("C0CR", "CCR[0]"), ("C7CR", "CCR[7]")]),
];

/// What it says of the peripherals.
pub fn read() -> Description {
    let chip = folder().join(CHIP);
    let mut description = Description { name: "the SVD file", spelling: SPELLING, ..Description::default() };
    let text = text(&chip.join("mod.rs"));
    for line in text.lines() {
        // pub type TIM5 = crate::Periph<tim2::RegisterBlock, 0x4000_0c00>;
        if let Some((name, of)) = line.strip_prefix("pub type ").and_then(|rest| rest.split_once(" = crate::Periph<"))
            && let Some((module, base)) = of.trim_end_matches(">;").split_once("::RegisterBlock, ")
        {
            if !bases::ALL.iter().any(|(modelled, _)| *modelled == name) {
                continue;
            }
            description.bases.insert(name.to_owned(), number(base));
            block(&mut description, name, &chip, module, 0);
        }
        // TIM5 = 50,
        if let Some((name, value)) = line.trim().trim_end_matches(',').split_once(" = ")
            && let Ok(value) = value.parse()
        {
            description.interrupts.insert(format!("INTERRUPT.{name}"), value);
        }
    }
    description
}

/// The crate's folder, where cargo has put it.
fn folder() -> PathBuf {
    let printed = |program: &str, arguments: &[&str]| {
        let program = env::var_os(program.to_uppercase()).unwrap_or_else(|| program.into());
        let output = Command::new(program).args(arguments).output().expect("it has built this test");
        assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("the compiler and cargo write UTF-8")
    };
    let manifest = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
    // Of other hosts' packages none need be here.
    let host = printed("rustc", &["--print=host-tuple"]);
    let arguments = ["metadata", "--format-version=1", "--offline", "--filter-platform", host.trim()];
    let packages = printed("cargo", &[&arguments[..], &["--manifest-path", manifest]].concat());
    let metadata: Value = serde_json::from_str(&packages).expect("cargo writes JSON");
    let packages = metadata["packages"].as_array().expect("cargo lists the packages");
    let found = packages.iter().find(|package| package["name"] == CRATE).expect("a dependency of this package");
    let manifest = Path::new(found["manifest_path"].as_str().expect("each package has its manifest"));
    manifest.parent().expect("a file is in a folder").to_owned()
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn number(digits: &str) -> u32 {
    let digits = digits.replace('_', "");
    let parsed = digits.strip_prefix("0x").map_or_else(|| digits.parse(), |hex| u32::from_str_radix(hex, 16));
    parsed.unwrap_or_else(|error| panic!("{digits}: {error}"))
}

/// The registers and clusters of a block, whose file is `module` in `folder`.
fn block(description: &mut Description, name: &str, folder: &Path, module: &str, offset: u32) {
    let own = text(&folder.join(module).with_extension("rs"));
    for Documented { place, name: part, argument, gives } in documented(&own) {
        // ///0x08..0x1c - Channel cluster
        let Some(place) = place.strip_prefix("0x").and_then(|place| place.split(['.', ' ']).next()) else { continue };
        let Some(gives) = gives.strip_prefix('&') else { continue };
        let offset = offset + number(&format!("0x{place}"));
        let inner = gives.to_lowercase();
        // pub use crate::stm32g474::gpioa::otyper;
        let end = format!("::{inner};");
        let borrowed = own.lines().find_map(|line| line.strip_prefix(BORROWED)?.strip_suffix(&end));
        let within = folder.join(borrowed.unwrap_or(module));
        let source = text(&within.join(&inner).with_extension("rs"));
        let path = format!("{name}.{}", part.to_uppercase());
        // Registers one behind the other: `ccr: [CCR; 16],`. Of others each has a function of its own, too.
        let array = format!("{part}: [{gives}; ");
        let count = own.lines().find_map(|line| line.trim().strip_prefix(&array)?.strip_suffix("],"));
        match count {
            Some(count) if argument => {
                for n in 0..number(count) {
                    register(description, &format!("{path}[{n}]"), offset + 4 * n, &source);
                }
            }
            _ if argument => {}
            _ if source.contains(&format!("pub struct {gives} {{")) => {
                block(description, &path, &within, &inner, offset)
            }
            _ => register(description, &path, offset, &source),
        }
    }
}

/// A register and its fields.
fn register(description: &mut Description, path: &str, offset: u32, source: &str) {
    description.registers.insert(path.to_owned(), offset);
    for Documented { place, name, argument, .. } in documented(source) {
        // ///Bits 4:6 - Master mode selection
        let Some(bits) = place.strip_prefix("Bit ").or_else(|| place.strip_prefix("Bits ")) else { continue };
        if argument {
            continue;
        }
        let bits = bits.split(' ').next().unwrap_or_default();
        let (low, high) = bits.split_once(':').unwrap_or((bits, bits));
        let mask = u32::MAX >> (31 - number(high)) & u32::MAX << number(low);
        description.fields.insert(format!("{path}.{}", name.to_uppercase()), mask);
    }
}

/// A function of a block or of a register.
struct Documented<'a> {
    /// The first line of its documentation.
    place: &'a str,
    name: &'a str,
    /// Whether it asks for the number of an array's element.
    argument: bool,
    /// The type that it gives.
    gives: &'a str,
}

/// The functions that a file documents.
fn documented(source: &str) -> Vec<Documented<'_>> {
    let mut found = Vec::new();
    let mut place = "";
    for line in source.lines().map(str::trim) {
        if let Some(words) = line.strip_prefix("///") {
            if place.is_empty() {
                place = words;
            }
            continue;
        }
        let function = line.strip_prefix("pub const fn ").or_else(|| line.strip_prefix("pub fn "));
        if let Some((name, rest)) = function.and_then(|function| function.split_once('('))
            && let Some((arguments, gives)) = rest.split_once(") -> ")
        {
            let argument = !["&self", "&mut self"].contains(&arguments);
            found.push(Documented { place, name, argument, gives: gives.trim_end_matches(" {") });
        }
        // Attributes stand between the two.
        if !line.starts_with("#[") {
            place = "";
        }
    }
    found
}
