//! What a start at an end of the voltage range leaves open, as far as the logs begin there.
//!
//! An end is come to from one side only, so that nothing of the start is open there, unless the actuator was driven beyond it
//! or has lost its polarisation since. Then the first swing is off, in the logs as on the board.

use estimator_core::interval::SPANS;
use estimator_core::{Admitted, Estimator, Range};
use identification::Problem;
use identification::settled::settled;
use recordings::session::Session;
use validation::ZERO_WINDOW_S;

/// A start says something of the ends where it leaves less than this open without them: in the outer seventh of the range.
const OUTER: f64 = 0.5;
/// Half-width for what the logs' first swings were off by: they are few, and others turn where those only came by.
const FEW: f64 = 1.5;

/// e, 0 … 1: the least with which m of no sweep, `memory_um`, holds what each training log's first swing is off by, and half as
/// much more, beside the `misfit_um` that is there always.
pub fn memory_at_ends(problem: &Problem, table: &Admitted, memory_um: f64, misfit_um: f64) -> f64 {
    let range: Range<f64> = table.voltage_range_v.of();
    let needed = problem.training().filter_map(|session| {
        let part = range.clamp(*session.voltage.first()?) - range.min;
        let open = 4.0 * part * (range.span() - part) / (range.span() * range.span());
        let beyond = (first_swing(table, session)?.powi(2) - misfit_um.powi(2)).max(0.0).sqrt();
        (open < OUTER).then_some((FEW * beyond / memory_um - open) / (1.0 - open))
    });
    needed.filter(|needed| needed.is_finite()).fold(0.0, f64::max).min(1.0)
}

/// What the estimate of a session that was zeroed at its start is off by in its first swing, µm: the largest mean of those while
/// the voltage had swept so many eighths of the range.
fn first_swing(table: &Admitted, session: &Session) -> Option<f64> {
    let mut estimator = Estimator::<f64>::new(table);
    let zero = f64::from(table.voltage_zero_v);
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
    let offs: Vec<(u32, &f64, f64)> = offs.take(settled(session)).skip(1).collect::<Option<_>>()?;
    let window = (ZERO_WINDOW_S / table.sample_period::<f64>()) as u32;
    let begun = mean(offs.iter().take_while(|(instant, ..)| *instant <= window.max(1)).map(|(.., off)| *off))?;
    let eighth = table.voltage_range_v.of::<f64>().span() / (SPANS - 1) as f64;
    let of = |number: usize| {
        let within = offs.iter().filter(move |(_, span, _)| (**span / eighth) as usize == number);
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

    /// e where the sensor reads what the table estimates, and `first_um` more in what comes before the first swing; that starts
    /// at this part of the range.
    fn learnt(part: f64, first_um: f64, misfit_um: f64) -> f64 {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/table/models");
        let (_, table) = table_files::read(&path.join("generalised-prandtl-ishlinskii.toml")).unwrap();
        let range: Range<f64> = table.voltage_range_v.of();
        let start = range.min + part * range.span();
        let swing = |tick: u32| 0.5 * range.span() * (1.0 - libm::cos(0.01 * f64::from(tick))) + range.min;
        let voltage: Vec<f64> =
            (0..3000).map(|tick| if tick < 1000 { start } else { swing(tick - 1000).max(start) }).collect();
        let mut estimator = Estimator::<f64>::new(&table);
        let volts = voltage.iter().map(|voltage| voltage + f64::from(table.voltage_zero_v));
        let estimates = volts.map(|volts| estimator.tick_volts(volts).displacement);
        let first = |(tick, estimate)| if tick < 1000 { estimate + first_um } else { estimate };
        let displacement = std::iter::once(first_um).chain(estimates.enumerate().map(first)).take(3000).collect();
        let session = Session::new("log".to_owned(), voltage, (0..3000).collect(), displacement, table.sample_period());
        memory_at_ends(&Problem::new(vec![session], Vec::new(), Conditions::default()), &table, M, misfit_um)
    }

    #[test]
    fn what_the_logs_first_swings_are_off_by_is_open_at_an_end() {
        for (first_um, expected) in [(0.0, 0.0), (0.5 * M, 0.75), (-0.5 * M, 0.75), (3.0 * M, 1.0)] {
            let found = learnt(0.0, first_um, 0.0);
            assert!((found - expected).abs() < 0.02, "{first_um} µm: {found}");
        }
        assert!((learnt(0.0, 0.5 * M, 0.3 * M) - 0.6).abs() < 0.02, "what is off there always is no start's");
        let beside = (0.75 - 0.19) / 0.81;
        assert!((learnt(0.05, 0.5 * M, 0.0) - beside).abs() < 0.02, "what is open there without it is taken off");
        assert_eq!(learnt(0.4, 0.5 * M, 0.0), 0.0, "a start in the middle says nothing of the ends");
    }
}
