//! `piezo completions` and `piezo man`: what a package of this program installs beside it, made of its
//! own command line.

use crate::option::Overwrite;
use crate::output::{self, to_folder};
use crate::verb::print::out;
use anyhow::{Context, Result};
use clap::{Args, Command};
use clap_complete::Shell;
use clap_mangen::Man;
use std::path::PathBuf;

/// Arguments of `piezo completions`.
#[derive(Args, Debug)]
pub struct Completions {
    /// Whose words are to be completed.
    pub shell: Shell,
}

/// Arguments of `piezo man`.
#[derive(Args, Debug)]
pub struct Manual {
    /// Folder that the pages are written to, one for each verb.
    #[arg(long, value_name = "FOLDER")]
    pub out: PathBuf,
    /// What to do about files that are there.
    #[command(flatten)]
    pub overwrite: Overwrite,
}

/// By what a page of a former run is known.
const PAGE: &str = ".TH piezo";

/// Prints the shell's completions of a command line.
pub fn completions(arguments: &Completions, mut cli: Command) -> Result<bool> {
    let mut script = Vec::new();
    clap_complete::generate(arguments.shell, &mut cli, "piezo", &mut script);
    output::standard(&script)?;
    Ok(true)
}

/// Writes a command line's pages of the manual.
pub fn manual(arguments: &Manual, cli: Command) -> Result<bool> {
    let _held = to_folder(&arguments.out)?;
    let mut cli = cli.disable_help_subcommand(true);
    cli.build();
    let mut pages = Vec::new();
    for command in std::iter::once(&cli).chain(cli.get_subcommands()) {
        let page = Man::new(command.clone());
        let path = arguments.out.join(page.get_filename());
        arguments.overwrite.of(&path, PAGE)?;
        let mut text = Vec::new();
        page.render(&mut text).with_context(|| path.display().to_string())?;
        pages.push((path, text));
    }
    for (path, text) in &pages {
        output::write(path, text)?;
    }
    out(&format!(
        "Written to {}: {} pages; man -l {} shows one",
        arguments.out.display(),
        pages.len(),
        pages[0].0.display()
    ));
    Ok(true)
}
