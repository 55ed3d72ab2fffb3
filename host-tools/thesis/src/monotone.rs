//! Whether a model can be inverted tick by tick: from each memory that it comes to along the logs, the displacement of
//! the next tick over this tick's voltage, within what the logs' voltage moves in a tick.
//!
//! Where that rises strictly from every memory, any displacement within reach has exactly one voltage. A delay and a
//! resonance are left out, as the inverse leaves them out.

use estimator_core::{Engine, Process, Table};
use recordings::session::Session;
use serde::Serialize;

/// Memories that are probed a log.
const PROBED: usize = 100;
/// Voltages tried from each.
const VOLTAGES: usize = 21;
/// From one of them to the next the displacement must rise by more than this, as a fraction of the stroke.
const RISES: f64 = 1e-7;

/// What the probes found.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default, Serialize)]
pub struct Probes {
    /// Memories that were probed.
    pub probed: usize,
    /// From which the displacement falls somewhere.
    pub falling: usize,
    /// From which it does not fall, but stays somewhere.
    pub flat: usize,
}

impl Probes {
    /// Probes a model along some logs. `stroke` in µm.
    pub fn of<'a>(table: &Table, sessions: impl Iterator<Item = &'a Session> + Clone, stroke: f64) -> Self {
        let range = (f64::from(table.voltage_range_v.min), f64::from(table.voltage_range_v.max));
        let steps = sessions.clone().flat_map(|session| session.voltage.windows(2));
        let reach = steps.filter_map(|pair| Some((pair.last()? - pair.first()?).abs())).fold(0.0, f64::max);
        let mut probes = Self::default();
        for session in sessions {
            let start = session.displacement.first().copied();
            let whole = table.engine::<f64>();
            let mut model = whole.monotone_part().unwrap_or(whole);
            let every = session.voltage.len().div_ceil(PROBED).max(1);
            for (tick, pair) in session.voltage.windows(2).enumerate() {
                let &[now, next] = pair else { continue };
                model.step(now, start);
                if tick % every == 0 {
                    // The logs' own next voltage is among what can come.
                    let (low, high) = ((now - reach).max(range.0).min(next), (now + reach).min(range.1).max(next));
                    probes.add(&model, low, high, RISES * stroke);
                }
            }
        }
        probes
    }

    fn add(&mut self, model: &Engine<f64>, low: f64, high: f64, rises: f64) {
        let at = |n: usize| low + (high - low) * n as f64 / (VOLTAGES - 1) as f64;
        let reached: Vec<f64> = (0..VOLTAGES).map(|n| model.peek(at(n))).collect();
        let least =
            reached.windows(2).filter_map(|pair| Some(pair.last()? - pair.first()?)).fold(f64::INFINITY, f64::min);
        self.probed += 1;
        if least < -rises {
            self.falling += 1;
        } else if least <= rises {
            self.flat += 1;
        }
    }

    /// Whether it rose from everywhere.
    pub fn invertible(&self) -> bool {
        self.probed > 0 && self.falling == 0 && self.flat == 0
    }

    /// Memories from which it rises, %.
    pub fn rising_percent(&self) -> f64 {
        100.0 * (self.probed - self.falling - self.flat) as f64 / self.probed.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;
    use estimator_core::{List, Model, Parameters, PrandtlIshlinskiiParameters};
    use identification::cost::Feedback;

    #[test]
    fn plays_rise_where_the_first_has_no_width_and_stay_where_it_has() {
        let mut bench = small();
        bench.identify(Feedback::Simulation, &[Model::PrandtlIshlinskii], &mut |_, _| ());
        let table = *bench.candidate(Feedback::Simulation, Model::PrandtlIshlinskii).unwrap().table;
        let probe = |table: &Table| Probes::of(table, bench.problem().training(), 8.0);
        let found = probe(&table);
        assert!((400..=510).contains(&found.probed) && found.falling == 0, "{found:?}");
        let Parameters::PrandtlIshlinskii(of) = table.parameters else { panic!("{:?}", table.parameters) };
        // Plays alone, of which the one without width weighs so much, and the fourth something.
        let with = |first: f32| {
            let weight = |i: usize| [first, 0.0, 0.0, 0.1].get(i).copied().unwrap_or(0.0);
            let weights_um_per_v = List::collect((0..of.thresholds_v.len()).map(weight)).unwrap();
            let (dead_zones_um, dead_zone_slopes) = (List::collect([]).unwrap(), List::collect([]).unwrap());
            let of = PrandtlIshlinskiiParameters { weights_um_per_v, dead_zones_um, dead_zone_slopes, ..of };
            probe(&Table { parameters: Parameters::PrandtlIshlinskii(of), ..table })
        };
        assert!(with(0.2).invertible());
        let stays = with(0.0);
        assert!(stays.flat > 0 && stays.falling == 0 && !stays.invertible(), "{stays:?}");
        assert_eq!(with(0.2).rising_percent(), 100.0);
    }
}
