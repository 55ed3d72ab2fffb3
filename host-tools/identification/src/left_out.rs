//! What of the training data is left out in turn: whole logs, or a stretch of time of each.

use crate::problem::Problem;
use log_survey::read_where;
use log_survey::settled::{judged_once_settled, settled};
use recordings::session::Session;
use serde::Serialize;

/// Parts that are left out in turn; fewer where there are fewer logs, which are left out as a whole.
const PARTS: usize = 6;
/// Logs from which on whole logs are left out, and not a block of each.
const LOGS: usize = 3;

/// What is left out in turn.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum LeftOut {
    /// Whole logs, one or several at a time.
    Logs,
    /// A stretch of time of each log.
    Blocks,
}

/// Each problem is the whole without a part, which is what it holds out.
pub(crate) fn parts(problem: &Problem) -> (LeftOut, Vec<Problem>) {
    let logs: Vec<&Session> = problem.training().collect();
    if logs.len() >= LOGS {
        let count = logs.len().min(PARTS);
        let of = |part: usize| {
            let (out, kept): (Vec<_>, Vec<_>) = logs.iter().enumerate().partition(|(log, _)| log % count == part);
            let kept = kept.into_iter().map(|(_, &log)| log.clone()).collect();
            problem.of(kept, out.into_iter().map(|(_, log)| judged_once_settled(log)).collect())
        };
        return (LeftOut::Logs, (0..count).map(of).collect());
    }
    let of = |part: usize| {
        let (kept, out) = logs.iter().map(|log| without_block(log, part)).unzip();
        problem.of(kept, out)
    };
    let long = logs.iter().all(|log| log.instants.len() > 2 * PARTS);
    (LeftOut::Blocks, if long { (0..PARTS).map(of).collect() } else { Vec::new() })
}

/// A session without a block of what was measured once it had settled, and with that block alone. Both have the whole
/// voltage and the first measured instant, where the estimator starts.
fn without_block(session: &Session, part: usize) -> (Session, Session) {
    let first = settled(session).max(1);
    let measured = session.instants.len();
    let at = |part: usize| first + part * (measured - first) / PARTS;
    let block = at(part)..at(part + 1);
    (read_where(session, |index| !block.contains(&index)), read_where(session, |index| block.contains(&index)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Conditions;
    use crate::cost::Feedback;
    use crate::cross_validation::on_left_out;
    use crate::fixtures::{duhem, session};
    use recordings::rig::EXCITATIONS;

    #[test]
    fn a_block_is_left_out_and_judged_while_the_voltage_stays_whole() {
        let session = session(EXCITATIONS[0]);
        let mut judged = 0;
        for part in 0..PARTS {
            let (kept, out) = without_block(&session, part);
            assert!(kept.voltage == session.voltage && out.voltage == session.voltage);
            assert!(kept.instants[0] == 0 && out.instants[0] == 0);
            assert_eq!(kept.instants.len() + out.instants.len(), session.instants.len() + 1);
            assert!(out.instants[1] >= session.instants[settled(&session)], "the start is not judged");
            judged += out.instants.len() - 1;
        }
        let start = settled(&session);
        assert!(start > 100, "{start}");
        assert_eq!(judged, session.instants.len() - start);
    }

    /// A first swing that comes from where no model can begin, as that of an actuator which was
    /// driven elsewhere before.
    #[test]
    fn how_an_actuator_was_left_before_a_recording_decides_nothing() {
        let session = session(EXCITATIONS[0]);
        let mut otherwise = session.clone();
        otherwise.displacement.iter_mut().take(settled(&session)).skip(1).for_each(|reading| *reading += 3.0);
        let parameters = duhem();
        let error = |session: &Session| {
            let problem = Problem::new(vec![session.clone()], Vec::new(), Conditions::default());
            problem.error_once_settled(&parameters, Feedback::Simulation.into())
        };
        assert_eq!(error(&session), error(&otherwise));
        for part in 0..PARTS {
            assert_eq!(without_block(&session, part).1, without_block(&otherwise, part).1);
        }
        let logs = |session: &Session| {
            let problem = Problem::new(vec![session.clone(); LOGS], Vec::new(), Conditions::default());
            let (left_out, parts) = parts(&problem);
            assert_eq!(left_out, LeftOut::Logs);
            let judged = |part: &Problem| on_left_out(part, left_out, &parameters, Feedback::Simulation.into());
            parts.iter().map(judged).collect::<Vec<_>>()
        };
        assert_eq!(logs(&session), logs(&otherwise));
    }

    #[test]
    fn the_sensor_s_zero_of_a_log_decides_nothing() {
        let (parameters, cost) = (duhem(), Feedback::Simulation.into());
        let errors = |zeros: &[f64]| {
            let sessions = zeros.iter().zip(EXCITATIONS).map(|(zero, excitation)| {
                let of = session(excitation);
                let displacement = of.displacement.iter().map(|reading| reading + zero).collect();
                Session { displacement, ..of }
            });
            let problem = Problem::new(sessions.collect(), Vec::new(), Conditions::default());
            let (what, parts) = parts(&problem);
            let of_parts = parts.iter().map(|part| on_left_out(part, what, &parameters, cost));
            (what, [vec![problem.error_once_settled(&parameters, cost)], of_parts.collect()].concat())
        };
        for (what, zeros) in [(LeftOut::Logs, &[0.4, -0.7, 0.3][..]), (LeftOut::Blocks, &[0.4, -0.7])] {
            let (alike, apart) = (errors(&vec![0.0; zeros.len()]), errors(zeros));
            assert_eq!((alike.0, apart.0), (what, what));
            // What is told at the start stays in the memory for a while.
            let near = |(alike, apart): (&f64, &f64)| (apart / alike - 1.0).abs() < 0.2;
            assert!(alike.1.iter().zip(&apart.1).all(near), "{what:?}: {:?} µm, not {:?} µm", apart.1, alike.1);
        }
    }
}
