//! `piezo divider`: the resistors between an amplifier's monitor, or a sensor, and the board's pin, and what they cost.

use super::print::out;
use crate::option::{choice, span};
use ::calibration::span::Span;
use anyhow::{Result, ensure};
use clap::Args;
use divider::{CODES_A_STEP, Divider, FULL_SCALE, REFERENCE_V, Sampling, Series, series};
use serde_json::{Value, json};

/// Tolerances that resistors are sold with, each with the drift that is usual for it, of the value a kelvin: thick film, thin film.
const TOLERANCES: [(f64, f64); 2] = [(0.01, 100e-6), (0.001, 25e-6)];
/// How far off a supply is looked at, of its value.
const SUPPLY: f64 = 0.01;
/// A divider that uses less of the converter's range is remarked on.
const HALF: f64 = 0.5;
/// Change of temperature for which the drift is said, K.
const WARMER_K: f64 = 10.0;

/// Arguments of `piezo divider`.
#[derive(Args, Debug)]
pub struct DividerArgs {
    /// Lowest and highest voltage of the amplifier's monitor, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", required_unless_present = "sensor")]
    pub monitor: Option<Span>,
    /// Amplifier's output at these two voltages of its monitor, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", conflicts_with = "sensor")]
    pub amplifier: Option<Span>,
    /// Lowest and highest voltage of a displacement sensor's output, V.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "V:V", conflicts_with = "monitor")]
    pub sensor: Option<Span>,
    /// Displacement at these two voltages of the sensor, µm.
    #[arg(long, value_parser = span, allow_hyphen_values = true, value_name = "µm:µm", conflicts_with = "monitor")]
    pub displacement: Option<Span>,
    /// Values that the resistors are sold in.
    #[arg(long, value_parser = choice(SERIES), default_value = "e96")]
    pub series: Series,
    /// Print everything as JSON.
    #[arg(long)]
    pub json: bool,
}

const SERIES: [(Series, &str, &str); 2] =
    [(Series::E24, "e24", "24 values a decade"), (Series::E96, "e96", "96 values a decade")];

/// What is measured: the source, what its volts stand for in the end, and the line of board.toml.
struct Measured {
    /// What the pin reads, in a word.
    source: &'static str,
    /// What that stands for at the two ends, where it was said.
    stands_for: Option<Span>,
    /// What it stands for, in words, and its unit.
    of: (&'static str, &'static str),
    /// The field of board.toml, and the option that says the ends.
    field: (&'static str, &'static str),
}

/// Runs the verb.
pub fn run(arguments: &DividerArgs) -> Result<bool> {
    let monitor = Measured {
        source: "monitor",
        stands_for: arguments.amplifier,
        of: ("the amplifier", "V"),
        field: ("adc_span", "--amplifier V:V"),
    };
    let sensor = Measured {
        source: "sensor",
        stands_for: arguments.displacement,
        of: ("the displacement", "µm"),
        field: ("sensor_span", "--displacement µm:µm"),
    };
    let (volts, measured) = match (arguments.monitor, arguments.sensor) {
        (Some(volts), _) => (volts, monitor),
        (None, Some(volts)) => (volts, sensor),
        // The parser lets neither through alone.
        (None, None) => (Span { zero: 0.0, full: 0.0 }, monitor),
    };
    ensure!(volts.zero < volts.full, "{}:{}: name the lowest voltage first", volts.zero, volts.full);
    let ends = (volts.zero, volts.full);
    let found = Found { divider: Divider::choose(ends, arguments.series)?, ends, measured };
    match arguments.json {
        true => out(&serde_json::to_string_pretty(&found.json())?),
        false => found.lines().iter().for_each(|line| out(line)),
    }
    Ok(true)
}

/// A divider, and between which voltages of the source it is for, V.
struct Found {
    divider: Divider,
    ends: (f64, f64),
    measured: Measured,
}

impl Found {
    /// What a volt of the source stands for, in the unit of what is measured.
    fn a_volt(&self) -> Option<f64> {
        let stands_for = self.measured.stands_for?;
        Some((stands_for.full - stands_for.zero) / (self.ends.1 - self.ends.0))
    }

    /// What code 0 and the largest one stand for, in that unit.
    fn span(&self) -> Option<(f64, f64)> {
        let (stands_for, a_volt) = (self.measured.stands_for?, self.a_volt()?);
        let at = |volts: f64| stands_for.zero + a_volt * (volts - self.ends.0);
        let (zero, full) = self.divider.span();
        Some((at(zero), at(full)))
    }

    /// What the firmware makes of a wire that is off.
    fn open(&self) -> String {
        let (low, high) = self.ends;
        match self.divider.open() {
            Some(volts) if (low..=high).contains(&volts) => format!(
                "With the monitor's wire off, it reads as {volts:.3} V. Where the DAC does not drive the amplifier and the table's range \
                 holds that voltage, no flag tells it from an actuator at rest."
            ),
            Some(volts) => format!(
                "With the monitor's wire off, it reads as {volts:.3} V, which is beyond its range: a fault within a second."
            ),
            None => "With the monitor's wire off, the follower's input floats, and may read as any voltage.".to_owned(),
        }
    }

    fn lines(&self) -> Vec<String> {
        let (divider, (low, high)) = (&self.divider, self.ends);
        let &Measured { source, of: (of, unit), field: (field, option), .. } = &self.measured;
        let part = |name: &str, ohms: Option<f64>, between: &str| match ohms {
            Some(ohms) => format!("  {name} = {} {between}", series::ohms(ohms)),
            None => format!("  {name} is left out"),
        };
        let mut lines = vec![
            "Buy, and wire as in the book's chapter \"Bringing up a board\":".to_owned(),
            part("R1", Some(divider.r1), &format!("from the {source} to the node")),
            part("R2", divider.r2, "from the board's 3.3 V to the node"),
            part("R3", divider.r3, "from the node to GND"),
            "  a rail-to-rail follower on the board's 3.3 V behind the node, then 100 Ω, and 4.7 nF from the pin to GND"
                .to_owned(),
            format!(
                "R1 takes {:.1} mW at most.",
                1e3 * divider.watts_in_r1(low).max(divider.watts_in_r1(high))
            ),
            String::new(),
            format!("{low} … {high} V of the {source} are {:.3} … {:.3} V at the pin.", divider.pin(low), divider.pin(high)),
        ];
        let (zero, full) = divider.span();
        lines.push(format!("Codes 0 … {FULL_SCALE} are {zero:.3} … {full:.3} V of the {source}."));
        let a_code = divider.volts_a_code();
        let resolution = |unit: &str, scale: f64| {
            format!(
                "{:.4} {unit} a code, {:.3} {unit} a step of one conversion",
                scale * a_code,
                scale * a_code * CODES_A_STEP
            )
        };
        lines.push(format!("Resolution: {} of the {source}.", resolution("mV", 1e3)));
        if let Some(a_volt) = self.a_volt() {
            lines.push(format!("            {} of {of}.", resolution(unit, a_volt.abs())));
        }
        lines.push(String::new());
        for (tolerance, drift) in TOLERANCES {
            let (off, drifts) = (divider.off(self.ends, tolerance), divider.off(self.ends, drift * WARMER_K));
            let also = |volts: f64| {
                self.a_volt().map_or(String::new(), |scale| format!(" ({:.3} {unit} of {of})", volts * scale.abs()))
            };
            let (least, most) = divider.pin_within(self.ends, tolerance);
            lines.push(format!(
                "Resistors of {} %: off by {:.1} mV of the {source} at most{}, the pin at {least:.3} … {most:.3} V. `piezo calibrate` with two \
                 points takes that away, and their drift is left: with {:.0} ppm/K, {:.2} mV at most{} for {WARMER_K} K.",
                100.0 * tolerance,
                1e3 * off,
                also(off),
                1e6 * drift,
                1e3 * drifts,
                also(drifts)
            ));
        }
        let by_supply = Divider::off_by_supply(self.ends, SUPPLY);
        lines.push(format!(
            "A supply that is {} % off the one of the calibration: {:.1} mV at most, whatever the resistors; the firmware \
             corrects it.",
            100.0 * SUPPLY,
            1e3 * by_supply
        ));
        if source == "monitor" {
            lines.push(self.open());
        }
        let used = divider.used(self.ends);
        if used < HALF {
            lines.push(format!(
                "Only {:.0} % of the converter's range is used, and the resolution is that much worse: amplify the {source}'s output first.",
                100.0 * used
            ));
        }
        let sampling = Sampling::of(divider);
        lines.push(format!(
            "The node has {}. The firmware samples for {:.2} µs, sixteen times in a row: behind the follower, 100 Ω and 4.7 nF settle with \
             {:.2} µs, to {:.4} % of the difference to the other channel; without the follower it would be {:.1} µs, so it is needed.",
            series::ohms(divider.impedance()),
            1e6 * sampling.time_s,
            1e6 * sampling.filter_s,
            100.0 * sampling.missing,
            1e6 * sampling.bare_s,
        ));
        lines.push(String::new());
        match self.span() {
            Some((zero, full)) => {
                lines.push("For board.toml, until `piezo calibrate` has measured it:".to_owned());
                lines.push(format!("\n    {field} = [{zero:.3}, {full:.3}]   # {unit} at code 0 and at full scale\n    adc_full_scale = {FULL_SCALE}"));
                if field == "adc_span" {
                    lines.push(format!("\nor, as options: --adc-span {zero:.3}:{full:.3} --adc-full-scale {FULL_SCALE}"));
                }
            }
            None => lines.push(format!(
                "What the {source}'s volts stand for was not said: with {option} this prints the line {field} of board.toml."
            )),
        }
        lines
    }

    fn json(&self) -> Value {
        let (divider, (low, high)) = (&self.divider, self.ends);
        let tolerances = TOLERANCES.map(|(tolerance, drift)| {
            json!({
                "tolerance": tolerance,
                "off_v": divider.off(self.ends, tolerance),
                "drift_per_k": drift,
                "off_by_drift_v": divider.off(self.ends, drift * WARMER_K),
                "drift_over_k": WARMER_K,
                "pin_v": divider.pin_within(self.ends, tolerance),
            })
        });
        json!({
            "resistors_ohm": divider,
            "reference_v": REFERENCE_V,
            "source_v": [low, high],
            "pin_v": [divider.pin(low), divider.pin(high)],
            "codes_v": divider.span(),
            "open_v": divider.open(),
            "adc_full_scale": FULL_SCALE,
            "volts_a_code": divider.volts_a_code(),
            "unit": self.measured.of.1,
            "a_code": self.a_volt().map(|scale| scale.abs() * divider.volts_a_code()),
            self.measured.field.0: self.span(),
            "used": divider.used(self.ends),
            "off_by_a_hundredth_of_supply_v": Divider::off_by_supply(self.ends, SUPPLY),
            "tolerances": tolerances,
            "impedance_ohm": divider.impedance(),
            "sampling": Sampling::of(divider),
        })
    }
}
