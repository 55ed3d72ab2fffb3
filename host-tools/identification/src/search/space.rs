//! What the search varies, and how a candidate becomes a published parameter set.
//!
//! `table-4.5` searches the published parameters themselves within the thesis's ranges. Those are ranges for one
//! actuator at ±20 V; an actuator with another stroke or drive needs others. `data` therefore searches
//! coordinates that say what the parameters do, in terms of the log's own scale, and computes the published set
//! from them in closed form:
//!
//! | coordinate | meaning | range |
//! |---|---|---|
//! | `rate` | rate(0), 1/s, logarithmic | 2 … 0.95/t_s |
//! | `gain` | static displacement at V* without extremum terms, as a fraction of Y* | 0.5 … 2 |
//! | `p` | P | 0.4 … 2.5 |
//! | `slope` | slope of ln rate at 0 V, per V* | −1 … 1 |
//! | `curvature` | its curvature, per V*² | 0.0001 … 2 |
//! | `g` | g·V*^h as a fraction of the drive at V*, signed | −1.5 … 1.5 |
//! | `h` | h | 0 … 3 |
//! | `e` | e_µm·Y*^f as a fraction of the drive at V*, signed | −1.5 … 1.5 |
//! | `f` | f | 0 … 3 |
//! | `net` | in the enhanced model, instead of `g`: the sum of both fractions | −0.5 … 0.5 |
//!
//! V* is the largest voltage and Y* the largest displacement of the training logs, both as magnitudes from the model's
//! zeros. `rate` is even in λ and, far from β, depends on λ and on α·exp(−λβ) only; slope and curvature have neither
//! ambiguity. The two extremum terms nearly cancel at the optimum, which is a diagonal ridge in g and e but not in
//! `net` and e. Their signs are free: with the printed ones the model cannot reproduce the rig.
//!
//! Powers are `libm`'s, so that a seed means the same result on every platform.

use super::Gene;
use estimator_core::{Model, Parameters, VoigtParameters};
use serde::{Deserialize, Serialize};

/// Which search space.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub enum Ranges {
    /// Coordinates and ranges from the training logs' own scale.
    #[serde(rename = "data")]
    Data,
    /// The published parameters within Table 4.5; g, h, e and f within the magnitudes of Table 5.2, of either sign.
    #[serde(rename = "table-4.5")]
    Table45,
}

/// The size of the training logs.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Extent {
    /// V*: largest |voltage|, V.
    pub voltage: f64,
    /// Y*: largest |displacement|, µm.
    pub displacement: f64,
    /// The tick's period, s.
    pub tick: f64,
}

/// Genes of a model in a search space.
#[derive(Clone, PartialEq, Debug)]
pub struct Space {
    /// The model whose parameters are searched.
    pub model: Model,
    /// What is varied.
    pub genes: Vec<Gene>,
    ranges: Ranges,
    extent: Extent,
}

impl Space {
    /// The search space of a model.
    pub fn new(model: Model, ranges: Ranges, extent: Extent) -> Self {
        let mut genes = match ranges {
            Ranges::Data => data_genes(extent),
            Ranges::Table45 => TABLE_4_5.to_vec(),
        };
        let (voltage, displacement) = match (ranges, model) {
            (Ranges::Data, Model::Enhanced) => ([NET, H], [E, F]),
            (Ranges::Data, _) => ([G, H], [E, F]),
            (Ranges::Table45, _) => (G_H_TABLE_5_2, E_F_TABLE_5_2),
        };
        genes.extend(voltage.into_iter().filter(|_| model.has_voltage_term()));
        genes.extend(displacement.into_iter().filter(|_| model.has_displacement_term()));
        Self { model, genes, ranges, extent }
    }

    /// The published parameters of a candidate.
    pub fn parameters(&self, values: &[f64]) -> VoigtParameters<f64> {
        let named =
            |name: &str| self.genes.iter().zip(values).find(|(gene, _)| gene.name == name).map_or(0.0, |(_, v)| *v);
        match self.ranges {
            Ranges::Table45 => VoigtParameters {
                alpha_um: named("alpha"),
                beta_v: named("beta"),
                lambda_per_v: named("lambda"),
                b_ohm: named("b"),
                p: named("p"),
                g_um_per_s: named("g"),
                h: named("h"),
                e_m_per_s: named("e"),
                f: named("f"),
            },
            Ranges::Data => {
                let Extent { voltage, displacement, .. } = self.extent;
                let (rate, p, h, f) = (named("rate"), named("p"), named("h"), named("f"));
                let (lambda, beta) = sigmoid(named("slope"), named("curvature"), voltage);
                // 2 + x + 1/x of Eq. (3.16).
                let shape = |v: f64| 2.0 + 2.0 * libm::cosh(lambda * (v - beta));
                let drive = named("gain") * displacement * rate * shape(voltage) / shape(0.0);
                let b = voltage * libm::pow(1e6 / drive, 1.0 / p);
                let net = self.genes.iter().any(|gene| gene.name == NET.name);
                let g = if net { named("net") - named("e") } else { named("g") };
                VoigtParameters {
                    alpha_um: 1e6 * shape(0.0) / (rate * lambda * b),
                    beta_v: beta,
                    lambda_per_v: lambda,
                    b_ohm: b,
                    p,
                    g_um_per_s: g * drive / libm::pow(voltage, h),
                    h,
                    e_m_per_s: named("e") * drive / libm::pow(displacement, f) * libm::pow(10.0, 6.0 * (f - 1.0)),
                    f,
                }
            }
        }
    }

    /// As [`parameters`](Self::parameters), as a table holds them.
    pub fn published(&self, values: &[f64]) -> Parameters {
        Parameters::of_voigt_family(self.model, self.parameters(values).map(|x| x as f32))
    }

    /// A candidate of another model's space (of the same ranges) as one of this: genes of the same name keep their
    /// values, a term that the other lacks is switched off.
    pub fn adopt(&self, other: &Self, values: &[f64]) -> Vec<f64> {
        let theirs = |name: &str| other.genes.iter().zip(values).find(|(gene, _)| gene.name == name).map(|(_, v)| *v);
        let adopted = |gene: &Gene| match gene.name {
            "net" => theirs("net").unwrap_or(theirs("g").unwrap_or(0.0) + theirs("e").unwrap_or(0.0)),
            "g" | "e" => theirs(gene.name).unwrap_or(0.0),
            name => theirs(name).unwrap_or(gene.value(0.5)),
        };
        self.genes.iter().map(adopted).collect()
    }
}

/// λ and β (1/V, V) from the slope and curvature of ln rate at 0 V, which are per V* and V*².
///
/// rate ∝ cosh²(λ(V−β)/2), so with L = λV*: slope = −L·tanh(λβ/2), curvature = L²/2·sech²(λβ/2).
fn sigmoid(slope: f64, curvature: f64, voltage: f64) -> (f64, f64) {
    let length = libm::sqrt(slope * slope + 2.0 * curvature);
    let lambda = length / voltage;
    (lambda, 2.0 / lambda * libm::atanh(-slope / length))
}

const NET: Gene = Gene::linear("net", "both extremum terms at V* and Y*, of the drive there", "drive(V*)", -0.5, 0.5);
const G: Gene = Gene::linear("g", "voltage-extremum term at V*, of the drive there", "drive(V*)/V*^h", -1.5, 1.5);
const H: Gene = Gene::linear("h", "exponent of V_ext", "", 0.0, 3.0);
const E: Gene = Gene::linear("e", "displacement-extremum term at Y*, of the drive at V*", "drive(V*)/Y*^f", -1.5, 1.5);
const F: Gene = Gene::linear("f", "exponent of y_ext", "", 0.0, 3.0);

/// The thesis prints no ranges for these; the magnitudes of Table 5.2, of either sign.
const G_H_TABLE_5_2: [Gene; 2] = [
    Gene::linear("g", "voltage-extremum term", "µm/s/V^h", -100.0, 100.0),
    Gene::linear("h", "exponent of V_ext", "", 0.0, 1.5),
];
const E_F_TABLE_5_2: [Gene; 2] = [
    Gene::linear("e", "displacement-extremum term", "m/s/m^f", -1000.0, 1000.0),
    Gene::linear("f", "exponent of y_ext", "", 0.5, 2.0),
];

/// The ranges of Table 4.5.
const TABLE_4_5: [Gene; 5] = [
    Gene::linear("alpha", "α", "µm", 100.0, 2500.0),
    Gene::linear("beta", "β", "V", 200.0, 1000.0),
    Gene::linear("lambda", "λ", "1/V", 0.001, 0.01),
    Gene::linear("b", "damping", "Ω", 5000.0, 200_000.0),
    Gene::linear("p", "exponent P of the drive", "", 0.1, 1.2),
];

fn data_genes(extent: Extent) -> Vec<Gene> {
    vec![
        Gene::logarithmic("rate", "1/time constant at 0 V", "1/s", 2.0, 0.95 / extent.tick),
        Gene::linear("gain", "static displacement at V*", "Y*", 0.5, 2.0),
        Gene::linear("p", "exponent P of the drive", "", 0.4, 2.5),
        Gene::linear("slope", "slope of ln rate at 0 V", "1/V*", -1.0, 1.0),
        Gene::linear("curvature", "curvature of ln rate at 0 V", "1/V*²", 1e-4, 2.0),
    ]
}
