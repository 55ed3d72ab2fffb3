//! Particle swarm with the constriction coefficients (Clerc and Kennedy, 2002), each particle drawn to its own best
//! point and the swarm's:
//!
//! v ← 0.7298·v + 1.4962·r₁·(own − x) + 1.4962·r₂·(swarm − x), x ← x + v, r uniform on 0 … 1 for each coordinate
//!
//! A particle that leaves the cube is mirrored back with half its velocity. A collapsed swarm keeps its best and is
//! drawn anew.

use super::state::{COLLAPSED, Scored, Search, extent, reflect};
use rand::RngExt;

const INERTIA: f64 = 0.7298;
const PULL: f64 = 1.4962;
const PARTICLES: usize = 40;

struct Particle {
    at: Vec<f64>,
    velocity: Vec<f64>,
    own: Scored,
}

/// Spends the budget of a search; `points` are evaluated and become particles.
pub fn run(search: &mut Search<'_>, points: Vec<Scored>) {
    let size = PARTICLES.min((search.left() / 4).max(4));
    let mut swarm = launch(search, points, size);
    while search.left() > 0 {
        if extent(swarm.iter().map(|particle| particle.own.at.as_slice()), search.dimension) < COLLAPSED {
            let best = Scored { at: search.best.at.clone(), cost: search.best.cost };
            swarm = launch(search, vec![best], size);
            continue;
        }
        for particle in &mut swarm {
            step(particle, search);
        }
        let scored = search.evaluate(swarm.iter().map(|particle| particle.at.clone()).collect());
        for (particle, scored) in swarm.iter_mut().zip(scored) {
            if scored.cost < particle.own.cost {
                particle.own = scored;
            }
        }
    }
}

/// Particles at some points and anywhere else, each on its way half-way to anywhere.
fn launch(search: &mut Search<'_>, mut points: Vec<Scored>, size: usize) -> Vec<Particle> {
    search.fill(&mut points, size);
    points
        .into_iter()
        .map(|own| {
            let velocity = search.anywhere().iter().zip(&own.at).map(|(to, x)| (to - x) / 2.0).collect();
            Particle { at: own.at.clone(), velocity, own }
        })
        .collect()
}

fn step(particle: &mut Particle, search: &mut Search<'_>) {
    let attractors = particle.own.at.iter().zip(&search.best.at);
    for ((x, velocity), (own, swarm)) in particle.at.iter_mut().zip(&mut particle.velocity).zip(attractors) {
        let (r1, r2): (f64, f64) = search.random.random();
        *velocity = INERTIA * *velocity + PULL * (r1 * (own - *x) + r2 * (swarm - *x));
        let to = *x + *velocity;
        *x = reflect(to);
        if *x != to {
            *velocity *= -0.5;
        }
    }
}
