//! The stage between the board's output and the amplifier's input, and what it gives when something is off, in words.

use crate::{DividerError, OUTPUT_PIN_V, REFERENCE_V, Series, Stage, series};

/// Tolerance for which the farthest voltages are said.
pub const TOLERANCE: f64 = 0.01;
/// A stage that uses less of the DAC's range is remarked on.
const HALF: f64 = 0.5;
/// The smaller of the two resistors that hold A2 while its pin floats, kΩ: the low-pass behind it does not
/// show on them.
const HOLDING_KOHM: f64 = 100.0;

/// A stage, what it is for, and what the amplifier makes of it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OutputStage {
    /// The resistors around the operational amplifier.
    pub stage: Stage,
    /// Lowest and highest voltage that the amplifier's input is to be given, V.
    pub ends_v: (f64, f64),
    /// Amplifier's output at these, V, where it was said.
    pub amplifier_v: Option<(f64, f64)>,
}

impl OutputStage {
    /// The stage of standard resistors for an input of so many volts.
    ///
    /// # Errors
    /// There is none.
    pub fn choose(ends_v: (f64, f64), amplifier_v: Option<(f64, f64)>, series: Series) -> Result<Self, DividerError> {
        Ok(Self { stage: Stage::choose(ends_v, series)?, ends_v, amplifier_v })
    }

    /// The amplifier's output by the voltage at its input, V.
    fn amplified(&self, input_v: f64) -> Option<f64> {
        let (at_low, at_high) = self.amplifier_v?;
        let (low, high) = self.ends_v;
        Some(at_low + (at_high - at_low) * (input_v - low) / (high - low))
    }

    /// `(in words) V at the input[, V at the amplifier's output]`.
    fn said(&self, input_v: f64) -> String {
        // A negative zero is no sign of anything.
        let rounded = |volts: f64, digits: i32| (volts * 10f64.powi(digits)).round() / 10f64.powi(digits) + 0.0;
        let amplified = self.amplified(input_v).map(|volts| format!(", {:.2} V of the amplifier", rounded(volts, 2)));
        format!("{:.3} V{}", rounded(input_v, 3), amplified.unwrap_or_default())
    }

    /// The input's voltage where the amplifier's output is nearest to 0 V, or its input where that is not known, and
    /// the resistors to 3.3 V and to GND that hold A2 there, kΩ.
    pub fn holding(&self) -> (f64, Option<(f64, f64)>) {
        let (low, high) = self.ends_v;
        let zero = self.amplifier_v.map_or(0.0, |(at_low, at_high)| low - at_low * (high - low) / (at_high - at_low));
        let rest = zero.clamp(low, high);
        let pin = self.stage.pin(rest);
        let ratio = (REFERENCE_V - pin) / pin;
        let pair = (ratio.is_finite() && ratio > 0.0).then(|| {
            let other = |kohm: f64| series::nearest(1e3 * kohm) / 1e3;
            if ratio > 1.0 {
                (other(ratio * HOLDING_KOHM), HOLDING_KOHM)
            } else {
                (HOLDING_KOHM, other(HOLDING_KOHM / ratio))
            }
        });
        (rest, pair)
    }

    /// Lowest and highest voltage at the amplifier's input that any code gives, V, with resistors of
    /// so much [`TOLERANCE`].
    pub fn output_within_v(&self) -> (f64, f64) {
        self.stage.output_within(TOLERANCE)
    }

    /// What to buy, what the amplifier is given, and what it is given when something is off, as lines.
    pub fn lines(&self) -> Vec<String> {
        let (stage, (low, high)) = (&self.stage, self.ends_v);
        let (zero, _) = stage.span();
        let (least, most) = self.output_within_v();
        let mut lines = vec![
            "Buy, and wire as in the book's chapter \"Bringing up a board\":".to_owned(),
            "  the low-pass at A2, 4.7 kΩ and 68 nF, to the non-inverting input of an operational amplifier".to_owned(),
            series::part("RF", Some(stage.rf), "from its output to its inverting input"),
            series::part("RG", stage.rg, "from the inverting input to GND"),
            series::part("RO", stage.ro, "from the board's 3.3 V to the inverting input"),
            format!(
                "  on a supply of its own that lets it reach {low} … {high} V; not the board's 3.3 V, and nothing of it back to a pin of the board"
            ),
            String::new(),
            format!(
                "{low} … {high} V at the amplifier's input are {:.3} … {:.3} V at A2.",
                stage.pin(low),
                stage.pin(high)
            ),
            format!(
                "A2 at {:.3} V, 7 % above its lowest, as low as it should go: {}.",
                OUTPUT_PIN_V.0,
                self.said(stage.output(OUTPUT_PIN_V.0))
            ),
            format!(
                "A2 at {:.3} V, as high as it should go: {}.",
                OUTPUT_PIN_V.1,
                self.said(stage.output(OUTPUT_PIN_V.1))
            ),
            format!(
                "With resistors of {} % no code gives less than {least:.2} V or more than {most:.2} V, unless the stage's supply ends sooner: \
                 the amplifier must stand both.",
                100.0 * TOLERANCE
            ),
        ];
        let used = stage.used(self.ends_v);
        if used < HALF {
            lines.push(format!(
                "Only {:.0} % of the DAC's range is used, and its steps are that much larger.",
                100.0 * used
            ));
        }
        lines.extend([
            String::new(),
            "What it gives when something is off, the amplifier being on:".to_owned(),
            format!("  the board without power (A2 and its 3.3 V at 0 V): {}", self.said(0.0)),
            format!("  A2 at 0 V, the board's 3.3 V there: {}", self.said(zero)),
            "  the stage without its supply: nobody knows; give the amplifier's input a resistor to ground, or switch the amplifier on last"
                .to_owned(),
        ]);
        if let (rest, Some((up, down))) = self.holding() {
            lines.push(format!(
                "  A2 floating, as in reset: some {}, where {up:.0} kΩ from A2 to 3.3 V and {down:.0} kΩ from A2 to GND hold it",
                self.said(rest)
            ));
        }
        lines
    }

    /// Amplifier's output with A2 at 0 V and at 3.3 V, V.
    pub fn drive_span(&self) -> Option<(f64, f64)> {
        let (zero, full) = self.stage.span();
        Some((self.amplified(zero)?, self.amplified(full)?))
    }
}
