//! A waveform from the board's memory, for a scanner: the same line again and again, without a host, by a trigger
//! or by itself.
//!
//! ```text
//! Approach ── there ─► (Waiting ── trigger ─►) Line ── its end ─┬─► Approach: the way back, where that is long
//!                          ▲                                    ├─► Waiting, or the next Line: where the way back was the line's last part
//!                          └────────────────────────────────────┘
//!                                                               └─► Over, after the last line
//! ```
//!
//! What is wanted goes to a line's first point by an unhurried way ([`Transition`]), from wherever the voltage stands
//! and from the last point, and waits there for its trigger. So a line takes as long as every other, apart from its
//! wait for the trigger. Where the way back fits into the ticks between two points, it is straight like those between
//! the points. The drive keeps its limits whatever is wanted. A tick that does not come delays the rest of the line
//! by one tick.

use crate::telemetry::{Telemetry, add};
use core::num::NonZeroU16;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use estimator_core::{Pace, Transition};
use protocol::{MOST_POINTS, Playback};

/// The memory of the points, µm relative to the model's zero. The link writes it while nothing is played, the tick
/// reads it while something is.
#[derive(Debug)]
#[repr(transparent)]
pub struct Points([AtomicU32; MOST_POINTS]);

impl Points {
    /// Points that are all 0.
    pub const fn new() -> Self {
        Self([const { AtomicU32::new(0) }; MOST_POINTS])
    }

    /// Puts a point in its place, if there is one.
    pub fn set(&self, at: usize, um: f32) {
        if let Some(point) = self.0.get(at) {
            point.store(um.to_bits(), Relaxed);
        }
    }

    /// The first `count` of them, in their order.
    pub fn first(&self, count: usize) -> impl Iterator<Item = f32> {
        self.0.iter().take(count).map(|point| f32::from_bits(point.load(Relaxed)))
    }

    #[inline]
    fn get(&self, at: u16) -> f32 {
        self.0.get(usize::from(at)).map_or(0.0, |point| f32::from_bits(point.load(Relaxed)))
    }
}

impl Default for Points {
    fn default() -> Self {
        Self::new()
    }
}

/// Where a player is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Phase {
    /// On the way to the first point.
    Approach,
    /// At the first point.
    Waiting,
    /// On the straight line between two points.
    Line,
    /// After the last line.
    Over,
}

/// What plays the points.
pub struct Player<'q> {
    points: &'q Points,
    telemetry: &'q Telemetry,
    how: Playback,
    /// The part of the way between two points that is gone in a tick: 1 / `how.every`.
    part: f32,
    phase: Phase,
    /// The way to the first point.
    way: Transition,
    /// The next tick of that way, counted from its beginning.
    tick: u32,
    /// The number of the point that was reached last.
    point: u16,
    /// Ticks since that point was reached.
    behind: u16,
    /// Ticks of the way back from the last point, where it takes more than there are between two points.
    back: Option<u32>,
    /// Lines that have begun.
    lines: u32,
    /// Whether the last tick's code is of a line's first point, which the sync pin shows.
    sync: bool,
    /// Whether the board is to set the sync pin and to look at the trigger input.
    pins: bool,
    /// Whether the trigger input was high when it was looked at last.
    high: bool,
    /// Whether it rose then, so that a line may begin.
    rose: bool,
}

impl<'q> Player<'q> {
    /// With nothing to play.
    pub fn new(points: &'q Points, telemetry: &'q Telemetry) -> Self {
        let one = NonZeroU16::MIN;
        Self {
            points,
            telemetry,
            how: Playback { points: one, crc: 0, every: one, lines: 0, on_trigger: false },
            part: 1.0,
            phase: Phase::Over,
            way: Transition::new(0.0, 0.0, 1),
            tick: 0,
            point: 0,
            behind: 0,
            back: None,
            lines: 0,
            sync: false,
            pins: false,
            high: true,
            rose: false,
        }
    }

    /// Plays the points so, beginning with the way from this displacement, µm. A trigger input that is high from then
    /// on has not risen.
    pub fn play(&mut self, how: Playback, from: f32, pace: Pace) {
        let (first, last, every) = (self.points.get(0), self.points.get(how.points.get() - 1), how.every.get());
        self.how = how;
        self.part = 1.0 / f32::from(every);
        self.back = pace.back(last, first, every);
        self.approach(from, pace.ticks(from, first));
        (self.lines, self.sync, self.pins) = (0, false, true);
        (self.high, self.rose) = (true, false);
        self.telemetry.lines.store(0, Relaxed);
        self.telemetry.triggers_ignored.store(0, Relaxed);
    }

    fn approach(&mut self, from: f32, ticks: u32) {
        self.phase = Phase::Approach;
        self.way = Transition::new(from, self.points.get(0), ticks);
        self.tick = 1;
    }

    /// Plays nothing from here on.
    pub fn stop(&mut self) {
        self.phase = Phase::Over;
        self.sync = false;
    }

    /// Takes the trigger input's level at this tick.
    #[inline]
    pub fn input(&mut self, high: bool) {
        self.rose = high && !self.high && self.how.on_trigger;
        self.high = high;
    }

    /// The level that the sync pin is to have; `None` where it has it already, and the trigger input need not be looked
    /// at, for nothing is played.
    #[inline]
    pub fn sync(&mut self) -> Option<bool> {
        if !self.pins {
            return None;
        }
        self.pins = self.phase != Phase::Over || self.sync;
        Some(self.sync)
    }

    /// What is wanted at this tick, µm; nothing after the last line.
    #[inline]
    pub fn tick(&mut self) -> Option<f32> {
        if self.phase == Phase::Line {
            if self.rose {
                self.ignore();
            }
            return Some(self.line());
        }
        self.beside()
    }

    /// A tick of a line. It has few instructions: they are the price of a tick whose drive is the longest.
    #[inline]
    fn line(&mut self) -> f32 {
        let (point, behind) = (self.point, self.behind);
        let here = self.points.get(point);
        self.sync = point == 0;
        let following = point + 1;
        let last = following == self.how.points.get();
        let mut wanted = here;
        if behind > 0 {
            let next = self.points.get(if last { 0 } else { following });
            wanted += (next - here) * (f32::from(behind) * self.part);
        }
        if behind + 1 < self.how.every.get() && !(last && self.back.is_some()) {
            self.behind = behind + 1;
        } else if last {
            self.end(here);
        } else {
            (self.point, self.behind) = (following, 0);
        }
        wanted
    }

    /// Ends a line at its last point, which is here.
    #[inline(never)]
    fn end(&mut self, here: f32) {
        match self.back {
            _ if self.lines == self.how.lines => self.phase = Phase::Over,
            Some(ticks) => self.approach(here, ticks),
            // The way was the line's last part.
            None => self.phase = Phase::Waiting,
        }
    }

    /// A tick before or between lines, which may be a line's first; or after them all.
    #[inline(never)]
    fn beside(&mut self) -> Option<f32> {
        self.sync = false;
        if self.phase == Phase::Over {
            return None;
        }
        if self.phase == Phase::Approach && !self.way.is_over(self.tick) {
            let wanted = self.way.at(self.tick);
            self.tick += 1;
            if self.rose {
                self.ignore();
            }
            return Some(wanted);
        }
        if self.how.on_trigger && !self.rose {
            self.phase = Phase::Waiting;
            return Some(self.points.get(0));
        }
        (self.phase, self.point, self.behind) = (Phase::Line, 0, 0);
        self.lines = self.lines.saturating_add(1);
        self.telemetry.lines.store(self.lines, Relaxed);
        Some(self.line())
    }

    /// A trigger begins no line.
    #[inline(never)]
    fn ignore(&mut self) {
        add(&self.telemetry.triggers_ignored, 1);
    }
}
