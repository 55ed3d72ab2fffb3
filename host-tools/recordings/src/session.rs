//! A log brought to the tick.
//!
//! The voltage stands at every tick; the displacement stands at the instants where it was measured, which may be every
//! tick or (in a log slower than the tick) every n-th.

/// One index of each `stride` of `count`, the first of them 0. Which one of its stride goes on by the golden section,
/// so that those of a periodic recording are of all its phases, whatever its period.
pub fn one_of_each(stride: usize, count: usize) -> impl Iterator<Item = usize> {
    const GOLDEN: f64 = 0.618_033_988_749_895;
    (0..count.div_ceil(stride))
        .map(move |k| k * stride + ((k as f64 * GOLDEN).fract() * stride as f64) as usize)
        .filter(move |index| *index < count)
}

/// One log at the tick, in the model's units: V and µm relative to the model's zeros.
#[derive(Clone, PartialEq, Debug)]
pub struct Session {
    /// Name of the log it comes from.
    pub name: String,
    /// Voltage at each tick, V.
    pub voltage: Vec<f64>,
    /// Ticks at which the displacement was measured; increasing, the first is 0, the last below `voltage.len()`.
    pub instants: Vec<u32>,
    /// Measured displacement at the instants, µm.
    pub displacement: Vec<f64>,
    /// Time of the first tick within the log, s.
    pub start_s: f64,
    /// The tick's period, s.
    pub tick_s: f64,
    /// The voltage (V) at which the actuator had long rested before the first tick, where that is not the first tick's.
    pub rested_v: Option<f64>,
    /// Measured instants that are run through and not judged, because something was learnt from them;
    /// below their number.
    pub lead_in: usize,
}

impl Session {
    /// A session from its parts; it starts where its log does.
    pub fn new(name: String, voltage: Vec<f64>, instants: Vec<u32>, displacement: Vec<f64>, tick_s: f64) -> Self {
        debug_assert!(instants.first() == Some(&0) && instants.len() == displacement.len());
        Self { name, voltage, instants, displacement, start_s: 0.0, tick_s, rested_v: None, lead_in: 0 }
    }

    /// From one measured instant to the next, s: the middle one of all, whatever was left out; infinite of
    /// a single instant.
    pub fn interval_s(&self) -> f64 {
        let mut ticks: Vec<u32> = self.instants.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let middle = ticks.len() / 2;
        if ticks.is_empty() { f64::INFINITY } else { f64::from(*ticks.select_nth_unstable(middle).1) * self.tick_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_counts_of_a_periodic_recording_is_of_all_its_phases() {
        const STRIDE: usize = 25;
        for period in [20, 25, 50, 100] {
            let mut seen = vec![false; period];
            let mut last = None;
            for (k, index) in one_of_each(STRIDE, 120_000).enumerate() {
                assert!(index / STRIDE == k && last < Some(index), "one of each");
                seen[index % period] = true;
                last = Some(index);
            }
            assert!(seen.iter().all(|seen| *seen), "of {period} phases: {seen:?}");
        }
        assert!(one_of_each(1, 5).eq(0..5) && one_of_each(4, 3).eq([0]));
    }
}
