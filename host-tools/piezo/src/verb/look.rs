//! `piezo look`: what was understood of a log, before anything is fitted to it.

use super::print::out;
use crate::option::{LogOptions, Overwrite};
use crate::output::{self, PICTURE};
use anyhow::{Result, ensure};
use clap::Args;
use log_survey::{Survey, survey};
use recordings::log::{Fault, LogError, Need, Quantity, ReadOptions, Reading, open};
use remedy::{Learnable, sentence};
use std::path::{Path, PathBuf};

/// Arguments of `piezo look`.
#[derive(Args, Debug)]
pub struct Look {
    /// Logs. They are streamed, however long they are; of a .mat or .tdms file all is held at once. Where one of
    /// several cannot be read, the rest are looked at all the same; no picture is then drawn, and the exit code is 2.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// Draw the log to this file (SVG; an .html name gets a page with the pictures of all logs).
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print what was understood as JSON.
    #[arg(long)]
    pub json: bool,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// What becomes of a file in a result's place.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// Runs the verb.
pub fn run(arguments: &Look) -> Result<bool> {
    let page = arguments.out.as_ref().and_then(|path| path.extension()).is_some_and(|extension| extension == "html");
    if let Some(path) = &arguments.out {
        arguments.overwrite.of_inputs(path, PICTURE, &arguments.logs)?;
        let svg = path.extension().is_none_or(|extension| extension == "svg");
        let why = if svg { "holds the picture of one log: name" } else { "the picture is SVG: name an .svg file, or" };
        ensure!(page || svg && arguments.logs.len() == 1, "{}: {why} an .html file", path.display());
    }
    let (mut pictures, mut surveys, mut tried) = (vec![], vec![], vec![]);
    let (mut flawed, mut doubtful, mut unread) = (false, false, 0);
    for path in &arguments.logs {
        let (found, refusal) = match looked_at(path, arguments) {
            Err(error) if arguments.logs.len() > 1 => {
                let why = sentence(error.as_ref());
                eprintln!("piezo: {why}");
                surveys.push(serde_json::json!({ "log": path.to_string_lossy(), "survey": null, "refusal": why }));
                unread += 1;
                continue;
            }
            looked_at => looked_at?,
        };
        flawed |= found.rows_without_a_number > 0 || found.flaws.iter().flatten().any(|of| of.worst.repairable());
        doubtful |= findings::doubtful(&found);
        let complete = refusal.is_none() && found.voltage.is_some();
        let learnable = complete.then(|| remedy::learnable(path, &arguments.files.options(), &found));
        flawed |= learnable.as_ref().is_some_and(|of| matches!(of, Learnable::Repaired(_)));
        let measured = found.displacement.is_some() && !found.displacement_estimated;
        let hinders = learnable.as_ref().and_then(|of| of.line());
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        pictures.push(report::survey(&found, &name));
        if arguments.json {
            let refusal = refusal.as_deref().or(learnable.as_ref().and_then(|of| of.refusal()));
            surveys.push(serde_json::json!({ "log": path.to_string_lossy(), "survey": found, "refusal": refusal }));
        } else {
            out(&path.display().to_string());
            remedy::surveyed(&found, refusal.as_deref(), hinders).iter().for_each(|line| out(line));
        }
        tried.push(learnable.filter(|_| measured));
    }
    if arguments.json {
        out(&serde_json::to_string_pretty(&surveys)?);
    }
    ensure!(unread == 0, "{unread} of the {} logs could not be read", arguments.logs.len());
    if let Some(path) = &arguments.out {
        let head = if page { "<!doctype html>\n<meta charset=\"utf-8\">\n" } else { "" };
        output::write(path, format!("{head}{}", pictures.join("\n")))?;
        if !arguments.json {
            out(&format!("\nWritten: {}", path.display()));
        }
    }
    let tried: Option<Vec<_>> = tried.into_iter().collect();
    if !arguments.json && tried.is_some_and(|logs| remedy::all_learnable(&logs)) {
        let after = if doubtful { ", once what is doubtful is settled" } else { "" };
        out(&format!("\nNext{after}:\n    {}", remedy::learn_from(&arguments.logs, flawed)));
    }
    Ok(true)
}

/// What was understood of a log, and where it has no displacement that can be read the sentence that says why not.
fn looked_at(path: &Path, arguments: &Look) -> Result<(Survey, Option<String>)> {
    let (reading, refusal) = opened(path, arguments)?;
    Ok((survey(reading)?, refusal))
}

/// The log, with a displacement if it has one that can be read; else with the sentence that says why not.
fn opened(path: &Path, arguments: &Look) -> Result<(Reading<'static>, Option<String>)> {
    let options = ReadOptions { holes: true, ..arguments.files.options() };
    match open(path, &options) {
        Err(error @ LogError { fault: Fault::NoColumn { quantity: Quantity::Displacement, .. }, .. }) => {
            let without = open(path, &ReadOptions { displacement: Need::Optional, ..options })?;
            Ok((without, Some(sentence(&error))))
        }
        opened => Ok((opened?, None)),
    }
}
