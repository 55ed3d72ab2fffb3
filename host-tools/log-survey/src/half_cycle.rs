//! What lies between the large reversals of a voltage.

use crate::reversals::reversals;
use estimator_core::Range;

/// From one reversal to the next.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct HalfCycle {
    pub seconds: f64,
    /// Of these, what the voltage does not stand still in.
    pub moving_s: f64,
    pub volts: f64,
}

/// Reversals smaller than this fraction of the whole span are noise or glitches here.
pub(crate) const SMALLEST_SWING: f64 = 0.1;
/// A half cycle's voltage stands still where it stays within this part of its swing,
const STILL: f64 = 0.02;
/// for more than this part of its time: a sine does so for 9 % at each end.
const RESTS: f64 = 0.15;

/// The samples of a voltage's reversals, where that of all logs goes over a `span`, V.
pub(crate) fn large_reversals(voltage: &[f64], span: f64) -> Vec<usize> {
    reversals(voltage, SMALLEST_SWING * span)
}

/// Between these samples of a voltage with a sample each `period_s`.
pub(crate) fn half_cycles(voltage: &[f64], reversals: &[usize], period_s: f64) -> Vec<HalfCycle> {
    let of = |pair: &[usize]| HalfCycle {
        seconds: (pair[1] - pair[0]) as f64 * period_s,
        moving_s: moving(&voltage[pair[0]..=pair[1]]) as f64 * period_s,
        volts: (voltage[pair[1]] - voltage[pair[0]]).abs(),
    };
    reversals.windows(2).map(of).collect()
}

/// Samples of a half cycle between which its voltage does not stand still.
fn moving(voltage: &[f64]) -> usize {
    let (least, within) =
        ((RESTS * voltage.len() as f64) as usize, STILL * Range::of_values(voltage.iter().copied()).span());
    let (mut still, mut from) = (0, 0);
    while from < voltage.len() {
        let mut range = Range { min: voltage[from], max: voltage[from] };
        let stays = voltage[from..].iter().take_while(|&&volts| {
            range = Range { min: range.min.min(volts), max: range.max.max(volts) };
            range.span() <= within
        });
        let ticks = stays.count();
        still += if ticks > least { ticks } else { 0 };
        from += ticks.max(1);
    }
    voltage.len() - 1 - still.min(voltage.len() - 1)
}
