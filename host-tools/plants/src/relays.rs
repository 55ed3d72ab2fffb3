//! Preisach's superposition of relays, Eq. (3.1), with a continuous density over the thresholds α ≥ β.
//!
//! ```text
//! h(u) = reversible(u) + share·∬ μ(r, s) γ_{r,s}[u] ds dr,   α = s + r,  β = s − r,  γ = ±1
//! ```
//!
//! Of all relays of one half-width r those with centres s below the play of that half-width are on (M. Brokate and
//! J. Sprekels, *Hysteresis and Phase Transitions*, Springer 1996, Section 2.4): the inner integral is a function of
//! one play, and no relay has to be kept. 60 half-widths; in s the density is continuous. A test compares it with
//! relays one by one. The virgin state, demagnetised, is that of plays at 0.
//!
//! While the voltage goes one way, the plays that it has come to, the narrower ones, all stand at u ∓ r: what their
//! relays add together is one number of a table over u, however many they are. Only where the voltage turns are they
//! put where they stand.
//!
//! The densities are those usual for ferroic materials: Gaussian and Lorentzian (M. Dimian and P. Andrei, *Noise-Driven
//! Phenomena in Hysteretic Systems*, Springer 2014, Section 2.2), a sum of two Gaussians, and a gamma distribution of
//! the half-width.

use super::draw::Draw;
use super::hysteresis::Hysteresis;

/// Density of the relays over half-width r and centre s, in units of the full voltage.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Density {
    /// exp(−(r − r₀)²/2σ² − (s − s₀)²/2ς²).
    Gaussian,
    /// 1 / ((1 + ((r − r₀)/σ)²)·(1 + ((s − s₀)/ς)²)).
    Lorentzian,
    /// Two Gaussians, one narrow near small half-widths, one wide and off the centre.
    TwoHumped,
    /// r·exp(−r/θ) times a Gaussian of the centre.
    Gamma,
}

/// Number of half-widths that stand for all of them.
const WIDTHS: usize = 60;
/// Knots of the integral over the centre, from −[`REACH`] to [`REACH`]: the half-widths are odd multiples of the
/// distance of two.
const KNOTS: usize = 4 * WIDTHS + 1;
/// Knots of voltages from which some play of a half-width is within the reach.
const VOLTAGES: usize = KNOTS + 2 * WIDTHS - 1;
/// Largest half-width and centre, of the full voltage.
const REACH: f64 = 1.1;
/// From one knot to the next.
const STEP: f64 = 2.0 * REACH / (KNOTS - 1) as f64;

/// The relays of a density beside a reversible part.
pub struct Relays {
    /// Where the plays stood when the voltage last turned, and what the relays of each half-width added then.
    plays: Vec<f64>,
    sums: Vec<f64>,
    /// So many plays, the narrowest, follow the voltage since it turned; the others' relays add `resting`.
    following: usize,
    resting: f64,
    rises: bool,
    /// The voltage of the step before, in units of the full voltage.
    u: f64,
    /// Of each half-width, the integral of the density from 0 to the knots.
    integrals: Vec<[f64; KNOTS]>,
    rising: Followed,
    falling: Followed,
    cubic: f64,
}

/// What the relays of the plays that follow a voltage add: of each number of plays, over the voltages that go one way.
struct Followed {
    sums: Vec<[f64; VOLTAGES]>,
    /// Knots between −[`REACH`] and the lowest voltage.
    below: usize,
}

impl Followed {
    /// `knot`: of the play of a half-width at a knot of the voltages.
    fn new(integrals: &[[f64; KNOTS]], below: usize, behind: impl Fn(usize) -> usize) -> Self {
        let mut sums = vec![[0.0; VOLTAGES]; WIDTHS + 1];
        for (index, integral) in integrals.iter().enumerate() {
            let at = |knot: usize| integral[knot.saturating_sub(behind(index)).min(KNOTS - 1)];
            sums[index + 1] = std::array::from_fn(|knot| sums[index][knot] + at(knot));
        }
        Self { sums, below }
    }

    fn of(&self, following: usize, u: f64) -> f64 {
        interpolated(&self.sums[following], (u + REACH) / STEP + self.below as f64)
    }
}

impl Relays {
    pub fn new(density: Density, draw: &mut Draw) -> Self {
        let numbers = Numbers::of(density, draw);
        let share = draw.about(0.75, 0.1);
        let cell = REACH / WIDTHS as f64;
        let mut integrals = vec![[0.0; KNOTS]; WIDTHS];
        for (index, integral) in integrals.iter_mut().enumerate() {
            let at = |knot: usize| numbers.density(width(index), knot as f64 * STEP - REACH);
            for knot in 1..KNOTS {
                integral[knot] = integral[knot - 1] + 0.5 * STEP * (at(knot - 1) + at(knot));
            }
            let middle = integral[KNOTS / 2];
            integral.iter_mut().for_each(|value| *value = (*value - middle) * cell);
        }
        // All relays switched from −1 to 1 add 2 × share to a reversible part of 2.
        let total: f64 = integrals.iter().map(|integral| (integral[KNOTS - 1] - integral[0]) / 2.0).sum();
        integrals.iter_mut().flatten().for_each(|value| *value *= share / total);
        let sums: Vec<f64> = integrals.iter().map(|integral| integral[KNOTS / 2]).collect();
        let widest = knots(WIDTHS - 1);
        Self {
            plays: vec![0.0; WIDTHS],
            following: 0,
            resting: sums.iter().sum(),
            sums,
            rises: true,
            u: 0.0,
            rising: Followed::new(&integrals, 0, knots),
            falling: Followed::new(&integrals, widest, |index| widest - knots(index)),
            integrals,
            cubic: 0.06 * draw.normal().clamp(-1.5, 1.5),
        }
    }

    /// Puts the plays where they stand once the voltage turns.
    fn turn(&mut self) {
        let away = if self.rises { -1.0 } else { 1.0 };
        for index in 0..self.following {
            let play = self.u + away * width(index);
            self.plays[index] = play;
            self.sums[index] = interpolated(&self.integrals[index], (play + REACH) / STEP);
            self.resting += self.sums[index];
        }
        self.following = 0;
        self.rises = !self.rises;
    }
}

/// Middle of a cell of half-widths.
fn width(index: usize) -> f64 {
    REACH * (index as f64 + 0.5) / WIDTHS as f64
}

/// The same in distances of two knots.
fn knots(index: usize) -> usize {
    2 * index + 1
}

impl Hysteresis for Relays {
    fn step(&mut self, u: f64, _: f64) -> f64 {
        if u != self.u && (u > self.u) != self.rises {
            self.turn();
        }
        self.u = u;
        while let (Some(play), Some(sum)) = (self.plays.get(self.following), self.sums.get(self.following)) {
            let beyond = if self.rises { u - play } else { play - u };
            if beyond <= width(self.following) {
                // Two plays differ by no more than their half-widths do: none that is wider moves either.
                break;
            }
            self.resting -= sum;
            self.following += 1;
        }
        let followed = if self.rises { &self.rising } else { &self.falling };
        u + self.cubic * u * u * u + self.resting + followed.of(self.following, u)
    }
}

/// A number of a table between two of its knots, beyond its ends that of the end.
fn interpolated<const N: usize>(table: &[f64; N], at: f64) -> f64 {
    let at = at.clamp(0.0, (N - 1) as f64);
    let left = (at as usize).min(N - 2);
    table[left] + (at - left as f64) * (table[left + 1] - table[left])
}

/// Numbers of a density.
struct Numbers {
    density: Density,
    /// Centre and spread in half-width.
    width: (f64, f64),
    /// Centre and spread in the centre.
    centre: (f64, f64),
}

impl Numbers {
    fn of(density: Density, draw: &mut Draw) -> Self {
        let (width, spread) = match density {
            Density::Gaussian => (0.2, 0.25),
            Density::Lorentzian => (0.15, 0.15),
            Density::TwoHumped => (0.08, 0.08),
            Density::Gamma => (0.0, 0.15),
        };
        Self {
            density,
            width: (draw.about(width, 0.15), draw.about(spread, 0.15)),
            centre: (0.1 * draw.normal().clamp(-1.5, 1.5), draw.about(0.6, 0.15)),
        }
    }

    fn density(&self, r: f64, s: f64) -> f64 {
        let ((r0, wide), (s0, high)) = (self.width, self.centre);
        let (x, y) = ((r - r0) / wide, (s - s0) / high);
        let gauss = |z: f64| libm::exp(-0.5 * z * z);
        match self.density {
            Density::Gaussian => gauss(x) * gauss(y),
            Density::Lorentzian => 1.0 / ((1.0 + x * x) * (1.0 + y * y)),
            Density::TwoHumped => {
                gauss(x) * gauss(y) + 0.35 * gauss((r - r0 - 0.35) / 0.12) * gauss((s - s0 - 0.3) / 0.25)
            }
            Density::Gamma => r * libm::exp(-r / wide) * gauss(y),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same with relays one by one: `WIDTHS` half-widths by 400 centres.
    fn one_by_one(density: Density, device: u64, voltages: &[f64]) -> Vec<f64> {
        let mut draw = Draw::new(device);
        let numbers = Numbers::of(density, &mut draw);
        let share = draw.about(0.75, 0.1);
        let cubic = 0.06 * draw.normal().clamp(-1.5, 1.5);
        const CENTRES: usize = 400;
        let centre = |k: usize| REACH * (2.0 * (k as f64 + 0.5) / CENTRES as f64 - 1.0);
        let mut relays = Vec::new();
        for r in (0..WIDTHS).map(width) {
            for s in (0..CENTRES).map(centre) {
                // Demagnetised: on where the centre lies below 0.
                relays.push((s + r, s - r, numbers.density(r, s), if s < 0.0 { 1.0 } else { -1.0 }));
            }
        }
        let total: f64 = relays.iter().map(|relay| relay.2).sum();
        let step = |u: f64| {
            let mut sum = 0.0;
            for (up, down, weight, state) in &mut relays {
                if u >= *up {
                    *state = 1.0;
                } else if u <= *down {
                    *state = -1.0;
                }
                sum += *weight * *state;
            }
            u + cubic * u * u * u + share * sum / total
        };
        voltages.iter().copied().map(step).collect()
    }

    #[test]
    fn the_plays_are_the_relays_one_by_one() {
        let voltages: Vec<f64> = (0..600).map(|k| (1.0 - k as f64 / 900.0) * (0.05 * k as f64).sin()).collect();
        for density in [Density::Gaussian, Density::Lorentzian, Density::TwoHumped, Density::Gamma] {
            let mut plays = Relays::new(density, &mut Draw::new(7));
            let (at_rest, relays) = (plays.step(0.0, 0.0), one_by_one(density, 7, &voltages));
            let virgin = one_by_one(density, 7, &[0.0])[0];
            for (u, relays) in voltages.iter().zip(relays) {
                let (plays, relays) = (plays.step(*u, 0.0) - at_rest, relays - virgin);
                assert!((plays - relays).abs() < 0.02, "{density:?} at {u}: {plays} {relays}");
            }
        }
    }

    #[test]
    fn plays_that_follow_together_add_what_each_adds_by_itself() {
        for seed in 0..8 {
            let mut draw = Draw::new(seed);
            let mut together = Relays::new(Density::TwoHumped, &mut draw);
            let mut plays = [0.0_f64; WIDTHS];
            let (mut u, mut speed) = (0.0_f64, 0.0);
            for _ in 0..20_000 {
                // Turns at every other step, swings of all sizes, rests, and voltages beyond the reach.
                speed = (0.99 * speed + 0.002 * draw.normal()).clamp(-0.05, 0.05);
                u = (u + speed + 0.002 * draw.normal()).clamp(-1.3, 1.3);
                let mut by_itself = u + together.cubic * u * u * u;
                for (index, (play, integral)) in plays.iter_mut().zip(&together.integrals).enumerate() {
                    *play = play.clamp(u - width(index), u + width(index));
                    by_itself += interpolated(integral, (*play + REACH) / STEP);
                }
                assert!((together.step(u, 0.0) - by_itself).abs() < 1e-10, "{seed}: at {u}");
            }
        }
    }
}
