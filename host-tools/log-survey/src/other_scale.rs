//! A log of several that moves much further a volt than the others, or much less far, as one in the actuator's volts
//! among those of a monitor.

use crate::signal::correlation;
use recordings::session::Session;
use serde::Serialize;

/// A log whose scale is not that of the others.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct OtherScale {
    /// Name of the log.
    pub log: String,
    /// What a volt moves in it, µm: the displacement's standard deviation by that of the voltage.
    pub um_per_v: f64,
    /// The same of the others: the middle one.
    pub others_um_per_v: f64,
}

/// Displacement and voltage that go together less say nothing of the scale: a rest, noise, a drive beyond the
/// resonance;
const TOGETHER: f64 = 0.5;
/// nor those that deviate by less, of what they do in the log where they do most.
const MOVES: f64 = 1e-3;
/// One actuator's differ by less, its smallest swings beyond its lag from its largest, slow ones.
const TIMES: f64 = 4.0;

/// The session that differs most from the others, where that is more than one actuator's do; of two there is no telling
/// which is wrong.
pub fn other_scale<'a>(sessions: impl Iterator<Item = &'a Session>) -> Option<OtherScale> {
    let together = sessions.filter(|session| correlation(session).abs() > TOGETHER);
    let mut moves: Vec<_> = together.map(Deviations::of).collect();
    let most = |of: fn(&Deviations<'_>) -> f64| moves.iter().map(of).fold(0.0, f64::max);
    let (most_um, most_v) = (most(|of| of.um), most(|of| of.v));
    moves.retain(|of| of.um > MOVES * most_um && of.v > MOVES * most_v);
    let differs = |index: usize| {
        let mut others: Vec<f64> = moves.iter().map(|of| of.um / of.v).collect();
        let um_per_v = others.swap_remove(index);
        others.sort_by(f64::total_cmp);
        // Of the middle two the geometric mean: one of them may be the wrong one.
        let (low, high) = (others.get(others.len().checked_sub(1)? / 2)?, others.get(others.len() / 2)?);
        Some(OtherScale { log: moves[index].log.to_owned(), um_per_v, others_um_per_v: (low * high).sqrt() })
    };
    let times = |of: &OtherScale| (of.um_per_v / of.others_um_per_v).ln().abs();
    let most = (0..moves.len()).filter_map(differs).max_by(|one, other| times(one).total_cmp(&times(other)))?;
    (times(&most) > TIMES.ln()).then_some(most)
}

/// Standard deviations of a session's displacement and voltage, at the measured instants.
struct Deviations<'a> {
    log: &'a str,
    um: f64,
    v: f64,
}

impl<'a> Deviations<'a> {
    fn of(session: &'a Session) -> Self {
        let voltage: Vec<f64> = session.instants.iter().map(|&instant| session.voltage[instant as usize]).collect();
        Self { log: &session.name, um: deviation(&session.displacement), v: deviation(&voltage) }
    }
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// So many volts, and so many µm at them.
    fn session(name: &str, volts: f64, um: f64) -> Session {
        let course: Vec<f64> = (0..1000).map(|k| libm::sin(f64::from(k) * 0.02)).collect();
        let of = |scale: f64| course.iter().map(|part| scale * part).collect();
        Session::new(name.into(), of(volts), (0..1000).collect(), of(um), 5e-4)
    }

    #[test]
    fn a_log_in_other_volts_is_named_wherever_it_stands() {
        let logs = [session("a", 5.0, 6.0), session("b", 2.5, 2.4), session("c", 100.0, 6.1)];
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0]] {
            let found = other_scale(order.iter().map(|&at| &logs[at])).unwrap();
            assert_eq!(found.log, "c");
            assert!((found.um_per_v - 0.061).abs() < 1e-9 && (0.96..1.2).contains(&found.others_um_per_v), "{found:?}");
        }
        let two = other_scale(logs[1..].iter()).unwrap();
        assert!(two.um_per_v.max(two.others_um_per_v) > 0.9, "{two:?}");
    }

    #[test]
    fn small_swings_rests_and_a_single_log_are_none() {
        let small = session("small", 0.5, 0.3);
        let still = Session::new("rest".into(), vec![1e-3; 50], (0..50).collect(), vec![4.0; 50], 5e-4);
        let drifts =
            Session { displacement: (0..1000).map(|k| 1e-3 * f64::from(k)).collect(), ..session("drift", 0.001, 0.0) };
        assert_eq!(other_scale([session("a", 5.0, 6.0), small, still, drifts].iter()), None);
        assert_eq!(other_scale([session("a", 5.0, 6.0)].iter()), None);
        assert_eq!(other_scale(std::iter::empty()), None);
    }
}
