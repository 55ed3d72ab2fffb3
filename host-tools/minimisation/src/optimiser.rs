//! The methods of a search, by name.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A method that minimises without gradients.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Optimiser {
    /// The thesis's binary genetic algorithm in rounds of shrinking ranges.
    Genetic,
    /// Differential evolution, current-to-pbest/1/bin.
    DifferentialEvolution,
    /// Particle swarm with constriction coefficients.
    ParticleSwarm,
    /// Covariance matrix adaptation.
    CmaEs,
    /// Downhill, by Newton's steps or Nelder and Mead's simplex, with restarts.
    Local,
}

impl Optimiser {
    /// Every method there is.
    pub const ALL: [Self; 5] =
        [Self::Genetic, Self::DifferentialEvolution, Self::ParticleSwarm, Self::CmaEs, Self::Local];
}

impl fmt::Display for Optimiser {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Genetic => "genetic",
            Self::DifferentialEvolution => "differential-evolution",
            Self::ParticleSwarm => "particle-swarm",
            Self::CmaEs => "cma-es",
            Self::Local => "local",
        })
    }
}
