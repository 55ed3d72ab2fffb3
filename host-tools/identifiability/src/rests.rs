//! What a session shows of creep by itself: how the estimate's error moves while the voltage rests behind a move.
//!
//! Creep is slow, and errors of a loop say little of it: a model whose creep in seconds is drawn from that in
//! milliseconds fits the loops all the same, with a small standard error and another creep. A rest of the length that
//! is asked for shows it.

use crate::judged::Judged;
use recordings::session::Session;

/// How far a voltage that rests may go, of the span.
const STILL: f64 = 0.01;
/// A move behind which creep is seen goes at least so far, of the span, within this time, s.
const MOVED: f64 = 0.25;
const MOVE_S: f64 = 1.0;
/// A rest lasts at least so much of what is asked for.
const LASTS: f64 = 0.9;
/// Readings of a moment are averaged over this part of the time since the move ended, either way.
const MOMENT: f64 = 0.1;

/// A rest behind a move, in ticks: the first of it, and the first after it.
struct Rest {
    from: usize,
    to: usize,
    /// How far the voltage had gone, V.
    moved_v: f64,
}

/// What the estimate is off by more at the end of each long rest than at its beginning, from `since_s` to `until_s`
/// after the move, for a move over the whole span, V, µm.
pub fn missed(session: &Session, judged: &Judged, span_v: f64, (since_s, until_s): (f64, f64)) -> Vec<f64> {
    let long = rests(session, span_v, LASTS * until_s);
    let missed = long.iter().filter_map(|rest| {
        let end_s = until_s.min((rest.to - rest.from) as f64 * session.tick_s);
        let at = |seconds: f64| {
            // A slow log has its reading within an interval.
            let either_way_s = (MOMENT * seconds).max(session.interval_s());
            let tick = |seconds: f64| rest.from + (seconds.max(0.0) / session.tick_s).round() as usize;
            mean(session, judged, tick(seconds - either_way_s), tick(seconds + either_way_s).min(rest.to - 1))
        };
        Some((at(end_s)? - at(since_s)?) * span_v / rest.moved_v)
    });
    missed.collect()
}

/// The rests of a session that last so many s behind a move of a voltage whose span is this, V.
fn rests(session: &Session, span_v: f64, lasting_s: f64) -> Vec<Rest> {
    let voltage = &session.voltage;
    let least = (lasting_s / session.tick_s).round() as usize;
    let mut found = Vec::new();
    let mut from = 0;
    for to in 1..=voltage.len() {
        if voltage.get(to).is_some_and(|volts| (volts - voltage[from]).abs() <= STILL * span_v) {
            continue;
        }
        let moved_v = moved(session, from);
        if to - from >= least.max(1) && moved_v >= MOVED * span_v && moved_v > 0.0 {
            found.push(Rest { from, to, moved_v });
        }
        from = to;
    }
    found
}

/// How far the voltage goes to a tick within the time of a move, V; a session's first tick from where the
/// actuator had rested.
fn moved(session: &Session, tick: usize) -> f64 {
    let ticks = (MOVE_S / session.tick_s).round() as usize;
    let before = &session.voltage[tick.saturating_sub(ticks)..tick];
    let rested = session.rested_v.filter(|_| tick < ticks);
    let away = before.iter().chain(&rested).map(|volts| (volts - session.voltage[tick]).abs());
    away.fold(0.0, f64::max)
}

/// Mean error at the readings from one tick to another, µm; `None` where nothing was read.
fn mean(session: &Session, judged: &Judged, from: usize, to: usize) -> Option<f64> {
    // The first reading and what is only run through have no error.
    let before = session.instants.len() - judged.errors.len();
    let index = |tick: usize| session.instants.partition_point(|&instant| (instant as usize) < tick);
    let errors = judged.errors.get(index(from).checked_sub(before)?..index(to + 1).checked_sub(before)?)?;
    (!errors.is_empty()).then(|| errors.iter().sum::<f64>() / errors.len() as f64)
}
