//! Which ticks of a session a candidate is stepped at: where a reading counts and, where readings between are passed
//! over, at the voltage's corners, too: those of a polyline that the voltage leaves by no more than a deadband. From
//! one such tick to the next the voltage runs straight, as every stage takes it to; passed over, a reversal would leave
//! its loop too narrow.

use log_survey::settled::settled;
use log_survey::{RESTS_S, corners, corners_left_out, stands_still_s};
use recordings::session::{Session, one_of_each};
use std::ops::RangeInclusive;

/// Most readings that count, of all sessions; of more, one of each n.
const READINGS: usize = 10_000;
/// Most of one session, which may have the fewest however many sessions there are.
const OF_ONE: RangeInclusive<usize> = 1_000..=5_000;

/// The way through a session.
pub struct Course {
    /// The measured instants, by their index, that count.
    pub readings: Vec<usize>,
    /// Ticks of the voltage's corners where readings are passed over or were left out.
    pub corners: Vec<u32>,
    /// Index of the first instant that the session's start does not reach.
    pub settled: usize,
    /// The actuator had rested before: so it is stated, or the voltage stands still first.
    pub at_rest: bool,
}

impl Course {
    /// Of each of some sessions, with corners by a deadband (V).
    pub fn of_all<'a>(sessions: impl Iterator<Item = &'a Session> + Clone, deadband: f64) -> Vec<Self> {
        let most = (READINGS / sessions.clone().count().max(1)).clamp(*OF_ONE.start(), *OF_ONE.end());
        sessions.map(|session| Self::within(most, session, deadband)).collect()
    }

    /// Of a session, with at most so many readings, but for those of its start.
    pub fn within(most: usize, session: &Session, deadband: f64) -> Self {
        let settled = settled(session);
        let stride = session.instants.len().div_ceil(most).max(1);
        let all = session.instants.len();
        let start = if settled < most { settled } else { 0 };
        let readings = (0..start).chain(one_of_each(stride, all).skip_while(|index| *index < start)).collect();
        let corners = match stride {
            1 => corners_left_out(&session.voltage, &session.instants, deadband),
            _ => corners(&session.voltage, deadband),
        };
        let at_rest = session.rested_v.is_some() || stands_still_s(session, deadband) >= RESTS_S;
        Self { readings, corners, settled, at_rest }
    }
}
