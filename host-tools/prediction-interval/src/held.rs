//! What the actuator's own recordings ask for, since a zero within them.

use crate::gains::{COVERED, quantile};
use crate::told::{PARTS, Recording, Sample, judged};
use estimator_core::{Admitted, IntervalParameters};
use identification::{Candidate, Problem};
use rayon::prelude::*;
use recordings::session::Session;
use validation::ZERO_WINDOW_S;

/// The model that was learnt without what was held out, and what it was judged on.
#[derive(Clone, Copy, Debug)]
pub struct Judged<'a> {
    /// What it was learnt from and, where something was held out, judged on.
    pub problem: &'a Problem,
    /// The model as it was learnt without what was held out.
    pub candidate: &'a Candidate,
}

/// The half-width where nothing else counts (µm) with which the interval holds so much of what was held out as it says,
/// after zeros within it; of the training, where nothing was, or no reading of it follows a zero.
pub fn misfit(judged: Judged<'_>, parameters: &IntervalParameters) -> f64 {
    let Judged { problem, candidate } = judged;
    let of = |sessions: Vec<&Session>| -> Vec<Recording> {
        sessions.into_par_iter().flat_map_iter(|session| recordings(&candidate.table, parameters, session)).collect()
    };
    let mut found = of(problem.validation().collect());
    if found.is_empty() {
        found = of(problem.training().collect());
    }
    quantile(found.iter().flatten().map(left), COVERED).unwrap_or(0.0)
}

/// The misfit (µm) at which the half-width is just this error; 0 where the other parts are that wide.
fn left(sample: &Sample) -> f64 {
    let Sample { error, parts: [_, others @ ..] } = sample;
    let others: [f64; PARTS - 1] = *others;
    (error * error - others.iter().map(|part| part * part).sum::<f64>()).max(0.0).sqrt()
}

/// What follows the tellings within what a session is judged on.
fn recordings(table: &Admitted, parameters: &IntervalParameters, session: &Session) -> Vec<Recording> {
    let Some(&first) = session.instants.get(session.lead_in) else { return Vec::new() };
    let ticks = |seconds: f64| (seconds / session.tick_s).ceil() as usize;
    // The first telling has a window of readings before it.
    let from = (first as usize + ticks(ZERO_WINDOW_S)).max(ticks(parameters.earliest_s.into()));
    judged(table, parameters, session, from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::{Estimator, Table};

    /// A session of a sine whose sensor reads what the table estimates, at each tick of so many, and `off_um` more from
    /// the reading `off_from` on.
    fn session(table: &Admitted, rested_v: Option<f64>, every: usize, (off_from, off_um): (usize, f64)) -> Session {
        let voltage: Vec<f64> = (0..20_000).map(|k| 1.8 - 1.5 * (f64::from(k) * 2e-3).cos()).collect();
        let mut estimator = Estimator::<f64>::new(table);
        let zero = f64::from(table.voltage_zero_v);
        if let Some(rest) = rested_v {
            estimator.tick_volts(rest + zero);
        }
        let estimates: Vec<f64> = voltage.iter().map(|volts| estimator.tick_volts(volts + zero).displacement).collect();
        let instants: Vec<u32> = (0..voltage.len()).step_by(every).map(|instant| instant as u32).collect();
        let read = |(k, &instant): (usize, &u32)| {
            estimates[(instant as usize).saturating_sub(1)] + if k < off_from { 0.0 } else { off_um }
        };
        let displacement = instants.iter().enumerate().map(read).collect();
        Session { rested_v, ..Session::new("a".to_owned(), voltage, instants, displacement, 5e-4) }
    }

    fn table() -> Admitted {
        Table::parse(include_bytes!("../../../tests/data/table/generalised-prandtl-ishlinskii/table.bin")).unwrap()
    }

    const PARAMETERS: IntervalParameters = IntervalParameters::constant(1.0);

    /// The largest error after each telling, µm.
    fn errors(table: &Admitted, session: &Session) -> Vec<f64> {
        let largest = |of: &Recording| of.iter().map(|sample| sample.error).fold(0.0, f64::max);
        recordings(table, &PARAMETERS, session).iter().map(largest).collect()
    }

    #[test]
    fn an_estimate_that_is_the_sensor_s_leaves_nothing_however_it_began_and_is_read() {
        let table = table();
        for (rested_v, every) in [(None, 1), (Some(0.1), 1), (None, 10), (Some(0.1), 10), (None, 2_000)] {
            let errors = errors(&table, &session(&table, rested_v, every, (0, 0.0)));
            assert!(errors.len() == 4 && errors.iter().all(|um| *um < 1e-9), "{rested_v:?}, {every}: {errors:?}");
        }
        let forgotten = Session { rested_v: None, ..session(&table, Some(0.1), 1, (0, 0.0)) };
        assert!(errors(&table, &forgotten)[0] > 1e-3, "the rest counts");
    }

    #[test]
    fn what_was_learnt_from_is_run_through_and_not_judged() {
        let table = table();
        // Off by 5 µm from the middle on: the first two are told before.
        let whole = session(&table, None, 10, (1_000, 5.0));
        assert!(errors(&table, &whole)[0] > 4.9);
        let half = Session { lead_in: 1_000, ..whole };
        assert!(errors(&table, &half).iter().all(|um| *um < 1e-9), "a constant within what is judged is told");
    }

    #[test]
    fn an_error_within_the_other_parts_leaves_nothing() {
        let of = |error| left(&Sample { error, parts: [9.0, 0.3, 0.0, 0.4, 0.0, 0.0] });
        assert!(of(0.4) == 0.0 && (of(1.3) - 1.2).abs() < 1e-12, "{}", of(1.3));
    }
}
