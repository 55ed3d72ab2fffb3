//! What the training logs can teach: how many reversals they have, at how many frequencies and amplitudes, and whether
//! the voltage steps.

use crate::half_cycle::{HalfCycle, SMALLEST_SWING, half_cycles, large_reversals};
use crate::reversals::reversals;
use estimator_core::Range;
use recordings::session::Session;

/// What was found in the training logs' voltage.
#[derive(Clone, PartialEq, Debug)]
pub struct Character {
    /// Reversals of at least 10 % of the voltage span, all logs together.
    pub reversals: usize,
    /// Reversals that the model's deadband lets through.
    pub reversals_at_deadband: usize,
    /// Steps of at least 10 % of the voltage span from one rest to another, where the readings are close enough to show
    /// the lag behind a step.
    pub steps: usize,
    /// The same with up to 50 ms from one rest to the other, of rests that go on for as long: they show how the
    /// actuator comes to rest.
    pub fast_moves: usize,
    half_cycles: Vec<HalfCycle>,
}

/// A step takes no longer than this, s, and the voltage stands still for so long before and after it, s: within this
/// part of the whole span.
const STEP_S: f64 = 5e-3;
const MOVE_S: f64 = 50e-3;
const STILL_S: f64 = 20e-3;
const STILL: f64 = 0.02;
/// Half cycles (or swings) whose extremes differ by less than this factor count as one frequency (or amplitude).
const ONE: f64 = 1.25;
/// Half cycles, at either end, that together last less than this fraction of the time are glitches; and rests that do
/// are no rests.
const RARE: f64 = 0.05;
/// A voltage that moves for less than this part of a half cycle steps.
const INSTANTLY: f64 = 0.05;

impl Character {
    /// Looks at the voltages of some sessions; `deadband` (V) is the model's.
    pub fn of<'a>(sessions: impl Iterator<Item = &'a Session> + Clone, deadband: f64) -> Self {
        let voltages = sessions.clone().flat_map(|session| session.voltage.iter().copied());
        let span = Range::of_values(voltages).span();
        let mut character =
            Self { reversals: 0, reversals_at_deadband: 0, steps: 0, fast_moves: 0, half_cycles: Vec::new() };
        for session in sessions {
            character.reversals_at_deadband += reversals(&session.voltage, deadband).len();
            let large = large_reversals(&session.voltage, span);
            character.reversals += large.len();
            character.steps += steps(session, span, STEP_S);
            character.fast_moves += steps(session, span, MOVE_S);
            character.half_cycles.extend(half_cycles(&session.voltage, &large, session.tick_s));
        }
        character
    }

    /// Whether the voltage moves for about the same time in all half cycles. A rest makes a half cycle longer, and says
    /// nothing of how the actuator follows a faster one.
    pub fn single_frequency(&self) -> bool {
        // A step of one tick or two is the same to a half cycle.
        self.single(|half_cycle| half_cycle.moving_s.max(INSTANTLY * half_cycle.seconds))
    }

    /// Whether the voltage stands still for some of the time.
    pub fn rests(&self) -> bool {
        let [whole, moving] = [|half: &HalfCycle| half.seconds, |half: &HalfCycle| half.moving_s]
            .map(|of| self.half_cycles.iter().map(of).sum::<f64>());
        whole - moving > RARE * whole
    }

    /// Whether all swings are about as large.
    pub fn single_amplitude(&self) -> bool {
        self.single(|half_cycle| half_cycle.volts)
    }

    /// Whether a quantity is about the same in all half cycles but rare ones.
    fn single(&self, of: fn(&HalfCycle) -> f64) -> bool {
        let mut sorted: Vec<(f64, f64)> = self.half_cycles.iter().map(|half| (of(half), half.seconds)).collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole: f64 = sorted.iter().map(|(_, seconds)| seconds).sum();
        let beyond = |time: f64| {
            let mut passed = 0.0;
            sorted.iter().find(|(_, seconds)| {
                passed += seconds;
                passed > time
            })
        };
        match (beyond(RARE * whole), beyond((1.0 - RARE) * whole)) {
            (Some((low, _)), Some((high, _))) => *high < ONE * low,
            _ => true,
        }
    }
}

/// How often the voltage of a session steps within so many s; `span` is that of all logs, V.
fn steps(session: &Session, span: f64, within_s: f64) -> usize {
    let ticks = |seconds: f64| (seconds / session.tick_s).ceil() as usize;
    let (step, still) = (ticks(within_s), ticks(STILL_S));
    if span <= 0.0 || session.interval_s() > STEP_S {
        return 0;
    }
    let rests = |volts: &[f64]| Range::of_values(volts.iter().copied()).span() <= STILL * span;
    let (mut count, mut from) = (0, still);
    while let Some(after) = session.voltage.get(from + step..from + step + still) {
        let large = (after[0] - session.voltage[from]).abs() >= SMALLEST_SWING * span;
        if large && rests(&session.voltage[from - still..=from]) && rests(after) {
            count += 1;
            from += step;
        }
        from += 1;
    }
    count
}
