//! The frequencies at which a model holds: its mean absolute error on held-out logs, in % of each log's own stroke.

use super::bench::Bench;
use super::hysteresis::Loop;
use estimator_core::Admitted;
use identification::StraightLine;
use identification::validate::compare;
use recordings::prepare::PrepareError;
use recordings::rig::{Excitation, Waveform};
use recordings::session::Session;
use serde::Serialize;

/// A model holds at a frequency where its error stays below this, % of the stroke.
pub const HOLDS: f64 = 5.0;

/// Triangles that the rig is driven by for this, Hz; none of them is modelled.
const TRIANGLES: [(&str, u32); 9] = [
    ("tr2", 2),
    ("tr5", 5),
    ("tr10", 10),
    ("tr20", 20),
    ("tr50", 50),
    ("tr80", 80),
    ("tr120", 120),
    ("tr160", 160),
    ("tr200", 200),
];

/// Held-out sessions by frequency, Hz, the slowest first.
pub struct Frequencies {
    sessions: Vec<(f64, Session)>,
    line: Option<StraightLine>,
}

/// A model's error at a frequency.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Held {
    /// Frequency of its voltage, Hz.
    pub hertz: f64,
    /// MAE, % of the stroke of the log of this frequency.
    pub mae_percent: f64,
    /// That of the straight line through the modelling logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub straight_line_percent: Option<f64>,
}

impl Frequencies {
    /// The rig driven at frequencies that were not modelled, or the held-out logs of a user, at their own.
    ///
    /// # Errors
    /// A log cannot be prepared.
    pub fn of(bench: &Bench) -> Result<Self, PrepareError> {
        let mut sessions = Vec::new();
        if let Some(rig) = &bench.rig {
            let recipe = &bench.prepared.context.recipe;
            for (name, hertz) in TRIANGLES {
                let log = rig.log(Excitation { name, waveform: Waveform::Triangle, hertz });
                sessions.push((f64::from(hertz), recipe.session(&recipe.cut(&log))?));
            }
        } else {
            for session in bench.problem().validation() {
                let time: Vec<f64> = (0..session.voltage.len()).map(|tick| tick as f64 * session.tick_s).collect();
                let hertz = Loop::of(&time, &session.voltage, &session.voltage).frequency_hz;
                sessions.extend(hertz.map(|hertz| (hertz, session.clone())));
            }
            sessions.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Ok(Self { sessions, line: StraightLine::fit(bench.problem().training()) })
    }

    /// The frequencies, Hz.
    pub fn hertz(&self) -> impl Iterator<Item = f64> {
        self.sessions.iter().map(|(hertz, _)| *hertz)
    }

    /// A table's error at each.
    pub fn errors(&self, table: &Admitted) -> Vec<Held> {
        let error = |(hertz, session): &(f64, Session)| Held {
            hertz: *hertz,
            mae_percent: compare(table, session).mil.mae_percent,
            straight_line_percent: self.line.map(|line| line.errors(session).mae_percent),
        };
        self.sessions.iter().map(error).collect()
    }
}

/// The stretches of tested frequencies at which a model holds, in words.
pub fn words(errors: &[Held]) -> String {
    let holds = |held: &&Held| held.mae_percent < HOLDS;
    let stretches =
        errors.chunk_by(|a, b| holds(&a) == holds(&b)).filter(|stretch| stretch.first().as_ref().is_some_and(holds));
    let words: Vec<String> = stretches
        .filter_map(|stretch| {
            let (first, last) = (stretch.first()?.hertz, stretch.last()?.hertz);
            Some(if first == last { hertz(first) } else { format!("{}–{}", hertz(first), hertz(last)) })
        })
        .collect();
    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
}

/// A frequency as people write it.
pub fn hertz(hertz: f64) -> String {
    let text = format!("{hertz:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::super::without_lag::without_lag;
    use super::*;
    use estimator_core::Model;
    use identification::cost::Feedback;

    #[test]
    fn stretches_are_told_by_their_ends() {
        let held = |errors: &[f64]| -> String {
            let hertz = [1.0, 2.5, 10.0, 100.0];
            words(
                &errors
                    .iter()
                    .zip(hertz)
                    .map(|(&mae_percent, hertz)| Held { hertz, mae_percent, straight_line_percent: None })
                    .collect::<Vec<_>>(),
            )
        };
        assert_eq!(held(&[1.0, 4.9, 5.0, 2.0]), "1–2.5, 100");
        assert_eq!(held(&[9.0, 9.0, 9.0, f64::NAN]), "none");
        assert_eq!(held(&[0.0; 4]), "1–100");
    }

    #[test]
    fn a_model_without_lag_fails_at_high_frequencies() {
        let mut bench = small();
        bench.identify(Feedback::Simulation, &[Model::PrandtlIshlinskii], &mut |_, _| ());
        let table = bench.candidate(Feedback::Simulation, Model::PrandtlIshlinskii).unwrap().table;
        let last = |table| {
            let errors = Frequencies::of(&bench).unwrap().errors(table);
            assert_eq!(errors.len(), TRIANGLES.len());
            errors.last().unwrap().mae_percent
        };
        let table_without = without_lag(&table).unwrap().admit().unwrap();
        let (with, without) = (last(&table), last(&table_without));
        assert!(without > 15.0 && with < 0.6 * without, "{with} with its lag, {without} without");
        let errors = Frequencies::of(&bench).unwrap().errors(&table);
        // The line is the farther off where the model holds.
        let slow = errors[0];
        assert!(slow.straight_line_percent.is_some_and(|line| line > slow.mae_percent), "{slow:?}");
        bench.rig = None;
        let own: Vec<f64> = Frequencies::of(&bench).unwrap().hertz().collect();
        assert!(own.len() == 1 && (own[0] - 10.0).abs() < 0.05, "{own:?}");
    }
}
