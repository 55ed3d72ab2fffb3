//! A model with its memory, to be stepped and copied: what probes of its behaviour need.

use estimator_core::{Engine, State, Table};

/// A running model.
#[derive(Clone, Debug)]
pub struct Walker {
    engine: Engine<f64>,
    /// The Voigt family's memory; the others have theirs in the engine.
    state: State<f64>,
    /// Where it starts, µm.
    start: Option<f64>,
}

impl Walker {
    /// A table's model in f64, long at rest at a voltage (V); at this displacement (µm) where it is known.
    pub fn new(table: &Table, voltage: f64, start: Option<f64>) -> Self {
        let engine = table.engine::<f64>();
        let rest = match &engine {
            Engine::Voigt(model) => model.drive(voltage) / model.rate(voltage),
            Engine::Other(_) => 0.0,
        };
        Self { engine, state: State::new(start.unwrap_or(rest), f64::from(table.deadband_v)), start }
    }

    /// The same without delay and resonance, as its inverse has it; whole where it has none.
    pub fn prompt(table: &Table, voltage: f64, start: Option<f64>) -> Self {
        let whole = Self::new(table, voltage, start);
        match &whole.engine {
            Engine::Other(model) => match model.prompt() {
                Some(prompt) => Self { engine: Engine::Other(prompt), ..whole },
                None => whole,
            },
            Engine::Voigt(_) => whole,
        }
    }

    /// One tick: takes its voltage (V), returns the displacement (µm) a tick later.
    pub fn step(&mut self, voltage: f64) -> f64 {
        match &mut self.engine {
            Engine::Voigt(model) => model.step(&mut self.state, voltage),
            Engine::Other(model) => model.step(voltage, self.start),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;
    use estimator_core::{Estimator, Model};
    use identification::cost::Feedback;

    #[test]
    fn it_goes_as_the_estimator_does_and_a_copy_goes_its_own_way() {
        let mut bench = small();
        bench.identify(Feedback::Simulation, &[Model::Voigt, Model::BoucWen], &mut |_, _| ());
        for model in [Model::Voigt, Model::BoucWen] {
            let table = &bench.candidate(Feedback::Simulation, model).unwrap().table;
            let mut estimator = Estimator::<f64>::new(table, None).unwrap();
            estimator.start_at(0.5);
            let mut walker = Walker::new(table, 0.0, Some(0.5));
            for tick in 0..100 {
                let voltage = 15.0 * (0.1 * f64::from(tick)).sin();
                walker.clone().step(-voltage);
                assert_eq!(walker.step(voltage), estimator.tick_volts(voltage).displacement, "{model} {tick}");
            }
        }
    }
}
