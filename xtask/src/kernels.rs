//! `cargo xtask kernels`: what the hot kernels of the identification take, in instructions a sample-evaluation.
//!
//! Callgrind counts them as it emulates the machine, which depends neither on how busy the machine is nor on how fast:
//! a change that makes a kernel slower is seen where it was made. Counted is what the tests are built with. The file of
//! the counts is compared with; `--write` writes it. Other compilers make other instructions of one source: where rustc
//! has changed and nothing else, write it anew.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde::Deserialize;
use serde_json::{Map, Value, json};
use tempfile::TempDir;
use xshell::{Shell, cmd};

use crate::{
    artifact,
    packages::HOST,
    tool::{self, VALGRIND},
};

/// What is to be done about the counts.
#[derive(Args)]
pub struct Arguments {
    /// Print JSON for machines
    #[arg(long)]
    json: bool,
    /// Write the file that the check compares with
    #[arg(long)]
    write: bool,
}

/// Where the counts stand.
const BASELINE: &str = "host-tools/identification/benches/workload/instructions.json";
/// By what part of itself a count may differ from what stands there.
const TOLERANCE: f64 = 0.03;
/// The function in which is counted.
const COUNTED: &str = "*count*counted*";
/// The widest vector instructions that callgrind knows.
const EMULATED: &str = "AVX2";

/// What the bench says of itself.
#[derive(Deserialize)]
struct Bench {
    instructions: String,
    kernels: Vec<String>,
}

/// Counts and prints.
///
/// # Errors
/// The bench does not build, or callgrind counts nothing.
pub fn run(sh: &Shell, arguments: &Arguments) -> Result<()> {
    tool::require(sh, &[&VALGRIND])?;
    let counts = count(sh)?;
    if arguments.write {
        fs::write(sh.current_dir().join(BASELINE), format!("{:#}\n", json!(counts)))?;
    }
    if arguments.json {
        println!("{:#}", json!(counts));
    } else {
        println!("{:34}instructions a sample-evaluation", "");
        counts.iter().for_each(|(kernel, count)| println!("{kernel:34}{:>32.2}", count.as_f64().unwrap_or(f64::NAN)));
    }
    Ok(())
}

/// Compares with the file.
///
/// # Errors
/// Each kernel of which the count is another.
pub fn check(sh: &Shell) -> Result<()> {
    let counts = count(sh)?;
    let path = sh.current_dir().join(BASELINE);
    let text = fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let wrong = differences(&serde_json::from_str(&text).with_context(|| BASELINE.to_owned())?, &counts);
    ensure!(
        wrong.is_empty(),
        "{}\nmore: find out why, `callgrind_annotate` says where; fewer, or meant, or by another rustc: `cargo xtask kernels \
         --write`, and say why in the commit",
        wrong.join("\n")
    );
    Ok(())
}

/// Kernels whose count is not within the tolerance of what is stated, or that only one of the two has.
fn differences(stated: &Map<String, Value>, counts: &Map<String, Value>) -> Vec<String> {
    let number = |of: &Map<String, Value>, kernel: &str| of.get(kernel).and_then(Value::as_f64);
    let mut kernels: Vec<&String> = stated.keys().chain(counts.keys()).collect();
    kernels.sort_unstable();
    kernels.dedup();
    let wrong = |kernel: &String| match (number(stated, kernel), number(counts, kernel)) {
        (Some(stated), Some(found)) if (found / stated - 1.0).abs() <= TOLERANCE => None,
        (Some(stated), Some(found)) => {
            Some(format!("{kernel}: {found:.2} instructions a sample-evaluation, and {BASELINE} has {stated:.2}"))
        }
        (Some(_), None) => Some(format!("{kernel}: {BASELINE} has it, and the bench does not")),
        (None, _) => Some(format!("{kernel}: {BASELINE} has nothing of it")),
    };
    kernels.into_iter().filter_map(wrong).collect()
}

/// Instructions a sample-evaluation of every kernel, to two digits.
fn count(sh: &Shell) -> Result<Map<String, Value>> {
    let tests = cmd!(sh, "cargo test {HOST...} --bench workload --no-run");
    let bench = artifact::executable(tests, "workload")?;
    let folder = TempDir::new()?;
    let out = folder.path().join("callgrind.out");
    let option = format!("--callgrind-out-file={}", out.display());
    let emulated = cmd!(sh, "valgrind --quiet --tool=none {bench} --kernels").quiet().read()?;
    let Bench { instructions, kernels } = serde_json::from_str(&emulated)?;
    ensure!(
        instructions == EMULATED,
        "this machine emulates {instructions}, and the counts are of {EMULATED}: leave the check out with --skip kernels"
    );
    let of = |kernel: String| -> Result<(String, Value)> {
        let toggle = format!("--toggle-collect={COUNTED}");
        let evaluations: f64 = cmd!(sh, "valgrind --quiet --tool=callgrind {toggle} {option} {bench} --count {kernel}")
            .quiet()
            .read()?
            .parse()?;
        let count = total(&out)? / evaluations;
        ensure!(count > 0.0, "callgrind found no function {COUNTED} in {}", bench.display());
        Ok((kernel, json!((100.0 * count).round() / 100.0)))
    };
    kernels.into_iter().map(of).collect()
}

/// The instructions that callgrind has counted.
fn total(out: &Path) -> Result<f64> {
    let text = fs::read_to_string(out)?;
    let total = text.lines().find_map(|line| line.strip_prefix("totals: "));
    Ok(total.context("callgrind has written no total")?.trim().parse()?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kernel_that_is_slower_or_quicker_or_missing_is_named() {
        let of = |counts: Value| serde_json::from_value::<Map<String, Value>>(counts).unwrap();
        let stated = of(json!({ "engine": 10.0, "recursion": 200.0, "gone": 1.0, "same": 5.0 }));
        let counts = of(json!({ "engine": 10.4, "recursion": 190.0, "new": 1.0, "same": 5.1 }));
        let wrong = differences(&stated, &counts);
        let named: Vec<&str> = wrong.iter().filter_map(|line| line.split(':').next()).collect();
        assert_eq!(named, ["engine", "gone", "new", "recursion"]);
        assert!(wrong[0].contains("10.40") && wrong[0].contains("10.00"), "{}", wrong[0]);
        assert!(differences(&stated, &stated).is_empty());
    }
}
