//! What the training logs can teach: how many reversals they have, at how many frequencies and amplitudes, and whether
//! the voltage steps.

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

/// From one reversal to the next.
#[derive(Clone, Copy, PartialEq, Debug)]
struct HalfCycle {
    seconds: f64,
    /// Of these, what the voltage does not stand still in.
    moving_s: f64,
    volts: f64,
}

/// Reversals smaller than this fraction of the whole span are noise or glitches here.
const SMALLEST_SWING: f64 = 0.1;
/// A step takes no longer than this, s, and the voltage stands still for so long before and after it, s: within this
/// part of the whole span.
const STEP_S: f64 = 5e-3;
const MOVE_S: f64 = 50e-3;
const STILL_S: f64 = 20e-3;
const STILL: f64 = 0.02;
/// Half cycles (or swings) whose extremes differ by less than this factor count as one frequency (or amplitude).
const ONE: f64 = 1.25;
/// Half cycles that together last less than this fraction of the time are glitches, at either end; rests as short are
/// none.
const RARE: f64 = 0.05;
/// A half cycle's voltage stands still where it stays within [`STILL`] of its swing for more than this part of it: a
/// sine does so for 9 % at each end.
const RESTS: f64 = 0.15;
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
            let large = reversals(&session.voltage, SMALLEST_SWING * span);
            character.reversals += large.len();
            character.steps += steps(session, span, STEP_S);
            character.fast_moves += steps(session, span, MOVE_S);
            let half_cycles = large.windows(2).map(|pair| HalfCycle {
                seconds: (pair[1] - pair[0]) as f64 * session.tick_s,
                moving_s: moving(&session.voltage[pair[0]..=pair[1]]) as f64 * session.tick_s,
                volts: (session.voltage[pair[1]] - session.voltage[pair[0]]).abs(),
            });
            character.half_cycles.extend(half_cycles);
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

/// Ticks of a half cycle in which its voltage does not stand still.
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
