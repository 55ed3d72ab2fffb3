//! First-order reversal curves, Eq. (3.17)–(3.19), as sessions have them.
//!
//! From the lowest voltage a session rises to some voltage, falls back to the lowest, rises to another, and so on.
//! Each fall is a curve. What lies between two curves, in the voltage of reversal, is interpolated; a curve is taken
//! at the measured instants.

use crate::reversals::reversals;
use estimator_core::Range;
use recordings::session::Session;

/// Fewer curves than this describe no plane.
const FEWEST: usize = 4;
/// How near to the lowest voltage a curve must begin its rise and end its fall, and how much higher than the one before
/// it must turn, as fractions of the span.
const NEAR: f64 = 0.02;

/// One curve: samples (V, µm) from the reversal down to the lowest voltage.
struct Curve {
    falling: Vec<(f64, f64)>,
}

/// First-order reversal curves of some sessions.
pub struct ReversalCurves {
    /// By the voltage of reversal, lowest first.
    curves: Vec<Curve>,
    lower: f64,
    upper: f64,
}

impl Curve {
    fn of(session: &Session, top: usize, bottom: usize) -> Self {
        let instants = session.instants.iter().zip(&session.displacement);
        let within = instants.filter(|(instant, _)| (top..=bottom).contains(&(**instant as usize)));
        Self { falling: within.map(|(&instant, &y)| (session.voltage[instant as usize], y)).collect() }
    }

    fn top(&self) -> f64 {
        self.falling.first().map_or(f64::NAN, |(v, _)| *v)
    }

    /// The displacement (µm) at a voltage (V) on the way down; at the nearest end beyond.
    fn at(&self, voltage: f64) -> f64 {
        let below = self.falling.partition_point(|(v, _)| *v > voltage);
        match (below.checked_sub(1).and_then(|above| self.falling.get(above)), self.falling.get(below)) {
            (Some((v, y)), Some((w, z))) if v > w => y + (z - y) * (v - voltage) / (v - w),
            (_, Some((_, y))) | (Some((_, y)), None) => *y,
            (None, None) => f64::NAN,
        }
    }

    /// E(top, voltage), Eq. (3.17): what the fall to a voltage (V) takes away, µm.
    fn everett(&self, voltage: f64) -> f64 {
        self.at(self.top()) - self.at(voltage)
    }
}

impl ReversalCurves {
    /// The curves of sessions that together have these voltages; `None` where there are too few.
    pub fn of<'s>(sessions: impl Iterator<Item = &'s Session>, voltages: Range<f64>) -> Option<Self> {
        let near = NEAR * voltages.span();
        let mut curves: Vec<Curve> = sessions.flat_map(|session| curves(session, voltages.min + near, near)).collect();
        curves.sort_by(|a, b| a.top().total_cmp(&b.top()));
        curves.dedup_by(|higher, lower| higher.top() - lower.top() < near);
        let upper = curves.last()?.top();
        (curves.len() >= FEWEST).then_some(Self { curves, lower: voltages.min, upper })
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.curves.len()
    }

    /// From the lowest voltage to the highest of a reversal, V.
    pub fn span(&self) -> Range<f64> {
        Range { min: self.lower, max: self.upper }
    }

    /// Mean of the curves' displacements at the lowest voltage, µm.
    pub fn lowest_um(&self) -> f64 {
        self.curves.iter().map(|curve| curve.at(self.lower)).sum::<f64>() / self.curves.len() as f64
    }

    /// E(high, low) between the curves, Eq. (3.17), µm: what the fall from `high` to `low` (V) takes away.
    pub fn everett(&self, high: f64, low: f64) -> f64 {
        let above = self.curves.partition_point(|curve| curve.top() < high - 1e-9 * (self.upper - self.lower));
        let Some(upper) = self.curves.get(above).or(self.curves.last()) else { return 0.0 };
        // Where a curve turns at `low` itself, nothing has been taken away.
        let (from, least) = match above.checked_sub(1).and_then(|below| self.curves.get(below)) {
            Some(lower) if lower.top() > low => (lower.top(), lower.everett(low)),
            _ => (low, 0.0),
        };
        let distance = upper.top() - from;
        if distance <= 0.0 { least } else { least + (upper.everett(low) - least) * ((high - from) / distance).min(1.0) }
    }
}

/// The falls of a session that begin after a rise from below `low` (V) and end below it.
fn curves(session: &Session, low: f64, deadband: f64) -> Vec<Curve> {
    let mut turns = vec![0];
    turns.extend(reversals(&session.voltage, deadband));
    turns.push(session.voltage.len().saturating_sub(1));
    let volts = |sample: usize| session.voltage.get(sample).copied().unwrap_or(f64::NAN);
    let falls = turns.windows(3).filter_map(|turn| match *turn {
        [before, top, bottom] if volts(before) <= low && volts(top) > low && volts(bottom) <= low => {
            Some(Curve::of(session, top, bottom))
        }
        _ => None,
    });
    falls.filter(|curve| !curve.falling.is_empty()).collect()
}
