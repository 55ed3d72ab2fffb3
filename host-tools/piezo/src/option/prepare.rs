//! How logs are prepared.

use super::choice::{Choice, choice};
use super::number::{auto_or, delay_or_auto, factor, not_negative};
use clap::Args;
use recordings::prepare::{AutoOr, Decimation, PrepareOptions, Recipe};

/// How logs are prepared.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Preparation of the logs (recorded in the table)")]
pub struct PrepareArgs {
    /// Tick, µs; 500, the thesis's 2 kHz, where none is typed and the logs are no training session's, which
    /// has its board's.
    #[arg(long, hide_short_help = true, value_parser = clap::value_parser!(u32).range(10..=1_000_000), allow_negative_numbers = true)]
    pub tick_us: Option<u32>,
    /// Factor on the recorded voltage, to that at the actuator: 20 of a monitor 1:20, the amplifier's gain
    /// of its input.
    #[arg(long, help_heading = None::<&str>, default_value_t = 1.0, value_parser = factor, allow_negative_numbers = true)]
    pub voltage_scale: f64,
    /// Factor on the recorded displacement.
    #[arg(long, default_value_t = 1.0, value_parser = factor, allow_negative_numbers = true)]
    pub displacement_scale: f64,
    /// Voltage (V, scaled) that the model calls 0, or `auto`: 0 where the logs reach it, else the middle
    /// of their swing.
    #[arg(long, hide_short_help = true, default_value = "auto", value_parser = auto_or, allow_negative_numbers = true, value_name = "V|auto")]
    pub voltage_zero: AutoOr,
    /// Displacement (µm, scaled) that the model calls 0, or `auto`: where the sensor stands when the voltage is
    /// at its zero.
    #[arg(long, hide_short_help = true, default_value = "auto", value_parser = auto_or, allow_negative_numbers = true, value_name = "µm|auto")]
    pub displacement_zero: AutoOr,
    /// How much later the sensor shows a displacement than it happens, ms, or `auto`: what the logs tell from a lag.
    #[arg(long, default_value = "0", value_parser = delay_or_auto, allow_negative_numbers = true, value_name = "MS|auto")]
    pub delay: AutoOr,
    /// Largest delay that `--delay auto` takes, ms: what the sensor can have.
    #[arg(long, hide_short_help = true, default_value_t = 5.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub max_delay: f64,
    /// Cut off the start of each log, s (a start-up transient).
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_start: f64,
    /// Cut off the end of each log, s.
    #[arg(long, default_value_t = 0.0, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_end: f64,
    /// What becomes of a log faster than the tick.
    #[arg(long, value_parser = choice(DECIMATIONS), default_value = "every")]
    pub decimate: Decimation,
}

/// What is done to logs otherwise than a table's recipe says.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Preparation of the logs (instead of the table's)")]
pub struct PrepareAgain {
    /// Factor on the recorded voltage, instead of the table's: 20 of a monitor 1:20, 1 of the amplifier's output.
    #[arg(long, help_heading = None::<&str>, value_parser = factor, allow_negative_numbers = true)]
    pub voltage_scale: Option<f64>,
    /// Cut off the start of each log, s.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_start: Option<f64>,
    /// Cut off the end of each log, s.
    #[arg(long, value_parser = not_negative, allow_negative_numbers = true)]
    pub skip_end: Option<f64>,
    /// What becomes of a log faster than the tick.
    #[arg(long, value_parser = choice(DECIMATIONS))]
    pub decimate: Option<Decimation>,
}

impl PrepareAgain {
    /// The recipe with what was typed in its place.
    pub fn instead_of(&self, recipe: Recipe) -> Recipe {
        Recipe {
            voltage_scale: self.voltage_scale.unwrap_or(recipe.voltage_scale),
            skip_start_s: self.skip_start.unwrap_or(recipe.skip_start_s),
            skip_end_s: self.skip_end.unwrap_or(recipe.skip_end_s),
            decimation: self.decimate.unwrap_or(recipe.decimation),
            ..recipe
        }
    }
}

/// How a log faster than the tick is reduced.
const DECIMATIONS: [Choice<Decimation>; 2] = [
    (Decimation::Every, "every", "The sample at each tick, interpolated linearly where the rates are no multiples"),
    (Decimation::Average, "average", "The mean of each n samples; the rates must be multiples"),
];

impl From<&PrepareArgs> for PrepareOptions {
    fn from(arguments: &PrepareArgs) -> Self {
        let &PrepareArgs { tick_us, voltage_scale, displacement_scale, voltage_zero, displacement_zero, .. } =
            arguments;
        let &PrepareArgs { delay, max_delay, skip_start, skip_end, decimate, .. } = arguments;
        let tick_us = tick_us.unwrap_or(Self::default().tick_us);
        let prepare =
            Self { tick_us, voltage_scale, displacement_scale, voltage_zero, displacement_zero, ..Self::default() };
        Self { delay, max_delay, skip_start, skip_end, decimate, ..prepare }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    #[derive(Parser)]
    struct Cli {
        #[command(flatten)]
        options: PrepareArgs,
    }

    #[test]
    fn what_is_given_is_taken_and_nonsense_refused() {
        let parsed = |arguments: &[&str]| {
            let cli = Cli::try_parse_from(["piezo"].iter().chain(arguments))?;
            Ok::<_, clap::Error>(PrepareOptions::from(&cli.options))
        };
        assert_eq!(parsed(&[]).unwrap(), PrepareOptions::default());
        let given = ["--voltage-zero", "-1.5", "--displacement-zero", "7", "--voltage-scale", "10", "--delay", "2.5"];
        let expected = PrepareOptions {
            voltage_zero: AutoOr::Given(-1.5),
            displacement_zero: AutoOr::Given(7.0),
            voltage_scale: 10.0,
            delay: AutoOr::Given(2.5),
            ..PrepareOptions::default()
        };
        assert_eq!(parsed(&given).unwrap(), expected);
        for wrong in [
            ["--delay", "soon"],
            ["--delay", "1000"],
            ["--voltage-scale", "0"],
            ["--skip-start", "-1"],
            ["--voltage-zero", "inf"],
        ] {
            assert!(parsed(&wrong).is_err(), "{wrong:?}");
        }
    }
}
