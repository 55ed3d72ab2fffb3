//! What in a log is no measurement, in words.

use identification::Job;
use log_survey::{Flaw, Found, Stretch};
use recordings::log::Log;

/// What the gravest of a log's flaws of one kind is, where there are `count` of them, without the log's name.
pub fn flaw(worst: &Flaw, count: usize) -> String {
    let Stretch { from_s, to_s } = worst.at();
    let times = if count == 1 { String::new() } else { format!(" {count} times, the gravest") };
    match worst {
        Flaw::Spike { leap_um, back: true, .. } => {
            format!("the displacement leaps away and back{times} by {leap_um:.3} µm at {from_s:.4} s")
        }
        Flaw::Spike { leap_um, back: false, .. } => format!(
            "the displacement leaps{times} by {leap_um:.3} µm at {from_s:.4} s, where the log begins or ends (a line cut in mid-number?)"
        ),
        Flaw::Frozen { voltage_v, .. } => format!(
            "the displacement stands still{times} from {from_s:.4} to {to_s:.4} s while the voltage moves by {voltage_v:.2} V \
             (a sensor beyond its range, off, or read too slowly)"
        ),
        Flaw::Clipped { voltage_v, .. } => format!(
            "the voltage stands at {voltage_v:.4} V{times} from {from_s:.4} to {to_s:.4} s while the displacement goes and comes \
             back (an input beyond its range)"
        ),
        Flaw::VoltageSpike { leap_v, .. } => format!(
            "the voltage leaps{times} by {leap_v:.3} V at {from_s:.4} s for a few rows at most, or in the last row, and the displacement is not \
             seen to go along (an interference, a number misread, or a pulse too short to show)"
        ),
        Flaw::Hole { .. } => {
            let which = if count == 1 { String::new() } else { format!("{count} times, the longest time ") };
            format!(
                "the file has no number for the voltage or the displacement, or no row, {which}from {from_s:.4} to {to_s:.4} s"
            )
        }
        Flaw::Step { leap_um, .. } => format!(
            "the displacement steps{times} by {leap_um:+.3} µm near {from_s:.4} s, where the voltage does not, and goes on at that level (a sensor \
             that was touched or lost count, or recordings with other zeros that were joined)"
        ),
        Flaw::Missing { leap_v, leap_um, .. } => format!(
            "voltage and displacement leap together{times} from {from_s:.4} to {to_s:.4} s, by {leap_v:.3} V and {leap_um:.3} µm, and go on as \
             before: samples may be missing here, unless the drive leapt or recordings were joined"
        ),
    }
}

/// The same beside errors that were scored over it, or without it where it was `repaired`.
pub fn flaw_scored(worst: &Flaw, count: usize, repaired: bool) -> String {
    let so = match worst {
        Flaw::Missing { .. } => "the errors above take it for one course",
        Flaw::Step { .. } if repaired => "the errors above take what lies behind it back by that",
        _ if repaired => "the errors above leave it out",
        Flaw::Step { .. } => {
            "the errors above take it for a measurement; --repair takes what lies behind it back by that"
        }
        _ => "the errors above take it for a measurement; --repair leaves it out",
    };
    format!("{}: {so}", flaw(worst, count))
}

/// What helps where a log has more holes than one may have.
pub(crate) const TOO_MANY_HOLES: &str =
    "no log may have so many holes, and --repair does not help; record it again, or use what lies before or behind";

/// The same with its row, counted from 1, before anything is learnt.
pub fn flaw_found(found: &Found, too_many_holes: bool) -> String {
    let Found { worst, count, first_row } = found;
    let helps = match worst {
        Flaw::Hole { .. } if too_many_holes => TOO_MANY_HOLES,
        Flaw::Step { .. } => "--repair of identify takes what lies behind it back by that",
        _ if worst.repairable() => "--repair of identify leaves it out",
        _ => "nothing can repair that; record it again, or use what lies before it or behind",
    };
    format!("{}, row {}: {helps}", flaw(worst, *count), first_row + 1)
}

/// Each flaw of the logs of a job, in the order of the logs and their kinds: the log's name, where it is, and
/// what, in words.
pub fn flaws(job: &Job) -> Vec<(String, Stretch, String)> {
    let of = |log: &Log| {
        let found = log_survey::flaws(&job.prepare.cut(log));
        found.iter().map(|of| (log.name.clone(), of.at(), flaw(of, 1))).collect::<Vec<_>>()
    };
    job.training.iter().chain(&job.held_out).flat_map(of).collect()
}

/// What in a log is no measurement, what it does, and what helps.
pub(crate) fn flawed(log: &str, worst: &Flaw, count: usize, left_out: bool, most: bool) -> String {
    let what = flaw(worst, count);
    match (worst, left_out) {
        (Flaw::Missing { .. }, _) => format!(
            "in {log} {what}. If they are, the model is learnt and judged over a course that never was, and --repair cannot mend it: record it \
             again, or keep what lies before it or behind with --skip-end or --skip-start"
        ),
        (Flaw::VoltageSpike { .. }, true) => format!(
            "in {log} {what}: what was measured there was left out, and the voltage is taken to go straight from the row before to the row \
             behind (--repair); record it again without"
        ),
        (Flaw::Hole { .. }, true) => format!(
            "in {log} {what}: what was measured there was left out, and the voltage is taken to go straight on (--repair); where it reversed \
             there, what was learnt of the next swing is wrong by that"
        ),
        (Flaw::Step { .. }, _) if left_out || most => format!(
            "in {log} {what}: what was measured behind it was taken back by that (--repair), which is as exact as the step is sharp; record it \
             again without"
        ),
        (Flaw::Step { .. }, _) => format!(
            "in {log} {what}, and it was learnt and judged as if the actuator had stepped: record it again, or have what lies behind it taken back \
             with --repair"
        ),
        (_, true) => {
            format!("in {log} {what}: what was measured there was left out (--repair); record it again without")
        }
        (_, false) if most => format!(
            "in {log} {what}, and more than half of the log is no measurement: nothing was left out, and it was learnt and judged as if it were \
             so; record it again"
        ),
        (_, false) => format!(
            "in {log} {what}, and it was learnt and judged as if it were so: record it again, or leave it out with --repair"
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_flaw_is_said_with_its_time_and_what_repair_does_to_it() {
        let at = Stretch { from_s: 1.25, to_s: 1.2505 };
        let spike = Flaw::VoltageSpike { at, leap_v: 300.0 };
        let found_of = |worst| flaw_found(&Found { worst, count: 1, first_row: 2_500 }, false);
        let (found, scored) = (found_of(spike), flaw_scored(&spike, 2, false));
        assert!(
            found.contains("leaps by 300.000 V at 1.2500 s")
                && found.ends_with("row 2501: --repair of identify leaves it out"),
            "{found}"
        );
        assert!(scored.contains("leaps 2 times, the gravest by 300.000 V"), "{scored}");
        let (as_it_is, repaired) = (flawed("a", &spike, 1, false, false), flawed("a", &spike, 1, true, false));
        assert!(
            as_it_is.ends_with("leave it out with --repair") && repaired.contains("straight from the row before"),
            "{repaired}"
        );
        let step = Flaw::Step { at, leap_um: -5.0 };
        let (found, doubt) = (found_of(step), flawed("a", &step, 1, false, false));
        assert!(
            found.contains("steps by -5.000 µm near 1.2500 s")
                && found.ends_with("takes what lies behind it back by that"),
            "{found}"
        );
        assert!(doubt.ends_with("have what lies behind it taken back with --repair"), "{doubt}");
        assert!(flawed("a", &step, 1, true, false).contains("was taken back by that (--repair)"));
        let missing = Flaw::Missing { at, leap_v: 3.0, leap_um: 0.4 };
        let (found, doubt) = (found_of(missing), flawed("a", &missing, 1, false, false));
        assert!(
            found.contains("samples may be missing here, unless the drive leapt or recordings were joined, row 2501: nothing can repair that"),
            "{found}"
        );
        assert!(
            doubt.contains("from 1.2500 to 1.2505 s, by 3.000 V and 0.400 µm")
                && doubt.contains("--repair cannot mend it"),
            "{doubt}"
        );
        assert!(flaw_scored(&missing, 1, true).ends_with("for one course"));
    }
}
