//! The segments of a drive, each with its share of the time.

use super::path::Path;
use super::random::Random;
use super::request::LONGEST_S;
use super::{ExcitationError, Request, Segment, Swing};
use std::f64::consts::PI;

/// Each rest in a segment, as a part of its time, and at most so many s.
const REST: f64 = 0.08;
const REST_S: f64 = 2.0;
/// Amplitudes at each frequency, of the range.
const AMPLITUDES: [f64; 3] = [1.0, 0.5, 0.2];
/// The lower frequencies, of the highest.
const FREQUENCIES: [f64; 3] = [0.05, 0.25, 1.0];
/// The smallest of the shrinking loops is this part of the range, the others evenly between.
const LOOPS: u32 = 10;
/// Turns of the reversal curves.
const TURNS: u32 = 8;
/// Steps of the staircase either way.
const STEPS: u32 = 6;
/// A step to the end that is farther from rest is held for so long, s, where that is no more than this part of the
/// staircase: creep of seconds shows behind a large step only.
const HELD_S: f64 = 10.5;
const HELD: f64 = 0.75;
/// How much longer than asked for a drive may be.
const OVERTIME: f64 = 1.1;

/// A designed drive.
#[derive(Clone, PartialEq, Debug)]
pub struct Drive {
    /// Its parts, in order.
    pub segments: Vec<Segment>,
    /// Amplitudes and frequencies of its swings.
    pub swings: Vec<Swing>,
    request: Request,
}

impl Drive {
    /// Designs a drive.
    ///
    /// # Errors
    /// The request makes no sense, or the time does not suffice.
    pub fn design(request: &Request) -> Result<Self, ExcitationError> {
        request.check()?;
        let fits = |duration_s: f64| {
            let drive = Self::of(&Request { duration_s, ..*request });
            (drive.duration_s() <= OVERTIME * duration_s).then_some(drive)
        };
        let mut least_s = request.duration_s.max(request.least_s());
        if request.duration_s == least_s
            && let Some(drive) = fits(least_s)
        {
            return Ok(drive);
        }
        while least_s <= LONGEST_S {
            least_s *= OVERTIME;
            if fits(least_s).is_some() {
                return Err(ExcitationError::TooShort { duration_s: request.duration_s, least_s });
            }
        }
        Err(ExcitationError::TooLong { duration_s: least_s })
    }

    /// The held-out kind of segment alone: a random drive to prove a table with.
    ///
    /// # Errors
    /// As of [`design`](Self::design).
    pub fn random(request: &Request) -> Result<Segment, ExcitationError> {
        request.check()?;
        let random = random(request, request.duration_s);
        let seconds = random.volts.len() as f64 * request.tick_s;
        if seconds > OVERTIME * request.duration_s {
            return Err(ExcitationError::TooShort { duration_s: request.duration_s, least_s: 2.0 * seconds });
        }
        Ok(random)
    }

    /// What it was designed for.
    pub fn request(&self) -> &Request {
        &self.request
    }

    /// How long it takes, s.
    pub fn duration_s(&self) -> f64 {
        self.segments.iter().map(|segment| segment.volts.len()).sum::<usize>() as f64 * self.request.tick_s
    }

    /// What it covers, in sentences.
    pub fn covers(&self) -> Vec<String> {
        let Request { min_v, max_v, rest_v, .. } = self.request;
        let mut said = vec![format!(
            "{:.0} s within {min_v} … {max_v} V from a rest at {rest_v} V: the first branch, major loops, {LOOPS} shrinking loops, \
             {TURNS} reversal curves, a step that is held, a staircase of {STEPS} steps each way, and a random part that is held out",
            self.duration_s()
        )];
        for hertz in FREQUENCIES.map(|part| part * self.request.up_to_hz) {
            let spans: Vec<String> = self
                .swings
                .iter()
                .filter(|swing| swing.hertz == hertz)
                .map(|swing| format!("{:.3}", swing.span_v))
                .collect();
            said.push(format!("{hertz:.3} Hz at {} V peak to peak", spans.join(", ")));
        }
        said
    }

    /// What the slew limit forbade, in sentences.
    pub fn forbidden(&self) -> Vec<String> {
        let mut reduced: Vec<&Swing> = self.swings.iter().filter(|swing| swing.reduced()).collect();
        // Of several at one frequency the largest says it all.
        reduced.dedup_by_key(|swing| swing.hertz);
        let sentence = |swing: &&Swing| {
            format!(
                "{:.3} V peak to peak at {:.3} Hz need {:.0} V/s, the slew limit is {} V/s: no more than {:.3} V there",
                swing.wanted_v, swing.hertz, swing.needs_v_per_s, self.request.slew_v_per_s, swing.span_v
            )
        };
        reduced.iter().map(sentence).collect()
    }

    /// The whole as a file for any generator: `time_s,voltage_V`.
    pub fn to_csv(&self) -> String {
        let volts = self.segments.iter().flat_map(|segment| &segment.volts);
        let row = |(tick, volts): (usize, &f32)| format!("{:.6},{volts:.5}\n", tick as f64 * self.request.tick_s);
        std::iter::once("time_s,voltage_V\n".to_owned()).chain(volts.enumerate().map(row)).collect()
    }

    fn of(request: &Request) -> Self {
        let whole = request.duration_s;
        let mut swings = Vec::new();
        let mut segments = vec![
            segment("first-branch", "the first branch from rest, and major loops", major(request, 0.14 * whole)),
            segment("shrinking", "loops of every amplitude", shrinking(request, 0.14 * whole)),
            segment("reversals", "first-order reversal curves", reversals(request, 0.14 * whole)),
        ];
        let names = ["low-frequency", "middle-frequency", "high-frequency"];
        for (index, name) in names.into_iter().enumerate() {
            let volts = frequency(request, index, 0.07 * whole, &mut swings);
            segments.push(segment(name, "three amplitudes at one frequency", volts));
        }
        segments.push(segment(
            "staircase",
            "a step and a staircase that are held: creep",
            staircase(request, 0.17 * whole),
        ));
        segments.push(random(request, 0.2 * whole));
        Self { segments, swings, request: *request }
    }
}

/// Voltages, and how many ticks of them lead in.
type Gone = (Vec<f32>, usize);

fn segment(name: &'static str, what: &'static str, (volts, lead_in): Gone) -> Segment {
    Segment { name, what, held_out: false, lead_in, volts }
}

/// From rest: rests, wipes out what was, rests; then `inner` with the time that is left, and back to rest.
fn within(request: &Request, seconds: f64, inner: impl FnOnce(&mut Path<'_>, f64)) -> Gone {
    let mut path = Path::new(request);
    let rest = (REST * seconds).min(REST_S);
    path.hold(rest);
    for turn in [request.max_v, request.min_v, request.rest_v] {
        path.swing_to(turn, 0.0);
    }
    path.hold(rest);
    let lead_in = path.ticks_gone();
    let left = (seconds - path.seconds() - rest).max(0.0);
    inner(&mut path, left);
    path.swing_to(request.rest_v, 0.0);
    path.hold(rest);
    (path.into_volts(), lead_in)
}

/// Two loops over the whole range; nothing wipes out the virgin state before.
fn major(request: &Request, seconds: f64) -> Gone {
    let mut path = Path::new(request);
    let rest = (REST * seconds).min(REST_S);
    path.hold(rest);
    let line_s = (seconds - 2.0 * rest) / 5.0;
    for turn in [request.max_v, request.min_v, request.max_v, request.min_v] {
        path.line_to(turn, line_s);
    }
    path.swing_to(request.rest_v, 0.0);
    path.hold(rest);
    (path.into_volts(), 0)
}

fn shrinking(request: &Request, seconds: f64) -> Gone {
    within(request, seconds, |path, left| {
        let middle = 0.5 * (request.min_v + request.max_v);
        for step in (1..=LOOPS).rev() {
            let half = 0.5 * request.span_v() * f64::from(step) / f64::from(LOOPS);
            path.swing_to(middle + half, left / f64::from(2 * LOOPS));
            path.swing_to(middle - half, left / f64::from(2 * LOOPS));
        }
    })
}

fn reversals(request: &Request, seconds: f64) -> Gone {
    within(request, seconds, |path, left| {
        path.swing_to(request.max_v, 0.0);
        // Each curve gets time by its way, so that all are gone at one rate.
        let sum = f64::from(TURNS * (TURNS + 1));
        for turn in 1..=TURNS {
            let low = request.max_v - request.span_v() * f64::from(turn) / f64::from(TURNS);
            path.line_to(low, left * f64::from(turn) / sum);
            path.line_to(request.max_v, left * f64::from(turn) / sum);
        }
    })
}

fn frequency(request: &Request, index: usize, seconds: f64, swings: &mut Vec<Swing>) -> Gone {
    let hertz = FREQUENCIES[index] * request.up_to_hz;
    let sine = index < 2;
    // The fastest change of a swing by 1 V.
    let steepest = if sine { PI * hertz } else { 2.0 * hertz };
    let most = Path::fastest(request) / steepest;
    within(request, seconds, |path, left| {
        for part in AMPLITUDES {
            let wanted_v = part * request.span_v();
            // Where the limit is in the way, the smaller amplitudes become smaller, too, so that they differ.
            let span_v = wanted_v.min(part * most);
            let (needs_v_per_s, periods) = (steepest * wanted_v, (left / 3.0 * hertz).floor().max(1.0) as u32);
            swings.push(Swing { hertz, span_v, wanted_v, needs_v_per_s });
            path.swing_to(0.5 * (request.min_v + request.max_v - span_v), 0.0);
            if sine { path.sines(hertz, span_v, periods) } else { path.triangles(hertz, span_v, periods) }
        }
    })
}

fn staircase(request: &Request, seconds: f64) -> Gone {
    let (min, max, rest) = (request.min_v, request.max_v, request.rest_v);
    let (far, near) = if max - rest >= rest - min { (max, min) } else { (min, max) };
    within(request, seconds, |path, left| {
        let held_s = if HELD_S <= HELD * left { HELD_S } else { 0.0 };
        let step = (left - held_s) / f64::from(2 * STEPS + 1);
        let mut longer_s = held_s;
        for at in (0..=STEPS).chain((0..STEPS).rev()) {
            let before = path.seconds();
            path.swing_to(far + (near - far) * f64::from(at) / f64::from(STEPS), 0.0);
            path.hold(step + longer_s - (path.seconds() - before));
            longer_s = 0.0;
        }
    })
}

fn random(request: &Request, seconds: f64) -> Segment {
    let random = Random::new(request);
    let gone = within(request, seconds, |path, left| path.follow(left, |t| random.at(t)));
    Segment { held_out: true, ..segment("held-out", "a random voltage, held out", gone) }
}
