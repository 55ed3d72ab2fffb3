//! From where on a session's displacement follows from its own voltage, and no longer from what was there before.
//!
//! How an actuator was left before a recording shows in its first swing, and may be most of what a model is off by there; in
//! another recording the actuator was left otherwise. So models are compared by what comes after it.

use recordings::session::Session;

/// How near to its extremes, as a fraction of its span, a session's voltage must have come for its memory to be its own.
const EXTREME: f64 = 0.01;

/// Index of the first measured instant at which a session's voltage has been near both of its extremes.
pub fn first_swing(session: &Session) -> usize {
    let low = session.voltage.iter().copied().fold(f64::INFINITY, f64::min);
    let high = session.voltage.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let near = EXTREME * (high - low);
    let first = |is: &dyn Fn(f64) -> bool| session.voltage.iter().position(|&v| is(v)).unwrap_or(0);
    let tick = first(&|v| v <= low + near).max(first(&|v| v >= high - near)) as u32;
    session.instants.partition_point(|&instant| instant < tick)
}

/// The end of a session's [`first_swing`]; 0 where that takes more than half of it.
pub fn settled(session: &Session) -> usize {
    let index = first_swing(session);
    if 2 * index <= session.instants.len() { index } else { 0 }
}

/// The session, of which no more is judged than what follows its start.
pub fn judged_once_settled(session: &Session) -> Session {
    Session { lead_in: session.lead_in.max(settled(session)), ..session.clone() }
}
