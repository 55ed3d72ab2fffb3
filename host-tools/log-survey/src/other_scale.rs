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
    /// How many others there are; of two logs there is no telling which is wrong.
    pub others: usize,
}

/// Displacement and voltage that go together less say nothing of the scale: a rest, noise, a drive that lags far behind
/// or is beyond the resonance.
const TOGETHER: f64 = 0.9;
/// A log in which neither deviates by so much, of what the middle one does, shows creep and drift rather than a motion.
const MOVES: f64 = 0.1;
/// One actuator's differ by less, its smallest swings beyond its lag from its largest, slow ones. An undamped
/// resonance makes more of a drive that is within an eighth of it.
const TIMES: f64 = 4.0;

/// The session that differs most from the others, where that is more than one actuator's do.
pub fn other_scale<'a>(sessions: impl Iterator<Item = &'a Session>) -> Option<OtherScale> {
    let together = sessions.filter(|session| correlation(session).abs() > TOGETHER);
    let mut moves: Vec<_> = together.map(Deviations::of).collect();
    let middle = |of: fn(&Deviations<'_>) -> f64| middle(moves.iter().map(of).collect());
    let (middle_um, middle_v) = (middle(|of| of.um)?, middle(|of| of.v)?);
    moves.retain(|of| of.um > MOVES * middle_um || of.v > MOVES * middle_v);
    let differs = |index: usize| {
        let mut others: Vec<f64> = moves.iter().map(|of| of.um / of.v).collect();
        let um_per_v = others.swap_remove(index);
        let (log, count) = (moves[index].log.to_owned(), others.len());
        Some(OtherScale { log, um_per_v, others_um_per_v: self::middle(others)?, others: count })
    };
    let times = |of: &OtherScale| (of.um_per_v / of.others_um_per_v).ln().abs();
    let most = (0..moves.len()).filter_map(differs).max_by(|one, other| times(one).total_cmp(&times(other)))?;
    (times(&most) > TIMES.ln()).then_some(most)
}

/// The middle one of some numbers, of an even count the geometric mean of the two, one of which may be a wrong log's;
/// `None` of none.
pub fn middle(mut of: Vec<f64>) -> Option<f64> {
    of.sort_by(f64::total_cmp);
    let (low, high) = (of.get(of.len().checked_sub(1)? / 2)?, of.get(of.len() / 2)?);
    Some((low * high).sqrt())
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
    fn a_log_in_other_volts_or_another_unit_is_named_wherever_it_stands() {
        let others = [session("a", 5.0, 6.0), session("b", 2.5, 2.4)];
        for (volts, um) in [(20.0, 1.0), (1e3, 1.0), (1e-3, 1.0), (1.0, 1e3), (1.0, 1e-3)] {
            let odd = session("odd", 5.0 * volts, 6.1 * um);
            for order in
                [[&others[0], &others[1], &odd], [&odd, &others[0], &others[1]], [&others[1], &odd, &others[0]]]
            {
                let found = other_scale(order.into_iter()).unwrap();
                assert_eq!((&*found.log, found.others), ("odd", 2), "{volts} {um}");
                assert!((found.um_per_v / (1.22 * um / volts) - 1.0).abs() < 1e-9, "{found:?}");
                assert!((0.96..1.2).contains(&found.others_um_per_v), "{found:?}");
            }
        }
        let two = other_scale([&others[0], &session("c", 100.0, 6.0)].into_iter()).unwrap();
        assert!(two.others == 1 && (two.um_per_v / two.others_um_per_v).ln().abs() > 20f64.ln() - 1e-9, "{two:?}");
    }

    #[test]
    fn small_swings_rests_creep_and_a_single_log_are_none() {
        let a = session("a", 5.0, 6.0);
        let course = |of: &dyn Fn(f64) -> f64| (0..1000).map(|k| of(f64::from(k) / 1000.0)).collect::<Vec<f64>>();
        let with = |voltage: Vec<f64>, displacement: Vec<f64>| {
            Session::new("other".into(), voltage, (0..1000).collect(), displacement, 5e-4)
        };
        let rest = with(vec![1e-3; 1000], vec![4.0; 1000]);
        // Held behind a step, while the voltage drifts by a two hundredth of the range.
        let creep = with(course(&|t| 4.0 + 0.03 * t), course(&|t| 5.0 + 0.25 * (1.0 + 99.0 * t).log10()));
        assert!(correlation(&creep) > 0.7, "{}", correlation(&creep));
        for other in [session("small", 0.5, 0.3), rest, creep] {
            assert_eq!(other_scale([&a, &session("b", 3.0, 3.3), &other].into_iter()), None);
        }
        assert_eq!(other_scale([&a].into_iter()), None);
        assert_eq!(other_scale(std::iter::empty()), None);
    }
}
