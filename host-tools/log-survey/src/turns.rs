//! What is held out of logs whose ends [go beyond](crate::ends_go_beyond) what was before.

use crate::half_cycle::large_reversals;
use estimator_core::Range;
use recordings::session::{Session, one_of_each};

/// Stretches of a session that are held out: of a log with ten amplitudes there is some of each in what is kept and in
/// what is not. Each, and what is kept beside it, has so many readings at least, where there are enough of them.
const STRETCHES: usize = 16;
const LEAST: usize = 4;
/// A start of more than this part of a session is none.
const LONGEST_START: f64 = 0.25;

/// A session without what was measured in stretches of it, with that alone, and how many they are. Together they are
/// the fraction `hold_out`, between 0 and 1, of what follows its start. Both have the whole voltage and the first
/// measured instant, where the estimator starts.
pub fn held_in_turns(session: &Session, hold_out: f64) -> (Session, Session, usize) {
    let first = start(session);
    let readings = session.instants.len() - first;
    let fewest = (hold_out.min(1.0 - hold_out) * readings as f64) as usize / LEAST;
    let stretches = STRETCHES.min(fewest).max(1);
    let each = readings / stretches;
    let length = ((hold_out * each as f64).round() as usize).clamp(each.min(1), each.max(2) - 1);
    // Where it begins differs from one to the next: they are of all phases of a periodic recording.
    let room = each - length.min(each) + 1;
    let begins: Vec<usize> = one_of_each(room, room * stretches).map(|begin| begin % room).collect();
    let held = |index: usize| {
        let Some(of) = index.checked_sub(first) else { return false };
        begins.get(of / each).is_some_and(|begin| (*begin..begin + length).contains(&(of % each)))
    };
    (read_where(session, |index| !held(index)), read_where(session, held), stretches)
}

/// A session with these of its readings, by their index, and the first, where the estimator starts; its voltage whole.
pub fn read_where(session: &Session, kept: impl Fn(usize) -> bool) -> Session {
    let indices = (0..session.instants.len()).filter(|index| *index == 0 || kept(*index));
    let (instants, displacement) = indices.map(|at| (session.instants[at], session.displacement[at])).unzip();
    Session { instants, displacement, ..session.clone() }
}

/// Index of the first reading behind a session's start, its second large reversal. How the actuator was left before
/// shows in its first swings, and all of that is to be learnt.
fn start(session: &Session) -> usize {
    let span = Range::of_values(session.voltage.iter().copied()).span();
    let end = large_reversals(&session.voltage, span).get(1).copied().unwrap_or(0);
    let first = session.instants.partition_point(|&instant| (instant as usize) < end);
    if first as f64 > LONGEST_START * session.instants.len() as f64 { 1 } else { first.max(1) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use recordings::rig::{EXCITATIONS, Rig};

    /// Ten cycles of 10 Hz each of these amplitudes, V.
    fn ladder(amplitudes: &[f64]) -> Session {
        let cycle = |k: u32| (std::f64::consts::TAU * 5e-3 * f64::from(k)).sin();
        let voltage: Vec<f64> = amplitudes.iter().flat_map(|volts| (0..2_000).map(move |k| volts * cycle(k))).collect();
        let instants = (0..voltage.len() as u32).collect();
        Session::new("ladder".to_owned(), voltage.clone(), instants, voltage, 5e-4)
    }

    #[test]
    fn stretches_of_all_phases_are_held_out_and_the_start_is_not() {
        let log = Rig { duration: 1.0, ..Rig::default() }.log(EXCITATIONS[1]);
        let instants = (0..log.voltage.len() as u32).collect();
        let sine = Session::new(log.name, log.voltage, instants, log.displacement.unwrap(), log.sample_period);
        for session in [sine, ladder(&[20.0, 40.0, 60.0, 80.0]), ladder(&[100.0, 60.0, 30.0])] {
            let from = start(&session);
            assert!(from > 50 && 4 * from < session.instants.len(), "{from}");
            for hold_out in [0.05, 0.2, 0.5, 0.9] {
                let (kept, held, stretches) = held_in_turns(&session, hold_out);
                assert!(kept.voltage == session.voltage && held.voltage == session.voltage);
                assert_eq!((stretches, kept.instants[0], held.instants[0]), (STRETCHES, 0, 0));
                let part = (held.instants.len() - 1) as f64 / (session.instants.len() - from) as f64;
                assert!((part - hold_out).abs() < 0.02, "{part}");
                let mut all = [&kept.instants[..], &held.instants[1..]].concat();
                all.sort_unstable();
                assert_eq!(all, session.instants);
                assert!(held.instants[1] >= session.instants[from]);
                for part in 0..4 {
                    let quarter = part * session.voltage.len() / 4..(part + 1) * session.voltage.len() / 4;
                    let within = |of: &Session| of.instants.iter().any(|&at| quarter.contains(&(at as usize)));
                    assert!(within(&kept) && within(&held), "{part}");
                }
            }
        }
    }

    #[test]
    fn neither_part_of_a_short_session_is_empty() {
        let long = ladder(&[20.0]);
        for count in 3..40 {
            for hold_out in [0.001, 0.3, 0.5, 0.999] {
                let (instants, displacement) = (long.instants[..count].to_vec(), long.displacement[..count].to_vec());
                let short = Session { instants, displacement, ..long.clone() };
                let (kept, held, _) = held_in_turns(&short, hold_out);
                assert_eq!(kept.instants.len() + held.instants.len(), count + 1);
                assert!(kept.instants.len() > 1 && held.instants.len() > 1, "{count} readings, {hold_out}");
            }
        }
    }
}
