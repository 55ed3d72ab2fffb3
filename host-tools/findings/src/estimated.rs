//! What was estimated from a log's voltage alone, in words.

use crate::micrometres::Micrometres;
use crate::raised::remarks;
use estimator_core::{Range, Status};
use identification::validate::{Estimates, Instant, Known, Raised, Zero};
use log_survey::begins_in_motion;
use serde_json::{Value, json};

/// A voltage that goes over less than this part of the table's range may be that of a monitor, of 1:10 and more.
const SMALL: f64 = 0.12;
/// So may one that is beyond that range for so much of the time, %.
const MOSTLY: f64 = 50.0;
/// A voltage within the table's range that goes over less than this part of it rests.
const RESTS: f64 = 0.005;

/// Why a ± may be too small, where a log's voltage moves from the first sample on.
pub(crate) const BEGINS_IN_MOTION: &str = "the voltage moves from the first sample on: if the actuator had not rested there until then, as it is taken to \
     have, what it still creeps from is in no ±";

/// The lines of a log: how many estimates, from where to where, how far they may be off, and where they are not to be
/// believed by a table of voltages in `table_v`, as they would be recorded; the actuator's are `scale` times those.
pub fn estimated(estimates: &Estimates, known: &Known, table_v: Range<f64>, scale: f64) -> Vec<String> {
    let all = &estimates.instants;
    let range = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high): (f64, f64), row| {
        (low.min(row.estimate), high.max(row.estimate))
    });
    let mut lines = vec![format!(
        "{}: {} estimates from the voltage alone, {:.3} … {:.3} µm by the training sensor's zero",
        estimates.log,
        all.len(),
        Micrometres(range.0),
        Micrometres(range.1)
    )];
    let widths: Vec<f64> = all.iter().filter_map(|row| row.half_width).collect();
    let mean = || Micrometres(widths.iter().sum::<f64>() / widths.len() as f64);
    lines.push(match (known, widths.is_empty()) {
        (Known::Nothing, _) => {
            "    the actuator is taken to have rested at the first voltage, and no ± is stated, since no displacement is known: \
             --zero-at <S>:<UM> says where it was at a time, best after a full swing, --start-at <UM> where at the first sample, in the \
             training sensor's µm"
                .to_owned()
        }
        (Known::Zero { at_s, .. }, true) => {
            format!(
                "    no ± is stated: the table has none, {at_s} s is too soon after the start for a zero, or the voltage is beyond the table's range"
            )
        }
        (Known::Start(_), true) => "    no ± is stated: the table has none, or the voltage is beyond its range".to_owned(),
        (Known::Zero { at_s, um }, false) => {
            let by = estimates.zero.map_or(String::new(), |zero| {
                format!(", {:+.3} µm from what was estimated before", Micrometres(zero.by_um))
            });
            format!("    {um} µm at {at_s} s{by}, and from then on ± {:.3} µm on average, 95 % of the time", mean())
        }
        (Known::Start(_), false) => format!("    ± {:.3} µm on average since the first sample, 95 % of the time", mean()),
    });
    if let Some(starts_um) = estimates.starts_um {
        lines.push(format!(
            "    at the first sample the model is at {:.3} µm: none of its memories at that voltage is where it was said to start, and what is \
             beyond is lost. Has the sensor another zero than in the training, or was the actuator still moving or creeping when the log began? --zero-at <S>:<UM> takes any",
            Micrometres(starts_um)
        ));
    }
    if estimates.zero.is_some_and(|zero| far(estimates, zero)) {
        lines.push(
            "    that is further off than the log moves in all: is it in µm, and by the sensor's zero in the training?"
                .to_owned(),
        );
    }
    let (times, volts): (Vec<f64>, Vec<f64>) = all.iter().map(|row| (row.time_s, row.voltage)).unzip();
    if !widths.is_empty() && begins_in_motion(&times, &volts) {
        lines.push(format!("    {BEGINS_IN_MOTION}; a zero that is told late leaves less of it"));
    }
    if estimates.left_out > 0 {
        lines.push(format!(
            "    {} more are left out (--repair): the log has no voltage there, and until the next full swing the estimates depend on its having \
             gone straight on",
            estimates.left_out
        ));
    }
    let raised = estimates.raised();
    lines.extend(scale_asked(estimates, table_v, scale).map(|asked| format!("    {asked}")));
    if let Some(unsettled) = raised.iter().find(|raised| raised.bit == Status::NOT_SETTLED) {
        lines.push(format!(
            "    {:.2} % of the time it still depends on where it was assumed to start (NOT_SETTLED)",
            unsettled.percent
        ));
    }
    lines.extend(Some(remarks(&raised)).filter(|said| !said.is_empty()).map(|said| format!("    {said}")));
    lines
}

/// Whether a zero is further from what was estimated than the log moves before or behind it.
fn far(estimates: &Estimates, zero: Zero) -> bool {
    let (before, behind) = estimates.instants.split_at(zero.instant.min(estimates.instants.len()));
    let moves = |part: &[Instant]| Range::of_values(part.iter().map(|row| row.estimate)).span();
    zero.by_um.abs() > moves(before).max(moves(behind))
}

/// What is asked where the voltages look like another's than the table's.
fn scale_asked(estimates: &Estimates, table_v: Range<f64>, scale: f64) -> Option<String> {
    let volts = Range::of_values(estimates.instants.iter().map(|row| row.voltage));
    let beyond = estimates.raised().into_iter().find(|raised| raised.bit == Status::VOLTAGE_OUT_OF_RANGE);
    let rests = volts.span() < RESTS * table_v.span() && table_v.contains(volts.middle());
    let asked =
        (volts.span() < SMALL * table_v.span() && !rests) || beyond.is_some_and(|beyond| beyond.percent > MOSTLY);
    let times = match scale {
        1.0 => String::new(),
        _ => format!(" of a log, whose volts are taken times {scale}"),
    };
    asked.then(|| {
        format!(
            "the voltage goes from {:.3} to {:.3} V, and the table is of {:.3} to {:.3} V{times}: is it a monitor's, or the amplifier's input, \
             or is the table another actuator's? Then all of this is wrong; --voltage-scale <N> is what the log's volts are times to be the \
             actuator's, 20 of a monitor 1:20, 1 of the actuator's own",
            volts.min, volts.max, table_v.min, table_v.max
        )
    })
}

/// The same as JSON: the log's name, the number of estimates, how often each status bit was raised, and what is asked
/// of the voltages.
pub fn estimated_json(estimates: &Estimates, table_v: Range<f64>, scale: f64) -> Value {
    let raised = estimates.raised().into_iter().map(|Raised { bit, percent, first_s }| {
        let name: String = bit.iter_names().map(|(name, _)| name).collect();
        json!({ "status": name, "percent": percent, "first_s": first_s })
    });
    json!({ "log": estimates.log, "estimates": estimates.instants.len(), "left_out": estimates.left_out, "starts_um": estimates.starts_um, "raised": raised.collect::<Vec<_>>(), "asked": scale_asked(estimates, table_v, scale) })
}
