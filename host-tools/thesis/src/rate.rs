//! Rate dependence of a model: one and the same sequence of voltages, once at a tick each and once a hundred times
//! slower. A model without rate dependence gives the same displacements at the same voltages whatever the speed.

use estimator_core::{Process, Table};
use recordings::rig::{Excitation, Rig, Waveform};
use serde::Serialize;

/// Ticks of the fast triangle's period; 100 Hz at 500 µs.
const FAST: u32 = 20;
/// How many times slower the slow one is.
const SLOWER: u32 = 100;
/// Periods of the slow one; the last counts.
const PERIODS: u32 = 4;
/// A change of stroke or width by more than this much of the slow stroke, %, is rate dependence.
pub const DEPENDENT: f64 = 1.0;

/// Loops of a model at two frequencies.
#[derive(Clone, Copy, PartialEq, Debug, Serialize)]
pub struct Rate {
    /// The lower frequency, Hz.
    pub slow_hz: f64,
    /// The higher frequency, Hz.
    pub fast_hz: f64,
    /// Stroke at the lower one, µm.
    pub slow_stroke_um: f64,
    /// Stroke at the higher one, µm.
    pub fast_stroke_um: f64,
    /// Largest widths, % of the slow stroke.
    pub slow_width_percent: f64,
    /// Loop's width at the higher one, % of its stroke.
    pub fast_width_percent: f64,
}

impl Rate {
    /// Measures a model on the triangle between two voltages, V.
    pub fn of(table: &Table, low: f64, high: f64) -> Self {
        let fast_hz = 1.0 / (f64::from(FAST) * f64::from(table.sample_period_us) * 1e-6);
        Self::from(&settled(table, low, high, SLOWER), &settled(table, low, high, 1), fast_hz)
    }

    /// Measures the rig itself, without its sensor's noise, at 1 and 100 Hz. `None` where its samples are too few.
    pub fn of_rig(rig: &Rig) -> Option<Self> {
        let still = Rig { noise_nm: 0.0, duration: f64::from(PERIODS), ..rig.clone() };
        let last = |hertz: u32| -> Option<Vec<f64>> {
            let log = still.record(Excitation { name: "triangle", waveform: Waveform::Triangle, hertz });
            let period = (still.fs / f64::from(hertz)).round() as usize;
            let every = period / FAST as usize;
            let start = log.displacement.len().checked_sub(period)?;
            (every > 0).then(|| log.displacement.into_iter().skip(start).step_by(every).take(FAST as usize).collect())
        };
        Some(Self::from(&last(1)?, &last(SLOWER)?, f64::from(SLOWER)))
    }

    fn from(slow: &[f64], fast: &[f64], fast_hz: f64) -> Self {
        let (slow_stroke_um, slow_width) = measured(slow);
        let (fast_stroke_um, fast_width) = measured(fast);
        Self {
            slow_hz: fast_hz / f64::from(SLOWER),
            fast_hz,
            slow_stroke_um,
            fast_stroke_um,
            slow_width_percent: 100.0 * slow_width / slow_stroke_um,
            fast_width_percent: 100.0 * fast_width / slow_stroke_um,
        }
    }

    /// Change of the stroke from slow to fast, % of the slow one.
    pub fn stroke_change(&self) -> f64 {
        100.0 * (self.fast_stroke_um / self.slow_stroke_um - 1.0)
    }

    /// Whether stroke or width changes by more than [`DEPENDENT`].
    pub fn dependent(&self) -> bool {
        let width = self.fast_width_percent - self.slow_width_percent;
        // What is not a number depends.
        !(self.stroke_change().abs() <= DEPENDENT && width.abs() <= DEPENDENT)
    }
}

/// The displacements at the fast triangle's voltages in the last period, each voltage reached in `slower` ticks.
fn settled(table: &Table, low: f64, high: f64, slower: u32) -> Vec<f64> {
    let ticks = PERIODS * SLOWER * FAST;
    let period = FAST * slower;
    let mut model = table.engine::<f64>();
    model.step(0.5 * (low + high), None);
    let mut last = Vec::with_capacity(FAST as usize);
    for tick in 0..ticks {
        let y = model.step(triangle(f64::from(tick % period) / f64::from(period), low, high), None);
        if tick % slower == 0 && tick >= ticks - period {
            last.push(y);
        }
    }
    last
}

/// From the middle up, down and back.
fn triangle(phase: f64, low: f64, high: f64) -> f64 {
    let unit = match phase {
        phase if phase < 0.25 => 4.0 * phase,
        phase if phase < 0.75 => 2.0 - 4.0 * phase,
        phase => 4.0 * phase - 4.0,
    };
    0.5 * (low + high) + 0.5 * (high - low) * unit
}

/// Stroke, and the largest distance of two displacements at the same voltage.
fn measured(period: &[f64]) -> (f64, f64) {
    let extreme = |pick: fn(f64, f64) -> f64, start| period.iter().copied().fold(start, pick);
    let stroke = extreme(f64::max, f64::NEG_INFINITY) - extreme(f64::min, f64::INFINITY);
    // Phase p and half a period less p have the same voltage.
    let count = period.len();
    let mirrored = |k: usize| period.get((count + count / 2 - k) % count.max(1));
    let distances = period.iter().enumerate().filter_map(|(k, y)| Some((y - mirrored(k)?).abs()));
    (stroke, distances.fold(0.0, f64::max))
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::super::without_lag::without_lag;
    use super::*;
    use estimator_core::Model;
    use identification::cost::Feedback;

    #[test]
    fn plays_do_not_depend_on_the_rate_and_voigt_does() {
        let mut bench = small();
        bench.identify(Feedback::Simulation, &[Model::Voigt, Model::PrandtlIshlinskii], &mut |_, _| ());
        let table = |model| *bench.candidate(Feedback::Simulation, model).unwrap().table;
        let plays = without_lag(&table(Model::PrandtlIshlinskii)).unwrap();
        let [voigt, plays] = [table(Model::Voigt), plays].map(|table| Rate::of(&table, -20.0, 20.0));
        assert!((voigt.slow_hz - 1.0).abs() < 1e-9 && (voigt.fast_hz - 100.0).abs() < 1e-9);
        assert!(voigt.dependent() && voigt.stroke_change() < -10.0, "{voigt:?}");
        assert!(!plays.dependent() && plays.stroke_change().abs() < 1e-9, "{plays:?}");
        assert!((plays.slow_width_percent - plays.fast_width_percent).abs() < 1e-9 && plays.slow_width_percent > 2.0);
    }

    #[test]
    fn the_rig_s_amplifier_makes_it_slow() {
        let rig = Rate::of_rig(&Rig::default()).unwrap();
        assert!(rig.dependent() && (7.5..8.5).contains(&rig.slow_stroke_um), "{rig:?}");
        assert!((-60.0..-50.0).contains(&rig.stroke_change()), "{rig:?}");
        let quick = Rate::of_rig(&Rig { cutoff: 4500.0, creep: 0.0, ..Rig::default() }).unwrap();
        assert!(quick.stroke_change().abs() < 2.0, "{quick:?}");
    }

    #[test]
    fn a_triangle_meets_its_ends_and_its_own_voltages_again() {
        let at = |k: u32| triangle(f64::from(k % FAST) / f64::from(FAST), -3.0, 5.0);
        assert_eq!([at(0), at(5), at(10), at(15)], [1.0, 5.0, 1.0, -3.0]);
        assert!((0..FAST).all(|k| (at(k) - at(FAST + FAST / 2 - k)).abs() < 1e-12));
    }
}
