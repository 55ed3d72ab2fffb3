//! A voltage that goes from place to place, sample by sample, never faster than it may.

use super::Request;
use std::f64::consts::{PI, TAU};

/// This much of the slew limit is used, so that rounding to `f32` and to the device's own step stays within.
const OF_SLEW: f64 = 0.95;

/// What has been gone so far.
pub struct Path<'r> {
    request: &'r Request,
    volts: Vec<f64>,
    at: f64,
}

impl<'r> Path<'r> {
    /// A path that begins at the request's rest.
    pub fn new(request: &'r Request) -> Self {
        Self { request, volts: Vec::new(), at: request.rest_v }
    }

    /// The fastest change that is used, V/s.
    pub fn fastest(request: &Request) -> f64 {
        OF_SLEW * request.slew_v_per_s
    }

    /// Stays for so many s.
    pub fn hold(&mut self, seconds: f64) {
        let ticks = self.ticks(seconds);
        self.volts.extend(std::iter::repeat_n(self.at, ticks));
    }

    /// Moves to a voltage along half a cosine, in so many s or as fast as it may.
    pub fn swing_to(&mut self, target: f64, seconds: f64) {
        let (from, travel) = (self.at, target - self.at);
        let seconds = seconds.max(0.5 * PI * travel.abs() / Self::fastest(self.request));
        self.go(seconds, target, |part| from + travel * 0.5 * (1.0 - libm::cos(PI * part)));
    }

    /// Moves to a voltage along a straight line, in so many s or as fast as it may.
    pub fn line_to(&mut self, target: f64, seconds: f64) {
        let (from, travel) = (self.at, target - self.at);
        let seconds = seconds.max(travel.abs() / Self::fastest(self.request));
        self.go(seconds, target, |part| from + travel * part);
    }

    /// Whole periods of a sine from its lowest voltage, where the path stands, up by a span and back.
    pub fn sines(&mut self, hertz: f64, span: f64, periods: u32) {
        let (low, periods) = (self.at, f64::from(periods));
        self.go(periods / hertz, low, |part| low + span * 0.5 * (1.0 - libm::cos(TAU * (periods * part).fract())));
    }

    /// The same of a triangle.
    pub fn triangles(&mut self, hertz: f64, span: f64, periods: u32) {
        let (low, periods) = (self.at, f64::from(periods));
        self.go(periods / hertz, low, |part| {
            let phase = (periods * part).fract();
            low + span * 2.0 * phase.min(1.0 - phase)
        });
    }

    /// Follows a voltage over time (s) for so long, as closely as it may.
    pub fn follow(&mut self, seconds: f64, voltage: impl Fn(f64) -> f64) {
        let most = Self::fastest(self.request) * self.request.tick_s;
        for tick in 1..=self.ticks(seconds) {
            let step = voltage(tick as f64 * self.request.tick_s) - self.at;
            self.put(self.at + step.clamp(-most, most));
        }
    }

    /// The samples, V.
    pub fn into_volts(self) -> Vec<f32> {
        let (min, max) = (self.request.min_v as f32, self.request.max_v as f32);
        self.volts.iter().map(|&volts| (volts as f32).clamp(min, max)).collect()
    }

    /// How many samples there are.
    pub fn ticks_gone(&self) -> usize {
        self.volts.len()
    }

    /// How long it has been, s.
    pub fn seconds(&self) -> f64 {
        self.volts.len() as f64 * self.request.tick_s
    }

    /// Along a function of the part of the way, from 0 to 1, whose last value is `target`.
    fn go(&mut self, seconds: f64, target: f64, voltage: impl Fn(f64) -> f64) {
        let ticks = self.ticks(seconds);
        for tick in 1..ticks {
            self.put(voltage(tick as f64 / ticks as f64));
        }
        self.put(target);
    }

    fn put(&mut self, volts: f64) {
        self.at = volts.clamp(self.request.min_v, self.request.max_v);
        self.volts.push(self.at);
    }

    /// Never fewer than the time needs: a way is not gone faster for being rounded to ticks.
    fn ticks(&self, seconds: f64) -> usize {
        (seconds / self.request.tick_s).ceil().max(0.0) as usize
    }
}
