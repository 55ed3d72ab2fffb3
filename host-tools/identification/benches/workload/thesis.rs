//! The thesis's workload: five logs of 4,000 samples, 64 candidates a generation, 400 generations, nine parameters.

use estimator_core::{Model, Parameters, VoigtParameters};
use identification::cost::Feedback;
use identification::family::voigt::Kernel;
use identification::search::space::{Ranges, Space};
use identification::{Conditions, Problem};
use recordings::prepare::Recipe;
use recordings::rig::{EXCITATIONS, Rig, VALIDATION};

/// Candidates of a generation.
pub const POPULATION: usize = 64;
/// Generations of a search.
pub const GENERATIONS: usize = 400;
/// Length of a log, s: 4,000 ticks of 0.5 ms.
pub const LENGTH_S: f64 = 2.0;

/// The optimum of the search with the simulation cost, to four digits, in the genes of the space.
const OPTIMUM: [f64; 9] = [307.2, 0.9423, 1.132, -0.073, 0.2415, 0.1027, 0.2458, 0.348, 1.027];
/// How far candidates lie from it, as a part of each gene's value.
const AROUND: f64 = 0.02;

/// The five logs that are fitted to, of this length (s), at the tick.
pub fn problem(length_s: f64) -> Problem {
    let rig = Rig { duration: length_s, ..Rig::DEFAULT };
    let modelling = EXCITATIONS.into_iter().filter(|excitation| excitation.name != VALIDATION);
    let session = |excitation| Recipe::at_tick(500).session(&rig.log(excitation));
    let sessions = modelling.map(|excitation| session(excitation).expect("the rig is five times as fast as the tick"));
    Problem::new(sessions.collect(), Vec::new(), Conditions::default())
}

/// Samples of all logs.
pub fn samples(problem: &Problem) -> usize {
    problem.training().map(|session| session.voltage.len()).sum()
}

/// Admissible candidates about the optimum, as the kernel takes them and as a table holds them, no two alike. The
/// optimum lies at the edge of what is admissible: one that is not would cost the recursion no samples.
pub fn candidates(problem: &Problem, count: usize) -> (Vec<VoigtParameters<f64>>, Vec<Parameters>) {
    let space = Space::new(Model::Enhanced, Ranges::Data, problem.extent());
    // Multiples of the golden section, each gene's by another factor, lie evenly and repeat nothing.
    let part = |candidate: usize, gene: usize| (0.618_034 * (candidate * (2 * gene + 1)) as f64).fract() - 0.5;
    let values = |candidate: usize| -> Vec<f64> {
        let of = |(gene, value): (usize, &f64)| value * (1.0 + 2.0 * AROUND * part(candidate, gene));
        OPTIMUM.iter().enumerate().map(of).collect()
    };
    let candidates = (0..).map(values).map(|values| (space.parameters(&values), space.published(&values)));
    // The engine proves it over less than a knot's interval more of the voltage.
    let engine = Kernel::new(problem, Feedback::Simulation.into());
    let runs = |candidate: &VoigtParameters<f64>| engine.costs(&[*candidate])[0].is_finite();
    let admissible = candidates.filter(|(candidate, published)| problem.limits(published).is_ok() && runs(candidate));
    admissible.take(count).unzip()
}
