//! From where on a session's displacement follows from its own voltage, and no longer from what was there before.
//!
//! How an actuator was left before a recording shows in its first swing, and may be most of what a model is off by
//! there; in another recording the actuator was left otherwise. So models are compared by what comes after it.

use recordings::session::Session;

/// A session's memory is its own once its voltage has been so near to both of its extremes, as a fraction of its span:
/// the first of these that takes no more than half of the session. A random walk comes near its extremes late, and what
/// is left of the start after the next of these is little.
const NEAR: [f64; 4] = [0.01, 0.03, 0.1, 0.2];

/// Index of the first measured instant at which a session's voltage has been near both of its extremes.
pub fn first_swing(session: &Session) -> usize {
    let [nearest, ..] = NEAR;
    within(session, nearest)
}

/// Index of the first measured instant at which a session's voltage has been so near to both of its extremes, as a
/// fraction of its span.
fn within(session: &Session, near: f64) -> usize {
    let low = session.voltage.iter().copied().fold(f64::INFINITY, f64::min);
    let high = session.voltage.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let near = near * (high - low);
    let first = |is: &dyn Fn(f64) -> bool| session.voltage.iter().position(|&v| is(v)).unwrap_or(0);
    let tick = first(&|v| v <= low + near).max(first(&|v| v >= high - near)) as u32;
    session.instants.partition_point(|&instant| instant < tick)
}

/// The end of a session's [`first_swing`], or where that takes more than half of it, of one that comes less near to its
/// extremes; 0 where none is over by then.
pub fn settled(session: &Session) -> usize {
    let mut swings = NEAR.into_iter().map(|near| within(session, near));
    swings.find(|index| 2 * index <= session.instants.len()).unwrap_or(0)
}

/// The session, of which no more is judged than what follows its start.
pub fn judged_once_settled(session: &Session) -> Session {
    Session { lead_in: session.lead_in.max(settled(session)), ..session.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a voltage by the tick.
    fn session(voltage: impl Fn(f64) -> f64) -> Session {
        let voltage: Vec<f64> = (0..1_000).map(|tick| voltage(f64::from(tick))).collect();
        Session::new("log".to_owned(), voltage.clone(), (0..1_000).collect(), voltage, 5e-4)
    }

    #[test]
    fn extremes_that_come_late_leave_the_start_no_longer_than_the_swings_before_them_do() {
        // Both swings of 10.6 V come in the last tenth.
        let swelling = session(|tick| if tick < 900.0 { 10.0 } else { 10.6 } * libm::sin(0.0628 * tick));
        assert!((965..=980).contains(&first_swing(&swelling)), "{}", first_swing(&swelling));
        assert!((60..=75).contains(&settled(&swelling)), "{}", settled(&swelling));
        assert_eq!(settled(&session(|tick| tick)), 0, "a ramp is never settled");
    }
}
