//! Candidates side by side on their way through a session.

use crate::cost::{Cost, Norm};
use estimator_core::Voigt;
use pulp::NullaryFnOnce;
use voigt_lanes::branchless::signed_pow;
use voigt_lanes::knots::Position;
use voigt_lanes::terms::{Intervals, Lanes};
use voigt_lanes::timeline::{Step, Timeline};

/// The extremum terms of candidates, `g·sgn(V)·|V|^h + e·sgn(y)·|y|^f`.
pub struct Extrema<const N: usize> {
    g: Lanes<N>,
    h: Lanes<N>,
    e: Lanes<N>,
    f: Lanes<N>,
}

impl<const N: usize> Extrema<N> {
    /// Of candidates side by side.
    pub fn of(models: [&Voigt<f64>; N]) -> Self {
        let of = |part: fn(&Voigt<f64>) -> f64| models.map(part);
        Self { g: of(|of| of.g), h: of(|of| of.h), e: of(|of| of.e_um), f: of(|of| of.f) }
    }

    /// At a reversal (V, µm), µm/s.
    #[inline(always)]
    fn at(&self, voltage: f64, displacement: &Lanes<N>) -> Lanes<N> {
        let mut found = [0.0; N];
        for lane in 0..N {
            let of_voltage = self.g[lane] * signed_pow(voltage, self.h[lane]);
            found[lane] = of_voltage + self.e[lane] * signed_pow(displacement[lane], self.f[lane]);
        }
        found
    }
}

/// Lanes on their way through a session: mean sizes of their errors.
pub struct Run<'a, const N: usize> {
    /// What is minimised.
    pub cost: Cost,
    /// The candidates' affine maps between the knots.
    pub intervals: &'a Intervals<N>,
    /// Their extremum terms, taken anew at each reversal.
    pub extrema: &'a Extrema<N>,
    /// What is done at which tick of the session.
    pub timeline: &'a Timeline,
}

impl<const N: usize> NullaryFnOnce for Run<'_, N> {
    type Output = Lanes<N>;

    /// A loop of its own for each norm, feedback and scheme, so that none of them is asked for at a tick.
    #[inline(always)]
    fn call(self) -> Lanes<N> {
        match self.cost.norm {
            Norm::L1 => self.sized(f64::abs),
            Norm::L2 => self.sized(|error| error * error),
        }
    }
}

impl<const N: usize> Run<'_, N> {
    #[inline(always)]
    fn sized(self, size: impl Fn(f64) -> f64 + Copy) -> Lanes<N> {
        let weight = self.cost.weight();
        if weight == 0.0 {
            self.fed(size, |estimated, _| estimated)
        } else if weight == 1.0 {
            self.fed(size, |_, measured| measured)
        } else {
            self.fed(size, |estimated, measured| (1.0 - weight) * estimated + weight * measured)
        }
    }

    #[inline(always)]
    fn fed(self, size: impl Fn(f64) -> f64 + Copy, feed: impl Fn(f64, f64) -> f64 + Copy) -> Lanes<N> {
        if self.intervals.m.is_empty() { self.errors::<true>(size, feed) } else { self.errors::<false>(size, feed) }
    }

    /// `CONSTANT`: `m` is one number for all voltages.
    #[inline(always)]
    fn errors<const CONSTANT: bool>(
        self,
        size: impl Fn(f64) -> f64 + Copy,
        feed: impl Fn(f64, f64) -> f64 + Copy,
    ) -> Lanes<N> {
        let timeline = self.timeline;
        let mut displacement = [timeline.start; N];
        let (mut extreme, mut input, mut sums) = (displacement, [0.0; N], [0.0; N]);
        let (mut positions, mut measured) = (&timeline.positions[..], &timeline.measured[..]);
        for step in &timeline.steps {
            match *step {
                Step::Ticks(ticks) => {
                    for position in next(&mut positions, ticks) {
                        self.tick::<CONSTANT>(&mut displacement, &input, position);
                    }
                }
                // The next arm without its inner loop: most logs are measured at every tick.
                Step::Judged { ticks: 1, times } => {
                    for (position, &measured) in next(&mut positions, times).iter().zip(next(&mut measured, times)) {
                        self.tick::<CONSTANT>(&mut displacement, &input, position);
                        for lane in 0..N {
                            sums[lane] += size(displacement[lane] - measured);
                            displacement[lane] = feed(displacement[lane], measured);
                        }
                    }
                }
                Step::Judged { ticks, times } => {
                    for &measured in next(&mut measured, times) {
                        for position in next(&mut positions, ticks) {
                            self.tick::<CONSTANT>(&mut displacement, &input, position);
                        }
                        for lane in 0..N {
                            sums[lane] += size(displacement[lane] - measured);
                            displacement[lane] = feed(displacement[lane], measured);
                        }
                    }
                }
                Step::LeadIn => {
                    for &measured in next(&mut measured, 1) {
                        displacement = displacement.map(|estimated| feed(estimated, measured));
                    }
                }
                Step::Extreme => extreme = displacement,
                Step::Reversal(voltage) => {
                    input = self.extrema.at(voltage, &extreme);
                    if CONSTANT {
                        input.iter_mut().zip(&self.intervals.first_m).for_each(|(input, m)| *input *= m);
                    }
                }
            }
        }
        sums.map(|sum| sum / timeline.judged as f64)
    }

    /// One tick of every lane. `input` is the extremum terms, µm/s, or where `CONSTANT` what they add in a tick, µm.
    #[inline(always)]
    fn tick<const CONSTANT: bool>(
        &self,
        displacement: &mut Lanes<N>,
        input: &Lanes<N>,
        &Position { knot, weight }: &Position,
    ) {
        let at = &self.intervals.each[knot as usize];
        for lane in 0..N {
            let (a, c) = (at.a.at(lane, weight), at.c.at(lane, weight));
            let pushed =
                if CONSTANT { input[lane] } else { self.intervals.m[knot as usize].at(lane, weight) * input[lane] };
            displacement[lane] = a * displacement[lane] + (c + pushed);
        }
    }
}

/// Takes the next few.
#[inline(always)]
fn next<'s, S>(rest: &mut &'s [S], count: usize) -> &'s [S] {
    let (taken, left) = rest.split_at(count);
    *rest = left;
    taken
}
