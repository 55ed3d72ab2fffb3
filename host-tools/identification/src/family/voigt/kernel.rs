//! Costs of many candidates of the Voigt family at once: what their ticks have in common is done once, and each tick is
//! the same few operations on neighbouring numbers, which the compiler makes vector instructions of.
//!
//! It is [`estimator_core::Voigt`] with its terms interpolated between [`knots`](super::knots), and gives the same cost
//! whatever stands in the other lanes.

use super::knots::{KNOTS, Knots};
use super::timeline::{Event, Timeline};
use crate::cost::Cost;
use crate::problem::Problem;
use estimator_core::{Discretisation, Extremum, Running, Voigt, VoigtParameters, VoigtTerms};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

/// Candidates that run side by side.
const LANES: usize = 8;

/// A number of each candidate.
type Lanes = [f64; LANES];

/// The affine map `y ← a·y + c + m·ext` between a knot and the next, each term a weight's way from the knot's.
struct Interval {
    a: Term,
    c: Term,
    m: Term,
}

/// A term at a knot, and how much more it is at the next.
struct Term {
    here: Lanes,
    more: Lanes,
}

/// What every candidate runs through.
pub struct Kernel<'a> {
    problem: &'a Problem,
    cost: Cost,
    discretisation: Discretisation<f64>,
    knots: Knots,
    timelines: Vec<Timeline>,
}

impl<'a> Kernel<'a> {
    /// Over the training sessions of a problem.
    pub fn new(problem: &'a Problem, cost: Cost) -> Self {
        let knots = Knots::over(problem.voltage_range());
        let timelines = problem.training().filter_map(|session| Timeline::of(session, &knots, problem.deadband));
        Self { problem, cost, discretisation: problem.discretisation(), knots, timelines: timelines.collect() }
    }

    /// Costs (µm) of candidates, in their order; infinite of what is not admissible or diverges.
    pub fn costs(&self, candidates: &[VoigtParameters<f64>]) -> Vec<f64> {
        let models: Vec<Voigt<f64>> = candidates.iter().map(|of| Voigt::build(of, &self.discretisation)).collect();
        let covered = self.knots.covered();
        let admissible: Vec<bool> =
            models.par_iter().map(|model| self.problem.admits(&Running::new(*model), covered)).collect();
        let run: Vec<usize> = (0..models.len()).filter(|&index| admissible[index]).collect();
        let found: Vec<Lanes> = run
            .par_chunks(LANES)
            .map(|some| self.lanes(&std::array::from_fn(|lane| models[some[lane.min(some.len() - 1)]])))
            .collect();
        let mut costs = vec![f64::INFINITY; candidates.len()];
        run.iter().zip(found.into_iter().flatten()).for_each(|(&index, cost)| costs[index] = cost);
        costs
    }

    /// Costs of as many models as there are lanes.
    fn lanes(&self, models: &[Voigt<f64>; LANES]) -> Lanes {
        let at = |knot| models.map(|model| model.terms(self.knots.voltage(knot)));
        let of: Vec<[VoigtTerms<f64>; LANES]> = (0..KNOTS).map(at).collect();
        let term =
            |left: &[VoigtTerms<f64>; LANES], right: &[VoigtTerms<f64>; LANES], part: fn(VoigtTerms<f64>) -> f64| {
                let (here, there) = (left.map(part), right.map(part));
                Term { here, more: std::array::from_fn(|lane| there[lane] - here[lane]) }
            };
        let interval = |pair: &[[VoigtTerms<f64>; LANES]]| Interval {
            a: term(&pair[0], &pair[1], |of| of.a),
            c: term(&pair[0], &pair[1], |of| of.c),
            m: term(&pair[0], &pair[1], |of| of.m),
        };
        let intervals: Vec<Interval> = of.windows(2).map(interval).collect();
        let mut sums = [0.0; LANES];
        for timeline in &self.timelines {
            // Wider instructions where the machine has them; each lane's are the same.
            let errors = Arch::new().dispatch(Run { kernel: self, models, intervals: &intervals, timeline });
            sums.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error);
        }
        let sessions = self.timelines.len().max(1) as f64;
        sums.map(|sum| if sum.is_finite() { self.cost.norm.error(sum / sessions) } else { f64::INFINITY })
    }

    /// Mean sizes of the errors over a session.
    #[inline(always)]
    fn errors(&self, models: &[Voigt<f64>; LANES], intervals: &[Interval], timeline: &Timeline) -> Lanes {
        let weight = self.cost.weight();
        let mut displacement = [timeline.start; LANES];
        let (mut extreme, mut input, mut sums) = (displacement, [0.0; LANES], [0.0; LANES]);
        let mut done = 0;
        for mark in &timeline.marks {
            for position in &timeline.positions[done..mark.tick] {
                tick(&mut displacement, &input, &intervals[position.knot as usize], position.weight);
            }
            done = mark.tick;
            match mark.event {
                Event::Extreme => extreme = displacement,
                Event::Reversal(voltage) => {
                    input = std::array::from_fn(|lane| {
                        models[lane].extremum_input(Extremum { voltage, displacement: extreme[lane] })
                    });
                }
                Event::Measured { displacement: measured, counts } => {
                    if counts {
                        let sizes = displacement.map(|estimated| self.cost.norm.size(estimated - measured));
                        sums.iter_mut().zip(sizes).for_each(|(sum, size)| *sum += size);
                    }
                    if weight > 0.0 {
                        displacement = displacement.map(|estimated| (1.0 - weight) * estimated + weight * measured);
                    }
                }
            }
        }
        sums.map(|sum| sum / timeline.judged as f64)
    }
}

/// Lanes on their way through a session.
struct Run<'a> {
    kernel: &'a Kernel<'a>,
    models: &'a [Voigt<f64>; LANES],
    intervals: &'a [Interval],
    timeline: &'a Timeline,
}

impl NullaryFnOnce for Run<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn call(self) -> Lanes {
        self.kernel.errors(self.models, self.intervals, self.timeline)
    }
}

/// One tick of every lane, a weight's way from the interval's lower knot.
#[inline(always)]
fn tick(displacement: &mut Lanes, input: &Lanes, at: &Interval, weight: f64) {
    for lane in 0..LANES {
        let term = |of: &Term| of.here[lane] + weight * of.more[lane];
        displacement[lane] = term(&at.a) * displacement[lane] + (term(&at.c) + term(&at.m) * input[lane]);
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

        /// Of candidates anywhere in the search space the costs are those of the model itself, but for what lies between the
        /// knots, and a candidate's does not depend on its lane.
        #[test]
        fn costs_are_those_of_the_model(
            fractions in proptest::collection::vec(proptest::collection::vec(0.0..1.0, 9), 1..12),
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
