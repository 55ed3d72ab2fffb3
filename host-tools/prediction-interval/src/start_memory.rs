//! What two starts can still differ by after the voltage has swept so much of its range.

use estimator_core::interval::SPANS;
use estimator_core::model::Process;
use estimator_core::{Admitted, Range};

/// Ticks that the voltage takes over its range at least, and for how long, s.
const RAMP: usize = 800;
const RAMP_S: f64 = 0.4;
/// Part of that for which it then stands, so that lags are over.
const STAND: f64 = 0.5;

/// Half of what the two extreme memories that an actuator can start with differ by (µm), by the span of voltage since
/// the start in eighths of the table's range; they differ most in the middle of the range. They are those of a rise
/// from the lowest voltage and of a fall from the highest; every other lies between them. What is left after a sweep of
/// the whole range is creep, and no memory of hysteresis. Both have rested in the middle: rested at opposite ends, they
/// would have crept apart, against what their memories differ by.
pub fn start_memory(table: &Admitted) -> [f32; SPANS] {
    let range: Range<f64> = table.voltage_range_v.of();
    let at = |eighth: usize| range.min + range.span() * eighth as f64 / (SPANS - 1) as f64;
    let (mut widest, ticks) = ([0.0f64; SPANS], ticks(table));
    for start in (0..SPANS).map(at) {
        for (far, near) in [(range.min, range.max), (range.max, range.min)] {
            // Up to one end and then to the other, so that every span is met.
            let path: Vec<f64> = ramp(start, far, ticks).chain(ramp(far, near, ticks)).collect();
            let [low, high] = [[range.max, range.min], [range.min, range.max]]
                .map(|[first, second]| displacements(table, &[range.middle(), first, second, start], &path));
            let mut swept = Range::point(start);
            for ((&voltage, low), high) in path.iter().zip(low).zip(high) {
                let before = eighths(swept, range);
                swept = swept.include(voltage);
                for widest in widest.iter_mut().take(eighths(swept, range) + 1).skip(before) {
                    *widest = widest.max((high - low).abs());
                }
            }
        }
    }
    let left = widest[SPANS - 1];
    let mut least = f64::INFINITY;
    widest.map(|width| {
        least = least.min((width - left).max(0.0));
        (0.5 * least) as f32
    })
}

/// Whole eighths of the range that a span has.
fn eighths(swept: Range<f64>, range: Range<f64>) -> usize {
    (swept.span() / range.span() * (SPANS - 1) as f64 + 1e-9) as usize
}

/// Ticks of a ramp.
fn ticks(table: &Admitted) -> usize {
    // As a cast saturates: a tick is at least a microsecond.
    ((RAMP_S / table.sample_period::<f64>()).round() as usize).max(RAMP)
}

/// From a voltage to another in so many ticks, evenly, without the first.
fn ramp(from: f64, to: f64, ticks: usize) -> impl Iterator<Item = f64> {
    (1..=ticks).map(move |k| from + (to - from) * k as f64 / ticks as f64)
}

/// Displacements along a path after a past of voltages that were gone to.
fn displacements(table: &Admitted, past: &[f64], path: &[f64]) -> Vec<f64> {
    let (mut model, ticks) = (table.engine::<f64>(), ticks(table));
    for pair in past.windows(2) {
        ramp(pair[0], pair[1], ticks).for_each(|voltage| {
            model.step(voltage, None);
        });
    }
    if let Some(&last) = past.last() {
        (0..(STAND * ticks as f64) as usize).for_each(|_| {
            model.step(last, None);
        });
    }
    path.iter().map(|&voltage| model.step(voltage, None)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::list::List;
    use estimator_core::{Parameters, Table};
    use std::path::Path;

    #[test]
    fn creep_undoes_nothing_of_what_two_starts_differ_by() {
        let path = "../../tests/data/table/models/generalised-prandtl-ishlinskii.toml";
        let (_, creeps) = table_files::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join(path)).unwrap();
        let Parameters::GeneralisedPrandtlIshlinskii(mut parameters) = creeps.parameters else { panic!("{path}") };
        parameters.creep_gains = List::collect(parameters.creep_gains.iter().map(|_| 0.0)).unwrap();
        let parameters = Parameters::GeneralisedPrandtlIshlinskii(parameters);
        let limits = creeps.displacement_limits_um;
        let widened = Range { min: limits.min - limits.span(), max: limits.max + limits.span() };
        let stands = Table { parameters, displacement_limits_um: widened, ..*creeps }.admit().unwrap();
        let (creeping, standing) = (start_memory(&creeps), start_memory(&stands));
        // Half a range wipes out most of it.
        for eighth in 0..4 {
            let ratio = creeping[eighth] / standing[eighth];
            assert!(
                (0.7..1.3).contains(&ratio),
                "after {eighth} eighths of the range: {creeping:?}, without creep {standing:?}"
            );
        }
    }
}
