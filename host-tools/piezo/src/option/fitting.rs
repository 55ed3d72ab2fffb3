//! What `identify` and `compare` have in common: logs, what is held out of them, what is minimised, under which
//! conditions.

use super::choice::{Choice, choice};
use super::number::{limit, positive};
use super::{CostArgs, LogOptions, PrepareArgs};
use ::calibration::CalibrationOptions;
use anyhow::{Result, ensure};
use bench::{BenchError, open_session};
use clap::Args;
use estimator_core::Scheme;
use identification::cost::Cost;
use identification::{Conditions, Job, ModelChoice, SearchOptions};
use std::path::{Path, PathBuf};

const SCHEMES: [Choice<Scheme>; 2] = [
    (Scheme::ForwardEuler, "forward-euler", "The thesis's"),
    (Scheme::ZeroOrderHold, "zero-order-hold", "Exact for a voltage that stays for the tick; stable for any rate"),
];

/// Where the help lists what few need: behind the rest of its heading.
const BEHIND: usize = 100;

/// Logs to fit to, and how.
#[derive(Args, Debug)]
pub struct Fitting {
    /// Logs to fit to, or a folder of `piezo train`; each log weighs the same whatever its length.
    #[arg(required = true)]
    pub logs: Vec<PathBuf>,
    /// Logs that are held out: their errors are reported and decide nothing.
    #[arg(long, num_args = 1.., value_name = "LOG")]
    pub validate_on: Vec<PathBuf>,
    /// Hold out this fraction of each log until the model is judged: its end, or stretches where ends go beyond what is
    /// before; 0.5 unless --validate-on names logs. `identify` then learns the chosen model once more from all of them.
    #[arg(long, display_order = BEHIND, value_name = "FRACTION", allow_negative_numbers = true)]
    pub hold_out: Option<f64>,
    /// Leave out what is no measurement: a value that is no number, rows that the time stamps leave out, where the
    /// displacement leaps away and back or stands still while the voltage moves, and where the voltage is cut off or
    /// leaps alone. The voltage is run through all the same, straight past its own leaps. Behind a step of the sensor
    /// alone the displacement is taken back by it.
    #[arg(long)]
    pub repair: bool,
    /// Print the result as JSON.
    #[arg(long, display_order = BEHIND)]
    pub json: bool,
    /// What is minimised.
    #[command(flatten)]
    pub cost: CostArgs,
    /// Discretisation of the Voigt family.
    #[arg(long, hide_short_help = true, value_parser = choice(SCHEMES), default_value = "forward-euler")]
    pub scheme: Scheme,
    /// Retreat of the voltage that counts as a reversal, V: at least the noise of its reading. Where it is not given,
    /// eight standard deviations of that noise, and 0.083 % of the logs' voltage span at least.
    #[arg(long, hide_short_help = true, value_name = "V", allow_negative_numbers = true)]
    pub deadband: Option<f64>,
    /// What the displacement lags behind the voltage, amplifier and sensor included but for what --delay says, ms, as a
    /// data sheet or a step has it. Logs of one frequency do not tell it from hysteresis. The generalised
    /// Prandtl–Ishlinskii model alone keeps to it, and is what `identify` then takes where no model is named.
    #[arg(long, display_order = BEHIND, value_name = "MS", value_parser = positive, allow_negative_numbers = true)]
    pub lag: Option<f64>,
    /// How wide the limits may be within which the estimate is proven to stay, as a multiple of the training stroke.
    #[arg(long, hide_short_help = true, default_value_t = Conditions::default().limit, value_parser = limit, allow_negative_numbers = true)]
    pub limit: f64,
    /// Reading of the logs.
    #[command(flatten)]
    pub files: LogOptions,
    /// Preparation of the logs.
    #[command(flatten)]
    pub prepare: PrepareArgs,
}

impl Fitting {
    /// Puts the logs of a session of this board in its folder's place, with its tick where none was typed. Returns what
    /// is missing of the session, once that is said.
    pub fn open_session(&mut self, board: Option<&Path>) -> Result<Option<String>, BenchError> {
        let (else_held_out, folder) = (self.hold_out.is_some(), self.logs.first().cloned().unwrap_or_default());
        let (held_out, tick_us) = (&mut self.validate_on, &mut self.prepare.tick_us);
        let unfinished = open_session(&mut self.logs, held_out, else_held_out, tick_us, board)?;
        if let Some(unfinished) = &unfinished {
            eprintln!("piezo: careful: {}: {}", folder.display(), remedy::unfinished(&folder, unfinished));
        }
        Ok(unfinished.map(|unfinished| unfinished.to_string()))
    }

    /// The job, with its logs read: the choice of a model left to it, converters assumed.
    pub fn job(&self, search: SearchOptions) -> Result<Job> {
        let hold_out = findings::hold_out(self.hold_out, !self.validate_on.is_empty());
        ensure!((0.0..1.0).contains(&hold_out), "--hold-out must lie between 0 and 1, not {hold_out}");
        ensure!(self.deadband.is_none_or(|v| v >= 0.0 && v.is_finite()), "--deadband must be 0 or positive");
        // Together: what is said of all need not hold for each.
        let mut training = self.files.read_all(&[&self.logs[..], &self.validate_on].concat(), self.repair)?;
        let held_out = training.split_off(self.logs.len());
        Ok(Job {
            training,
            held_out,
            hold_out,
            as_judged: false,
            prepare: (&self.prepare).into(),
            model: ModelChoice::Auto,
            conditions: Conditions {
                scheme: self.scheme,
                deadband: self.deadband,
                limit: self.limit,
                lag_s: self.lag.map(|ms| 1e-3 * ms),
                repair: self.repair,
            },
            calibration: CalibrationOptions::default(),
            cost: Cost::from(self.cost).resolved()?,
            search,
        })
    }
}
