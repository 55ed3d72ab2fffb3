//! A log and a session without what its flaws hold.

use super::voltage::without;
use super::{Flaw, Stretch};
use recordings::log::Log;
use recordings::prepare::{PrepareError, Recipe};
use recordings::session::Session;
use std::borrow::Cow;

/// More than this part of a log is no flaw of it: it is left as it is.
const MOST: f64 = 0.5;

/// The session of a log that has been cut without what was measured in these flaws of it, and how many instants that
/// were; `None` where they are most of them, which stay.
///
/// # Errors
/// The log cannot be brought to the tick.
pub fn measured(recipe: &Recipe, log: &Log, flaws: &[Flaw]) -> Result<(Session, Option<usize>), PrepareError> {
    let mut session = recipe.session(&mended(log, flaws))?;
    let left_out = leave_out(&mut session, flaws, f64::from(recipe.delay_ticks) * recipe.tick_s());
    Ok((session, left_out))
}

/// Leaves what was measured in the flaws of its log out of a session whose sensor is late by `delay_s`; the voltage
/// stays, as it was or was [mended]. Returns how many instants it were, the first among them where it has another's
/// value; `None` where it would be most of them: then the session stays as it is.
pub fn leave_out(session: &mut Session, flaws: &[Flaw], delay_s: f64) -> Option<usize> {
    let (start_s, tick_s) = (session.start_s, session.tick_s);
    let flawed = |instant: u32| {
        // A session has what was seen at the tick at which it happened; the voltage is read as it happens.
        let happened = start_s + f64::from(instant) * tick_s;
        // What was resampled between a good row and a flawed one is neither.
        let near = |at: Stretch, time: f64| time > at.from_s - tick_s && time < at.to_s + tick_s;
        flaws.iter().any(|flaw| match *flaw {
            Flaw::Missing { .. } => false,
            Flaw::VoltageSpike { at, .. } => near(at, happened),
            // Which of the two was none is not known.
            Flaw::Hole { at } => near(at, happened) || near(at, happened + delay_s),
            Flaw::Spike { at, .. } | Flaw::Frozen { at, .. } | Flaw::Clipped { at, .. } | Flaw::Step { at, .. } => {
                near(at, happened + delay_s)
            }
        })
    };
    let kept: Vec<bool> = session.instants.iter().map(|&instant| !flawed(instant)).collect();
    let left_out = kept.iter().filter(|kept| !**kept).count();
    if left_out as f64 > MOST * kept.len() as f64 {
        return None;
    }
    // A session begins at its first instant: that stays, and has what was soundly measured next.
    let next = kept.iter().position(|kept| *kept).unwrap_or(0);
    if next > 0 {
        session.displacement[0] = session.displacement[next];
    }
    let kept: Vec<bool> = kept.iter().enumerate().map(|(at, kept)| at == 0 || *kept).collect();
    let before = kept.iter().take(session.lead_in).filter(|kept| !**kept).count();
    session.lead_in -= before;
    let mut keep = kept.iter();
    session.instants.retain(|_| keep.next() == Some(&true));
    let mut keep = kept.iter();
    session.displacement.retain(|_| keep.next() == Some(&true));
    Some(left_out)
}

/// A log's sound rows, as if nothing had been between them: what zeros are decided from.
#[must_use]
pub fn sound<'l>(log: &'l Log, flaws: &[Flaw]) -> Cow<'l, Log> {
    if !flaws.iter().any(Flaw::repairable) {
        return Cow::Borrowed(log);
    }
    let sound = sound_rows(log.voltage.len(), log.start_s, log.sample_period, flaws);
    let rows = |values: &[f64]| -> Vec<f64> { sound.iter().map(|&row| values[row]).collect() };
    let levelled = levelled(log, flaws);
    let (voltage, displacement) = (rows(&log.voltage), levelled.displacement.as_deref().map(rows));
    Cow::Owned(Log { voltage, displacement, ..levelled.into_owned() })
}

/// Which of so many rows, that begin at `start_s`, one a `period`, s, are in no flaw that can be left out.
pub(crate) fn sound_rows(rows: usize, start_s: f64, period: f64, flaws: &[Flaw]) -> Vec<usize> {
    let row = |time: f64| (time - start_s) / period;
    let mut sound = vec![true; rows];
    for Stretch { from_s, to_s } in flaws.iter().filter(|flaw| flaw.repairable()).map(Flaw::at) {
        let first = row(from_s).round().max(0.0) as usize;
        let end = (row(to_s).round().max(-1.0) + 1.0) as usize;
        sound[first.min(rows)..end.min(rows).max(first.min(rows))].fill(false);
    }
    (0..rows).filter(|&row| sound[row]).collect()
}

/// A log whose displacement goes on at the level before each step of it.
fn levelled<'l>(log: &'l Log, flaws: &[Flaw]) -> Cow<'l, Log> {
    let (Some(_), true) = (&log.displacement, flaws.iter().any(|flaw| matches!(flaw, Flaw::Step { .. }))) else {
        return Cow::Borrowed(log);
    };
    let mut log = log.clone();
    log.displacement.iter_mut().for_each(|displacement| level(displacement, log.start_s, log.sample_period, flaws));
    Cow::Owned(log)
}

/// Takes a displacement back by each step of it; its rows begin at `start_s`, one a `period`, s.
pub(crate) fn level(displacement: &mut [f64], start_s: f64, period: f64, flaws: &[Flaw]) {
    for flaw in flaws {
        if let Flaw::Step { at, leap_um } = flaw {
            let middle_s = 0.5 * (at.from_s + at.to_s) - start_s;
            let behind = (middle_s / period).ceil().max(0.0) as usize;
            displacement.iter_mut().skip(behind).for_each(|value| *value -= leap_um);
        }
    }
}

/// A log without its displacement's steps, and with a voltage on the straight line between the rows beside each spike
/// of it: the recursion needs one, and remembers every extreme.
#[must_use]
pub fn mended<'l>(log: &'l Log, flaws: &[Flaw]) -> Cow<'l, Log> {
    let row = |time: f64| ((time - log.start_s) / log.sample_period).round() as usize;
    let spikes = flaws.iter().filter_map(|flaw| match *flaw {
        Flaw::VoltageSpike { at, .. } => Some((row(at.from_s), row(at.to_s))),
        _ => None,
    });
    let levelled = levelled(log, flaws);
    match without(&log.voltage, spikes) {
        Cow::Borrowed(_) => levelled,
        Cow::Owned(voltage) => Cow::Owned(Log { voltage, ..levelled.into_owned() }),
    }
}
