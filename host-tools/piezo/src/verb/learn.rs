//! `piezo learn`: from a board and a sensor to a proven table, by the verbs that each do a part: train,
//! identify, install, prove.

use super::identify::{self, Identify};
use super::install::{self, Install};
use super::print::out;
use super::prove::{self, Prove};
use super::train::{self, Train};
use crate::option::link::PortOption;
use crate::option::{BoardOption, ExcitationArgs, positive};
use ::calibration::span::Span;
use anyhow::{Context, Result};
use bench::{BenchError, Session, session};
use clap::{Args, Parser};
use device_link::busy::idle;
use device_link::interrupt::Interrupt;
use remedy::quoted;
use std::path::PathBuf;

/// Arguments of `piezo learn`.
#[derive(Args, Debug)]
pub struct Learn {
    /// Folder for everything.
    #[arg(long)]
    pub out: PathBuf,
    /// Length of the training, minutes.
    #[arg(long, default_value_t = 2.0, value_parser = positive, allow_negative_numbers = true)]
    pub minutes: f64,
    /// Length of the proof, s.
    #[arg(long, default_value_t = 30.0, value_parser = positive, allow_negative_numbers = true)]
    pub proof_seconds: f64,
    /// Say what would be driven and typed, and drive nothing.
    #[arg(long)]
    pub dry_run: bool,
    /// What `piezo identify` is told besides, such as `-- --model generalised-prandtl-ishlinskii`.
    #[arg(last = true)]
    pub identify: Vec<String>,
    /// The file that says what the board's wires stand for.
    #[command(flatten)]
    pub board: BoardOption,
    /// Where the device is.
    #[command(flatten)]
    pub port: PortOption,
    /// What the voltages are to be like.
    #[command(flatten)]
    pub excitation: ExcitationArgs,
}

/// The parts, as the program's command line has them.
#[derive(Parser)]
#[command(name = "piezo", version)]
enum Part {
    Train(Train),
    Identify(Box<Identify>),
    Install(Install),
    Prove(Prove),
}

/// Runs the verb; `false` where a part says so, and what follows that is not begun. Run again, it goes on behind a
/// session that is whole: the sensor need not come back for what was not learnt or not installed.
pub fn run(arguments: &Learn) -> Result<bool> {
    // Ctrl-C in a part that does not look for it, as identify, ends before the next one, which may move the actuator.
    let interrupt = Interrupt::watch()?;
    let part = |words| part(words, &interrupt, arguments.excitation.range);
    let path =
        |path: PathBuf| path.to_str().map(str::to_owned).with_context(|| format!("{}: is no UTF-8", path.display()));
    let (folder, board) = (path(arguments.out.clone())?, path(arguments.board.board.clone())?);
    let model = path(arguments.out.join("model"))?;
    let (port, excitation) = (arguments.port.port.to_string(), &arguments.excitation);
    let (seed, up_to) = (excitation.seed.to_string(), excitation.up_to.to_string());
    let mut train =
        words(&["train", "--port", &port, "--board", &board, "--out", &folder, "--up-to", &up_to, "--seed", &seed]);
    train.extend(["--minutes".to_owned(), arguments.minutes.to_string()]);
    train.extend(arguments.board.another_board.then(|| "--another-board".to_owned()));
    // The proof stays within what was typed, too.
    let range = excitation.range.map(|range| format!("--range={}:{}", range.zero, range.full));
    train.extend(range.clone());
    let another = arguments.board.another_board.then_some("--another-board");
    let link: Vec<&str> = ["--board", &board, "--port", &port].into_iter().chain(another).collect();
    // The folder stands for its logs, with the board's tick.
    let identify =
        [words(&["identify", &folder, "--board", &board, "--out", &model]), arguments.identify.clone()].concat();
    // What stands behind `--` is understood before anything moves.
    parse(identify.clone())?;
    let proof = arguments.out.join("proof");
    if proof.exists() {
        return Err(BenchError::Occupied { path: proof }.into());
    }
    let whole = session(&arguments.out).ok().filter(|session| session.complete);
    let prove = |seed: u64| {
        let (proof, seconds) = (path(proof.clone())?, arguments.proof_seconds.to_string());
        // Another draw than the training's, which nothing has seen.
        let other = seed.wrapping_add(1).to_string();
        let prove = ["prove", "--out", &proof, "--seconds", &seconds, "--up-to", &up_to, "--seed", &other];
        Ok::<_, anyhow::Error>([words(&[&prove, &link[..]].concat()), range.iter().cloned().collect()].concat())
    };
    let install = words(&[&["install", &model], &link[..]].concat());
    if arguments.dry_run {
        if whole.is_some() {
            out(&format!("{folder} has a whole session, which would be learnt from as it is"));
        } else {
            part([train, words(&["--dry-run"])].concat())?;
        }
        let seed = whole.map_or(excitation.seed, |session| session.seed);
        out("\nThen, one after the other, unless one fails:\n");
        [identify, install, prove(seed)?].iter().for_each(|words| out(&format!("    piezo {}", typed(words))));
        return Ok(true);
    }
    if whole.is_some() {
        idle(&mut arguments.port.connect()?.0)?;
        out(&format!("{folder} has a whole session, which is learnt from as it is: nothing is recorded"));
    } else if !part(train)? {
        return Ok(false);
    }
    let Session { seed, .. } = session(&arguments.out)?;
    let mut next = [identify, install, prove(seed)?].into_iter().peekable();
    while let Some(words) = next.next() {
        let what = words[0].clone();
        if !part(words)? {
            if let Some(left) = next.peek().filter(|_| !interrupt.wanted()) {
                out(&format!("FAILED: {what} ends so, and this was not begun: piezo {}", typed(left)));
            }
            return Ok(false);
        }
    }
    out(&remedy::learnt(&model, &port));
    Ok(true)
}

fn words(words: &[&str]) -> Vec<String> {
    words.iter().map(|word| (*word).to_owned()).collect()
}

/// A command as it would be typed.
fn typed(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// A command without the program's name, as if it were typed.
fn parse(words: Vec<String>) -> Result<Part> {
    Ok(Part::try_parse_from(std::iter::once("piezo".to_owned()).chain(words))?)
}

/// Runs a command as if it were typed, which installs a table for these voltages; `false` where it says so, or
/// was not begun.
fn part(words: Vec<String>, interrupt: &Interrupt, range: Option<Span>) -> Result<bool> {
    let typed = typed(&words);
    if interrupt.wanted() {
        out(&format!("FAILED: ended by Ctrl-C; what was to come next: piezo {typed}"));
        return Ok(false);
    }
    out(&format!("\n$ piezo {typed}"));
    match parse(words)? {
        Part::Train(train) => train::run(&Train { of_learn: true, ..train }),
        Part::Identify(mut identify) => {
            identify.of_learn = true;
            // The other parts look for it themselves.
            let _listens = interrupt.then(|| eprintln!("piezo: {}", remedy::ENDS));
            identify::run(&mut identify)
        }
        Part::Install(install) => install::run(&Install { of_learn: true, range, ..install }),
        Part::Prove(prove) => prove::run(&prove),
    }
}
