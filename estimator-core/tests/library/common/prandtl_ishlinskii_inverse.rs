//! Exact inverse of the Prandtl-Ishlinskii model in closed form (Kuhnen 2003): what the search of the general inverse
//! is held against.
//!
//! ```text
//! V    = Σ w'_i·play(S⁻¹(y) − offset, r'_i)
//! r'_i = Σ_{j<i} w_j·(r_i − r_j)                                         µm
//! w'_0 = 1/w_0,   w'_i = −w_i/((w_0+…+w_i)·(w_0+…+w_{i−1}))              V/µm
//! p'_i = p_i·Σ_{j≤i} w_j + Σ_{j>i} w_j·p_j                               µm    memory that belongs to the plays p
//! ```

use estimator_core::model::play;
use estimator_core::{PrandtlIshlinskiiParameters, Superposition};

pub struct ExactInverse {
    offset: f64,
    superposition: Superposition<f64>,
    /// r', w' and p' of every play.
    plays: Vec<(f64, f64, f64)>,
}

impl ExactInverse {
    /// The inverse of these parameters whose model's plays stand at `memory` (V).
    pub fn new(parameters: &PrandtlIshlinskiiParameters, memory: &[f64]) -> Self {
        let r: Vec<f64> = parameters.thresholds_v.iter().map(|&r| r.into()).collect();
        let w: Vec<f64> = parameters.weights_um_per_v.iter().map(|&w| w.into()).collect();
        let upto = |i: usize| w[..i].iter().sum::<f64>();
        let plays = (0..r.len()).map(|i| {
            let threshold = (0..i).map(|j| w[j] * (r[i] - r[j])).sum();
            let weight = if i == 0 { 1.0 / w[0] } else { -w[i] / (upto(i + 1) * upto(i)) };
            let stands = memory[i] * upto(i + 1) + (i + 1..r.len()).map(|j| w[j] * memory[j]).sum::<f64>();
            (threshold, weight, stands)
        });
        Self {
            offset: parameters.offset_um.into(),
            superposition: Superposition::build(&parameters.dead_zones_um, &parameters.dead_zone_slopes),
            plays: plays.collect(),
        }
    }

    /// One tick: takes the wanted displacement (µm), returns the voltage (V) that gives it.
    pub fn step(&mut self, displacement: f64) -> f64 {
        let (mut low, mut high) = (-1e3, 1e3);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            *(if self.superposition.apply(middle) < displacement { &mut low } else { &mut high }) = middle;
        }
        let input = high - self.offset;
        self.plays.iter_mut().fold(0.0, |voltage, (threshold, weight, stands)| {
            *stands = play(*stands, input, *threshold);
            voltage + *weight * *stands
        })
    }
}
