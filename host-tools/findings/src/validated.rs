//! What a table's errors on a log are, and whether they say anything of the table, in words.

use crate::estimated::BEGINS_IN_MOTION;
use crate::micrometres::Micrometres;
use identification::validate::{Coverage, Evidence, Since, Suspicion, Told};

/// What the lines of a validation are.
const SIMULATED: &str =
    "Simulation from each log's first sample, by the f64 reference (MIL) and the f32 core of the target (SIL).";
const FIRST_READING: &str = "MIL, SIL         told the sensor's first reading, which the model starts from; a constant that the sensor is off by stays";
const OTHERS: &str = "\
cold             told nothing, as a device that is switched on: at rest for long at the first voltage
settled          the same from where reversals lie half of the table's voltage range apart
one cycle        cold; its mean error over a full cycle, the second one where enough follows it, is taken off; what follows is scored
no offset        cold; its own mean error over all that is scored is taken off, which no device knows beforehand
MAE, no offset   in each row, without the constant that leaves the least: the median error; RMS, no offset without the mean";

/// What the lines of a validation are, and, where it is zeroed, from when on it is scored.
pub fn explained(zero_at_s: Option<f64>, told: Told) -> Vec<String> {
    let zeroed = |at| {
        format!(
            "Zeroed at {at} s: the mean error of the 50 ms up to there is taken off; what follows is scored, {told}."
        )
    };
    // A device that is zeroed while it runs was told no first reading.
    let first_reading = zero_at_s.is_none().then(|| FIRST_READING.to_owned());
    let head = std::iter::once(SIMULATED.to_owned()).chain(first_reading);
    head.chain([OTHERS.to_owned()]).chain(zero_at_s.map(zeroed)).collect()
}

/// Why an estimate may be off that was zeroed before it had settled.
const UNSETTLED: &str = "it was zeroed before it had settled (NOT_SETTLED), and each larger swing then shows more of the memory that \
                         nobody knew at its start; a zero after a swing over half of the table's voltage range has that behind it. Else: ";

/// That a threshold was exceeded: the mean absolute error that is judged, µm and % of the stroke, and the most of each
/// that was allowed.
pub fn failed((um, percent): (f64, f64), (most_um, most_percent): (Option<f64>, Option<f64>)) -> String {
    let limit = |limit: Option<f64>, unit: &str| limit.map_or(String::new(), |limit| format!(" {limit} {unit}"));
    let (most_um, most_percent) = (limit(most_um, "µm"), limit(most_percent, "%"));
    format!("FAILED: {um:.4} µm, {percent:.2} % of the stroke; allowed:{most_um}{most_percent}")
}

/// Of an interval that holds less often, %, no constant is said to do as well.
const HALF: f64 = 50.0;

/// How the interval since something was told did.
pub fn held(since: &str, interval: &Coverage) -> String {
    let constant =
        format!(" (the smallest constant that holds as often: {:.3} µm)", Micrometres(interval.best_constant_um));
    format!(
        "± 95 %, {since}: holds the sensor {:.1} % of the time with {:.3} µm on average{}",
        interval.covered_percent,
        Micrometres(interval.half_width_um),
        if interval.covered_percent < HALF { "" } else { &constant }
    )
}

/// Why the errors on a log say little of the table, and what to look at.
pub fn suspicion(suspicion: &Suspicion) -> String {
    match suspicion {
        Suspicion::Another { evidence: all } => format!(
            "is it the actuator that the table was learnt from, and are unit, sign, columns and scale right (--columns, --sensor, --voltage-scale, --displacement-scale)? {}",
            all.iter().map(evidence).collect::<Vec<_>>().join("; ")
        ),
        Suspicion::Constant { offset_um, mae_um, without_um } => format!(
            "a constant {:+.3} µm is most of the error of {:.3} µm, and without it {:.3} µm are left: was the sensor \
             zeroed anew, has it drifted, or was the actuator still moving or creeping when the log began? `--told one-cycle` or `--zero-at <S>`, for <S> a time at which it is known, takes it off",
            Micrometres(*offset_um),
            Micrometres(*mae_um),
            Micrometres(*without_um)
        ),
        Suspicion::Narrow { since, held_percent, in_motion, unsettled } => format!(
            "the ±{} holds the sensor {held_percent:.1} % of the time, and says 95 % over many recordings: {}is something else here than in the \
             training: the way the voltage goes (steps and rests, say), the load, the temperature, the sensor's zero, scale or mount? If not, learn from this log, too: `piezo identify` takes several{}",
            match since {
                Since::Zero => " since the zero",
                Since::OneCycle => ", told one cycle,",
                Since::Either => "",
            },
            if *unsettled { UNSETTLED } else { "" },
            match (in_motion, since) {
                (false, _) => String::new(),
                (true, Since::Zero) =>
                    format!(". Besides, {BEGINS_IN_MOTION}; the later the zero, the less of it is left"),
                (true, _) => format!(
                    ". Besides, {BEGINS_IN_MOTION}; a zero that is told late (`--zero-at <S>`) leaves less of it"
                ),
            }
        ),
    }
}

fn evidence(evidence: &Evidence) -> String {
    match evidence {
        Evidence::Beyond { percent } => {
            format!("the voltage is beyond what the table was learnt on {percent:.0} % of the time")
        }
        Evidence::Span { measured_um, estimated_um } => format!(
            "the sensor goes over {:.3} µm where the table says {:.3} µm of the same voltages",
            Micrometres(*measured_um),
            Micrometres(*estimated_um)
        ),
        Evidence::Reversed { correlation } => format!(
            "the sensor falls where the table says that it rises (correlation {correlation:.2}): is it mounted the other way than in the \
             training (--displacement-scale of the other sign), or the voltage inverted (--voltage-scale)?"
        ),
        Evidence::Error { percent, training_um } => format!(
            "without any constant the error is {percent:.1} % of the stroke, and it was {:.3} µm in training",
            Micrometres(*training_um)
        ),
        Evidence::Interval { held_percent } => {
            format!("the ± holds the sensor {held_percent:.1} % of the time, and says 95 %")
        }
    }
}
