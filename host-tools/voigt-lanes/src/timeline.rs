//! What of a session does not depend on the candidate: where each voltage stands between the knots, and what happens at
//! which tick. The voltage alone decides where reversals are.

use crate::knots::{Knots, Position};
use estimator_core::Tracker;
use recordings::session::Session;

/// A session as the candidates run through it.
#[derive(Clone, Debug)]
pub struct Timeline {
    /// The tick's voltage, of each tick that is run.
    pub positions: Vec<Position>,
    /// Measured displacements, µm, in the order of the steps that take them.
    pub measured: Vec<f64>,
    /// What is done, in its order.
    pub steps: Vec<Step>,
    /// Displacement at the start, µm.
    pub start: f64,
    /// Measured instants that count.
    pub judged: usize,
}

/// What is done next.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Step {
    /// So many ticks are run.
    Ticks(usize),
    /// So often, `ticks` are run and then the displacement was measured and its error counts.
    Judged {
        /// Ticks before each measurement.
        ticks: usize,
        /// How many such measurements follow one another.
        times: usize,
    },
    /// The displacement was measured, and its error does not count.
    LeadIn,
    /// A reversal at this voltage (V) is seen; its displacement was that at the last [`Step::Extreme`].
    Reversal(f64),
    /// The next reversal's displacement is that of now.
    Extreme,
}

/// Something that happens between two ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Mark {
    /// Ticks that were run before.
    tick: usize,
    event: Event,
}

/// What happens between two ticks.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Event {
    /// The displacement was measured, µm; whether its error counts.
    Measured { displacement: f64, counts: bool },
    /// What [`Step::Reversal`] is.
    Reversal(f64),
    /// What [`Step::Extreme`] is.
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
        let mut timeline = Self {
            positions: voltages.map(|&voltage| knots.position(voltage)).collect(),
            measured: Vec::with_capacity(session.instants.len()),
            steps: Vec::new(),
            start,
            judged: session.instants.len().saturating_sub(judged).max(1),
        };
        let mut done = 0;
        for mark in marks {
            timeline.take(mark.tick - done, mark.event);
            done = mark.tick;
        }
        Some(timeline)
    }

    /// Adds so many ticks, and what happens after them.
    fn take(&mut self, ticks: usize, event: Event) {
        if let Event::Measured { displacement, counts: true } = event {
            self.measured.push(displacement);
            match self.steps.last_mut() {
                Some(Step::Judged { ticks: each, times }) if *each == ticks => *times += 1,
                _ => self.steps.push(Step::Judged { ticks, times: 1 }),
            }
            return;
        }
        if ticks > 0 {
            self.steps.push(Step::Ticks(ticks));
        }
        self.steps.push(match event {
            Event::Measured { displacement, .. } => {
                self.measured.push(displacement);
                Step::LeadIn
            }
            Event::Reversal(voltage) => Step::Reversal(voltage),
            Event::Extreme => Step::Extreme,
        });
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
        let timeline = of(&session);
        let (once, twice) = (Step::Judged { ticks: 1, times: 1 }, Step::Ticks(2));
        let expected = [
            twice,
            Step::Extreme,
            Step::Ticks(1),
            Step::Reversal(4.0),
            once,
            Step::Ticks(1),
            Step::Extreme,
            Step::Ticks(1),
            Step::Reversal(0.0),
            Step::Judged { ticks: 2, times: 1 },
        ];
        assert_eq!(timeline.steps, expected);
        assert_eq!(timeline.measured, [1.5, 2.5]);
        assert_eq!((timeline.start, timeline.judged, timeline.positions.len()), (0.5, 2, 8));

        session.rested_v = Some(-1.0);
        session.lead_in = 2;
        let timeline = of(&session);
        let lead_in =
            [Step::Ticks(3), Step::Extreme, Step::Ticks(1), Step::Reversal(4.0), Step::Ticks(1), Step::LeadIn];
        assert_eq!(timeline.steps[..6], lead_in);
        assert_eq!(timeline.steps[6..], expected[5..]);
        assert_eq!((timeline.judged, timeline.positions.len()), (1, 9));
    }

    #[test]
    fn measurements_that_are_equally_far_apart_are_one_step() {
        let rising: Vec<f64> = (0..10).map(f64::from).collect();
        let knots = Knots::over(Range { min: 0.0, max: 10.0 });
        for (instants, expected) in [
            (vec![0, 1, 2, 3, 4], vec![Step::Judged { ticks: 1, times: 4 }]),
            (vec![0, 3, 6, 8], vec![Step::Judged { ticks: 3, times: 2 }, Step::Judged { ticks: 2, times: 1 }]),
        ] {
            let displacement = instants.iter().map(|&instant| f64::from(instant)).collect();
            let session = Session::new("".into(), rising.clone(), instants, displacement, 5e-4);
            assert_eq!(Timeline::of(&session, &knots, 0.5).unwrap().steps, expected);
        }
    }
}
