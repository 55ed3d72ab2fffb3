//! What of a session does not depend on the candidate: where each voltage stands between the knots, and what happens at
//! which tick. The voltage alone decides where reversals are.

use super::knots::{Knots, Position};
use estimator_core::Tracker;
use recordings::session::Session;

/// A session as the candidates run through it.
#[derive(Clone, Debug)]
pub struct Timeline {
    /// The tick's voltage, of each tick that is run.
    pub positions: Vec<Position>,
    /// What happens, in its order.
    pub marks: Vec<Mark>,
    /// Displacement at the start, µm.
    pub start: f64,
    /// Measured instants that count.
    pub judged: usize,
}

/// Something that happens between two ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Mark {
    /// Ticks that were run before.
    pub tick: usize,
    /// What it is.
    pub event: Event,
}

/// What happens between two ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Event {
    /// The displacement was measured, µm; whether its error counts.
    Measured {
        /// Measured displacement, µm.
        displacement: f64,
        /// Its error counts.
        counts: bool,
    },
    /// A reversal at this voltage (V) is seen; its displacement was that at the last [`Event::Extreme`].
    Reversal(f64),
    /// The next reversal's displacement is that of now.
    Extreme,
}

impl Event {
    /// At one tick a measurement corrects what stands there, a reversal takes the extreme before the next is reached.
    fn order(self) -> u8 {
        match self {
            Self::Measured { .. } => 0,
            Self::Reversal(_) => 1,
            Self::Extreme => 2,
        }
    }
}

impl Timeline {
    /// Of a session, with reversals by a deadband (V); `None` where nothing was measured.
    pub fn of(session: &Session, knots: &Knots, deadband: f64) -> Option<Self> {
        let (&start, &last) = (session.displacement.first()?, session.instants.last()?);
        // A rest before the first tick is a tick by itself.
        let before = usize::from(session.rested_v.is_some());
        let voltages = session.rested_v.iter().chain(session.voltage.iter().take(last as usize));
        let judged = session.lead_in.max(1);
        let measured = session.instants.iter().zip(&session.displacement).enumerate().skip(1);
        let mut marks: Vec<Mark> = measured
            .map(|(index, (&instant, &displacement))| Mark {
                tick: instant as usize + before,
                event: Event::Measured { displacement, counts: index >= judged },
            })
            .collect();
        let mut tracker = Tracker::new(deadband);
        for (tick, &voltage) in voltages.clone().enumerate() {
            if tracker.update(voltage, tick as f64) {
                let reversal = tracker.last();
                // The tracker was told the tick for the displacement.
                marks.push(Mark { tick: reversal.displacement as usize, event: Event::Extreme });
                marks.push(Mark { tick, event: Event::Reversal(reversal.voltage) });
            }
        }
        marks.sort_by_key(|mark| (mark.tick, mark.event.order()));
        Some(Self {
            positions: voltages.map(|&voltage| knots.position(voltage)).collect(),
            marks,
            start,
            judged: session.instants.len().saturating_sub(judged).max(1),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use estimator_core::Range;

    #[test]
    fn a_reversal_takes_the_extreme_before_it_and_a_rest_is_a_tick() {
        let voltage = [0.0, 2.0, 4.0, 3.0, 1.0, 0.0, 1.0, 3.0, 3.0];
        let mut session = Session::new("".into(), voltage.to_vec(), vec![0, 4, 8], vec![0.5, 1.5, 2.5], 5e-4);
        let knots = Knots::over(Range { min: -1.0, max: 5.0 });
        let of = |session: &Session| Timeline::of(session, &knots, 0.5).unwrap();
        let measured = |displacement| Event::Measured { displacement, counts: true };
        let expected = [
            (2, Event::Extreme),
            (3, Event::Reversal(4.0)),
            (4, measured(1.5)),
            (5, Event::Extreme),
            (6, Event::Reversal(0.0)),
            (8, measured(2.5)),
        ];
        let marks = |timeline: &Timeline| timeline.marks.iter().map(|mark| (mark.tick, mark.event)).collect::<Vec<_>>();
        let timeline = of(&session);
        assert_eq!(marks(&timeline), expected);
        assert_eq!((timeline.start, timeline.judged, timeline.positions.len()), (0.5, 2, 8));

        session.rested_v = Some(-1.0);
        session.lead_in = 2;
        let timeline = of(&session);
        let later: Vec<usize> = timeline.marks.iter().map(|mark| mark.tick).collect();
        assert_eq!(later, expected.map(|(tick, _)| tick + 1));
        assert_eq!((timeline.judged, timeline.positions.len()), (1, 9));
        assert_eq!(timeline.marks[2].event, Event::Measured { displacement: 1.5, counts: false });
    }
}
