//! What a start at an end of the voltage range leaves open, as far as the logs begin at rest there.
//!
//! An end is come to from one side only, so that nothing of the start is open there, unless the actuator was
//! driven beyond it, or has lost its polarisation since, or never had it. Then the first swing is off, in the logs
//! as on the board.

use estimator_core::interval::SPANS;
use estimator_core::{Admitted, Estimator, Range};
use identification::Problem;
use log_survey::settled;
use recordings::session::Session;
use remanence::rests_v;
use validation::ZERO_WINDOW_S;

/// A start says something of the ends where it leaves less than this open without them: all but the middle third
/// of the range.
const OUTER: f64 = 0.9;
/// A start that leaves less than this open is one at an end, and says how little an end leaves open; others, how
/// much at least.
const AT_END: f64 = 0.25;
/// e where no log begins at rest there: what nobody has seen is neither nothing nor all that a start in the
/// middle leaves open.
const UNSEEN: f64 = 0.5;
/// Times what the logs' first swings were off by: logs are few, and another recording may turn where these passed.
const FEW: f64 = 1.5;

/// e, as the worst of the training logs that begin at rest near an end of the table's range says it: the least, from 0
/// up, with which b·`memory_um` is [`FEW`] times what that log's first swing was off by beyond `misfit_um`; [`UNSEEN`]
/// where none begins there. Beyond 1 no memory that the model can start with explains that swing, as where an actuator
/// was never driven before: then a start leaves e times as much open wherever it is.
pub fn memory_at_ends(problem: &Problem, table: &Admitted, memory_um: f64, misfit_um: f64) -> f64 {
    let range: Range<f64> = table.voltage_range_v.of();
    // How much a log's start leaves open without e, and the e that it needs.
    let of = |session: &Session| {
        // A log that begins in motion is one of an actuator that the drive before it has left as it would be.
        let part = range.clamp(rests_v(session)?) - range.min;
        let open = 4.0 * part * (range.span() - part) / (range.span() * range.span());
        let beyond = (off_in_first_swing(table, session)?.powi(2) - misfit_um.powi(2)).max(0.0).sqrt();
        let share = FEW * beyond / memory_um;
        let needed = if share > 1.0 { share } else { (share - open) / (1.0 - open) };
        ((open < OUTER || share > 1.0) && needed.is_finite()).then_some((open, needed))
    };
    let starts: Vec<(f64, f64)> = problem.training().filter_map(of).collect();
    let at_an_end = starts.iter().filter(|(open, _)| *open < AT_END).map(|(_, needed)| *needed).reduce(f64::max);
    starts.iter().map(|(_, needed)| *needed).fold(at_an_end.unwrap_or(UNSEEN), f64::max).max(0.0)
}

/// What the estimate of a session is off by in its first swing, µm, relative to its first 50 ms: the mean while
/// each eighth of the table's range was swept, the largest of these. `None` where nothing was measured in that
/// swing but its beginning.
fn off_in_first_swing(table: &Admitted, session: &Session) -> Option<f64> {
    let mut estimator = Estimator::<f64>::new(table);
    let zero = f64::from(table.voltage_zero_v);
    if let Some(rest) = session.rested_v {
        estimator.tick_volts(rest + zero);
    }
    let estimates: Vec<f64> =
        session.voltage.iter().map(|voltage| estimator.tick_volts(voltage + zero).displacement).collect();
    let mut swept = Range::point(*session.voltage.first()?);
    let spans: Vec<f64> = session
        .voltage
        .iter()
        .map(|&voltage| {
            swept = swept.include(voltage);
            swept.span()
        })
        .collect();
    // An estimate is of the tick that follows; the first has none.
    let before = |instant: u32| (instant as usize).saturating_sub(1);
    let offs = session.instants.iter().zip(&session.displacement).map(|(&instant, sensor)| {
        let tick = before(instant);
        Some((instant, spans.get(tick)?, estimates.get(tick)? - sensor))
    });
    let offs: Vec<(u32, &f64, f64)> = offs.take(settled::first_swing(session)).skip(1).collect::<Option<_>>()?;
    let window = (ZERO_WINDOW_S / table.sample_period::<f64>()) as u32;
    // One reading at least, however rare they are.
    let begins = offs.partition_point(|(instant, ..)| *instant <= window).max(1).min(offs.len());
    let begun = mean(offs[..begins].iter().map(|(.., off)| *off))?;
    let eighth = table.voltage_range_v.of::<f64>().span() / (SPANS - 1) as f64;
    let of = |number: usize| {
        let within = offs[begins..].iter().filter(move |(_, span, _)| (**span / eighth) as usize == number);
        mean(within.map(|(.., off)| *off - begun)).map(f64::abs)
    };
    (0..SPANS).filter_map(of).reduce(f64::max)
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0u32), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use identification::Conditions;
    use std::path::Path;

    const M: f64 = 2.0;

    /// A sensor that reads what the table estimates, and `first_um` more in what comes before the first swing; that
    /// starts at this part of the range after so many ticks of 3000, and the sensor is read at every so manieth.
    struct Log {
        part: f64,
        first_um: f64,
        rests: u32,
        every: usize,
        /// Part of the range that the actuator had rested at before.
        rested: Option<f64>,
    }

    const LOG: Log = Log { part: 0.0, first_um: 0.5 * M, rests: 1000, every: 1, rested: None };

    fn learnt(log: &Log, misfit_um: f64) -> f64 {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/table/models");
        let (_, table) = table_files::read(&path.join("generalised-prandtl-ishlinskii.toml")).unwrap();
        let range: Range<f64> = table.voltage_range_v.of();
        let start = range.min + log.part * range.span();
        let swing = |tick: u32| 0.5 * range.span() * (1.0 - libm::cos(0.01 * f64::from(tick))) + range.min;
        let voltage: Vec<f64> = (0..3000).map(|tick| swing(u32::saturating_sub(tick, log.rests)).max(start)).collect();
        let mut estimator = Estimator::<f64>::new(&table);
        let rested_v = log.rested.map(|part| range.min + part * range.span());
        if let Some(rest) = rested_v {
            estimator.tick_volts(rest + f64::from(table.voltage_zero_v));
        }
        let volts = voltage.iter().map(|voltage| voltage + f64::from(table.voltage_zero_v));
        let estimates = volts.map(|volts| estimator.tick_volts(volts).displacement);
        let first = |(tick, estimate)| if tick < log.rests as usize { estimate + log.first_um } else { estimate };
        let read: Vec<f64> = std::iter::once(log.first_um)
            .chain(estimates.enumerate().map(first))
            .take(3000)
            .step_by(log.every)
            .collect();
        let instants = (0..3000).step_by(log.every).collect();
        let session =
            Session { rested_v, ..Session::new("log".to_owned(), voltage, instants, read, table.sample_period()) };
        memory_at_ends(&Problem::new(vec![session], Vec::new(), Conditions::default()), &table, M, misfit_um)
    }

    #[test]
    fn what_the_logs_first_swings_are_off_by_is_open_at_an_end() {
        for (first_um, expected) in [(0.0, 0.0), (0.5 * M, 0.75), (-0.5 * M, 0.75), (3.0 * M, 4.5)] {
            let found = learnt(&Log { first_um, ..LOG }, 0.0);
            assert!((found - expected).abs() < 0.02, "{first_um} µm: {found}");
        }
        assert!((learnt(&LOG, 0.3 * M) - 0.6).abs() < 0.02, "what is off there always is no start's");
        let beside = (0.75 - 0.19) / 0.81;
        assert!(
            (learnt(&Log { part: 0.05, ..LOG }, 0.0) - beside).abs() < 0.02,
            "what is open without it is taken off"
        );
        assert_eq!(learnt(&Log { part: 0.4, ..LOG }, 0.0), UNSEEN, "a start in the middle says nothing of the ends");
        let beyond = learnt(&Log { part: 0.5, first_um: 2.0 * M, ..LOG }, 0.0);
        assert!((beyond - 3.0).abs() < 0.1, "but where no memory explains it: {beyond}");
        let sound = learnt(&Log { part: 0.3, first_um: 0.1 * M, ..LOG }, 0.0);
        assert_eq!(sound, UNSEEN, "a good start between says not that an end is good");
    }

    /// With its memory of the rest the estimate is right.
    #[test]
    fn a_log_is_run_from_where_the_actuator_had_rested_and_says_something_of_that() {
        let rested = |part: f64| learnt(&Log { part: 0.05, first_um: 0.0, rested: Some(part), ..LOG }, 0.0);
        assert_eq!(rested(0.0), 0.0, "at an end nothing is open");
        assert_eq!(rested(0.9), UNSEEN, "a good start between says not that an end is good");
    }

    #[test]
    fn neither_rare_readings_nor_a_late_swing_hide_it() {
        // 75 ms apart, where what comes first is 50 ms.
        let rare = learnt(&Log { every: 150, ..LOG }, 0.0);
        assert!((rare - 0.75).abs() < 0.02, "{rare}");
        let late = learnt(&Log { rests: 2000, ..LOG }, 0.0);
        assert!((late - 0.75).abs() < 0.02, "{late}");
    }
}
