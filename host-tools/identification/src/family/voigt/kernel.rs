//! Costs of many candidates of the Voigt family at once: what their ticks have in common is done once, and each tick is
//! the same few operations on neighbouring numbers, which the compiler makes vector instructions of.
//!
//! It is [`estimator_core::Voigt`] with its terms interpolated between [`knots`](voigt_lanes::knots), and gives the
//! same cost whatever stands in the other lanes.

use super::run::{Extrema, Run};
use crate::cost::Cost;
use crate::problem::Problem;
use estimator_core::{Discretisation, Scheme, Voigt, VoigtParameters};
use pulp::Arch;
use rayon::prelude::*;
use voigt_lanes::knots::Knots;
use voigt_lanes::terms::{Intervals, Lanes, Points, Voltages};
use voigt_lanes::timeline::Timeline;

/// Candidates that run side by side: two vectors of the widest instructions, of which one computes while the other
/// waits for its last tick.
const LANES: usize = 16;
/// Where there are no more than these, in one vector.
const FEW: usize = 8;

/// What every candidate runs through.
pub struct Kernel<'a> {
    problem: &'a Problem,
    cost: Cost,
    discretisation: Discretisation<f64>,
    knots: Knots,
    voltages: Voltages,
    timelines: Vec<Timeline>,
}

/// A candidate that runs, with its place among the others.
type Entrant = (usize, Voigt<f64>, Points);

impl<'a> Kernel<'a> {
    /// Over the training sessions of a problem.
    pub fn new(problem: &'a Problem, cost: Cost) -> Self {
        let knots = Knots::over(problem.voltage_range());
        let timelines = problem.training().filter_map(|session| Timeline::of(session, &knots, problem.deadband));
        Self {
            problem,
            cost,
            discretisation: problem.discretisation(),
            knots,
            voltages: Voltages::of(&knots),
            timelines: timelines.collect(),
        }
    }

    /// Costs (µm) of candidates, in their order; infinite of what is not admissible or diverges.
    pub fn costs(&self, candidates: &[VoigtParameters<f64>]) -> Vec<f64> {
        let run: Vec<Entrant> =
            candidates.par_iter().enumerate().filter_map(|(index, of)| self.admitted(index, of)).collect();
        let found = if run.len() <= FEW { self.side_by_side::<FEW>(&run) } else { self.side_by_side::<LANES>(&run) };
        let mut costs = vec![f64::INFINITY; candidates.len()];
        run.iter().zip(found).for_each(|((index, ..), cost)| costs[*index] = cost);
        costs
    }

    /// Costs of candidates that run, so many at a time, and of what stands in the lanes that are left.
    fn side_by_side<const N: usize>(&self, run: &[Entrant]) -> Vec<f64> {
        run.par_chunks(N).flat_map_iter(|some| self.lanes::<N>(some)).collect()
    }

    /// What runs of a candidate, with its place; `None` where it is not proven to stay within any of the limits.
    fn admitted(&self, index: usize, candidate: &VoigtParameters<f64>) -> Option<Entrant> {
        let model = Voigt::build(candidate, &self.discretisation);
        let points = Points::of(&model, &self.voltages);
        let covered = self.knots.covered();
        let proven = |limits| model.bound_between(points.each(&self.voltages), covered, limits).is_ok();
        self.problem.admits_by(proven).then_some((index, model, points))
    }

    /// Costs of as many candidates as there are lanes; the last one stands in the lanes that are left.
    fn lanes<const N: usize>(&self, some: &[Entrant]) -> Lanes<N> {
        let of = |lane: usize| &some[lane.min(some.len() - 1)];
        let models: [&Voigt<f64>; N] = std::array::from_fn(|lane| &of(lane).1);
        let constant = self.discretisation.scheme == Scheme::ForwardEuler;
        let points = std::array::from_fn(|lane| &of(lane).2);
        let intervals = Intervals::of(models, points, &self.voltages, constant);
        let extrema = Extrema::of(models);
        let mut sums = [0.0; N];
        for timeline in &self.timelines {
            // Wider instructions where the machine has them; each lane's are the same.
            let run = Run { cost: self.cost, intervals: &intervals, extrema: &extrema, timeline };
            sums.iter_mut().zip(Arch::new().dispatch(run)).for_each(|(sum, error)| *sum += error);
        }
        let sessions = self.timelines.len().max(1) as f64;
        sums.map(|sum| if sum.is_finite() { self.cost.norm.error(sum / sessions) } else { f64::INFINITY })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Conditions;
    use crate::cost::{Feedback, Norm};
    use crate::fixtures::session;
    use crate::search::space::{Ranges, Space};
    use estimator_core::{Model, Parameters};
    use proptest::prelude::*;
    use recordings::rig::EXCITATIONS;
    use recordings::session::Session;

    fn problem() -> Problem {
        let mut sessions: Vec<Session> = EXCITATIONS.into_iter().take(3).map(session).collect();
        sessions[1].rested_v = Some(-3.0);
        sessions[2].lead_in = 20;
        Problem::new(sessions, Vec::new(), Conditions::default())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Of candidates anywhere in the search space the costs are those of the model itself, but for what lies
        /// between the knots, and a candidate's does not depend on its lane.
        #[test]
        fn costs_are_those_of_the_model(
            fractions in proptest::collection::vec(proptest::collection::vec(0.0..1.0, 9), 1..20),
            feedback in 0..3usize,
            l2 in any::<bool>(),
        ) {
            let problem = problem();
            let feedback = [Feedback::Simulation, Feedback::Osp, Feedback::MultiStep][feedback];
            let cost = Cost { norm: if l2 { Norm::L2 } else { Norm::L1 }, ..feedback.into() };
            let space = Space::new(Model::Enhanced, Ranges::Data, problem.extent());
            let parameters = |fractions: &Vec<f64>| {
                let values: Vec<f64> = space.genes.iter().zip(fractions).map(|(gene, &at)| gene.value(at)).collect();
                (space.parameters(&values), space.published(&values))
            };
            let (candidates, published): (Vec<VoigtParameters<f64>>, Vec<Parameters>) =
                fractions.iter().map(parameters).unzip();
            let kernel = Kernel::new(&problem, cost);
            let costs = kernel.costs(&candidates);
            for ((candidate, published), found) in candidates.iter().zip(&published).zip(&costs) {
                prop_assert_eq!(kernel.costs(&[*candidate]), [*found]);
                let exact = problem.cost(published, cost);
                // At the edge of what is admissible f32 and f64 may differ.
                if exact.is_finite() && found.is_finite() {
                    prop_assert!((exact - found).abs() <= 2e-3 * exact + 1e-4, "{} {}", exact, found);
                }
            }
        }
    }

    #[test]
    fn what_is_not_admissible_costs_infinitely_much_and_the_rest_does_not() {
        let problem = problem();
        let space = Space::new(Model::Voigt, Ranges::Data, problem.extent());
        let at =
            |fraction: f64| space.parameters(&space.genes.iter().map(|gene| gene.value(fraction)).collect::<Vec<_>>());
        let unstable = VoigtParameters { b_ohm: 1e-9, ..at(0.5) };
        let costs = Kernel::new(&problem, Feedback::Simulation.into()).costs(&[unstable, at(0.5), unstable]);
        let finite: Vec<bool> = costs.iter().map(|cost| cost.is_finite()).collect();
        assert_eq!(finite, [false, true, false]);
    }
}
