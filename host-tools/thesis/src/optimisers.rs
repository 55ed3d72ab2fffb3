//! Optimiser against optimiser (6.2: other global methods than the genetic algorithm): each searches the same structure
//! with the same number of evaluations, from the same starts, with several seeds. Costs are simulation errors of the
//! modelling logs, validation errors simulation errors of the held-out ones; both are mean absolute errors, µm.
//!
//! Searched are the enhanced model, all of whose nine numbers are, and the generalised Prandtl–Ishlinskii model's
//! simplest and richest structure, whose weights follow by least squares.

use super::bench::Bench;
use crate::error::ThesisError;
use estimator_core::{Model, Parameters};
use identification::cost::Feedback;
use identification::family::{self, AnyFamily, Family, voigt};
use identification::search::Optimiser;
use identification::search::space::Space;
use identification::{Progress, SearchOptions, StructureSearch};
use report::{Section, shown};
use serde::Serialize;

/// Seeds of each search, from that of the options on.
const SEEDS: u32 = 3;
/// A search has arrived that costs no more than this, of the least cost of all.
const ARRIVED: f64 = 1.05;
/// A candidate whose weights are to be solved for takes so many times as long, and gets so many
/// times fewer evaluations.
const SOLVED: u32 = 5;

/// A structure and the evaluations that each search of it may make.
struct Structure<'a> {
    name: String,
    model: Model,
    family: &'a dyn Family<Found = Parameters>,
    evaluations: usize,
}

/// One search by one method.
struct Run {
    /// Where the search ended, µm; what is made of the best candidate after it is no method's.
    cost: f64,
    held_out: Option<f64>,
    /// Evaluations made and the least cost so far.
    course: Vec<(usize, f64)>,
}

/// One method on one structure, over the seeds. Errors in µm.
#[derive(Serialize)]
struct Row {
    structure: String,
    searched: usize,
    optimiser: Optimiser,
    evaluations: usize,
    best_cost_um: Option<f64>,
    median_cost_um: Option<f64>,
    /// Of the cheapest of the seeds.
    best_held_out_um: Option<f64>,
    median_held_out_um: Option<f64>,
    /// Seeds that came within 5 % of the least cost of all methods and seeds.
    arrived: usize,
    seeds: usize,
    /// Median of the evaluations that they took to come there.
    evaluations_to_arrive: Option<f64>,
}

/// Generations that it takes, roughly, for a progress bar.
pub fn generations(search: &SearchOptions) -> u64 {
    let searches = u64::from(SEEDS) * Optimiser::ALL.len() as u64;
    // Most methods take some tens of candidates a generation, a descent one or a few.
    searches * u64::from(search.evaluations)
}

/// Searches each structure by each method.
///
/// # Errors
/// The figures cannot be written down.
pub fn section(bench: &mut Bench, progress: Progress<'_>) -> Result<Section, ThesisError> {
    let (problem, search) = (bench.problem(), bench.search());
    let space = Space::new(Model::Enhanced, search.ranges, problem.extent());
    let kernel = voigt::Kernel::new(problem, Feedback::Simulation.into());
    let enhanced = voigt::Family { space: &space, seeds: &[], kernel: &kernel };
    let plays = family::of(Model::GeneralisedPrandtlIshlinskii, problem);
    let mut structures = vec![Structure::new(Model::Enhanced, &enhanced, search.evaluations)];
    for family in ends(&plays) {
        let evaluations = search.evaluations.div_ceil(SOLVED);
        structures.push(Structure::new(Model::GeneralisedPrandtlIshlinskii, family.as_ref(), evaluations));
    }
    let mut grid = bench
        .grid(&format!(
            "Methods at equal evaluations, {SEEDS} seeds each: cost and MAE on {}, held out.",
            bench.held_out()
        ))
        .words("structure", 27)
        .words("method", 22)
        .numbers("evaluations", 6)
        .numbers("best cost µm", 8)
        .numbers("median cost", 8)
        .numbers("held out, best", 8)
        .numbers("held out, median", 8)
        .numbers("arrived", 7)
        .numbers("evaluations to arrive", 6);
    let (mut rows, mut notes) = (Vec::new(), Vec::new());
    for structure in &structures {
        let searched = structure.searched(bench, progress);
        notes.extend(verdict(structure, &searched));
        for row in &searched {
            grid.row([
                row.structure.clone(),
                row.optimiser.to_string(),
                row.evaluations.to_string(),
                shown(row.best_cost_um, 4),
                shown(row.median_cost_um, 4),
                shown(row.best_held_out_um, 4),
                shown(row.median_held_out_um, 4),
                format!("{} of {}", row.arrived, row.seeds),
                row.evaluations_to_arrive.map_or("–".to_owned(), |count| format!("{count:.0}")),
            ]);
        }
        rows.extend(searched);
    }
    bench.baseline(&mut grid, 5);
    notes.insert(
        0,
        format!(
            "Arrived: a cost of at most {ARRIVED} times the least of all methods and seeds of the structure; evaluations \
             to arrive are those of the median seed among those that did. Held out, best: of the seed of the best cost. \
             None of the searches starts from another model's solution. The budget is the \
             search's evaluations a number, a fifth of it where weights are solved for; what a longer search would find it does \
             not tell."
        ),
    );
    Ok(Section {
        title: "Optimisers at equal budget: Section 6.2",
        tables: vec![grid],
        notes,
        figures: Vec::new(),
        json: bench.json(&rows)?,
    })
}

/// The simplest and the richest of a model's structures; one where it has no other.
fn ends(structures: &[AnyFamily]) -> impl Iterator<Item = &AnyFamily> {
    structures.first().into_iter().chain(structures.get(1..).and_then(<[AnyFamily]>::last))
}

impl<'a> Structure<'a> {
    /// `evaluations` are those of each number that is searched.
    fn new(model: Model, family: &'a dyn Family<Found = Parameters>, evaluations: u32) -> Self {
        let searched = family.genes().len();
        let name = format!("{model}, {searched} numbers");
        Self { name, model, family, evaluations: evaluations as usize * searched }
    }

    /// A row for each method.
    fn searched(&self, bench: &Bench, progress: Progress<'_>) -> Vec<Row> {
        let runs = Optimiser::ALL.map(|optimiser| {
            let seeds = (0..SEEDS).map(|seed| self.run(bench, optimiser, seed, progress));
            (optimiser, seeds.collect::<Vec<Run>>())
        });
        let costs = runs.iter().flat_map(|(_, runs)| runs).map(|run| run.cost);
        let least = costs.fold(f64::INFINITY, f64::min);
        runs.iter().map(|(optimiser, runs)| self.row(*optimiser, runs, least)).collect()
    }

    fn run(&self, bench: &Bench, optimiser: Optimiser, seed: u32, progress: Progress<'_>) -> Run {
        let (problem, cost) = (bench.problem(), Feedback::Simulation.into());
        let search = StructureSearch {
            problem,
            cost,
            method: optimiser,
            evaluations: self.evaluations,
            seed: bench.search().seed.wrapping_add(seed),
        };
        let mut course = Vec::new();
        let mut progress = |made, least| {
            course.push((made, least));
            progress(self.model, least);
        };
        let found = search.run(self.family, &[], Some(&mut progress));
        let admissible = found.parameters.filter(|_| found.cost.is_finite());
        let held_out = admissible.as_ref().and_then(|parameters| problem.held_out(parameters, cost));
        let reached = course.last().filter(|_| admissible.is_some()).map_or(f64::INFINITY, |(_, least)| *least);
        Run { cost: reached, held_out, course }
    }

    fn row(&self, optimiser: Optimiser, runs: &[Run], least: f64) -> Row {
        let best = runs.iter().min_by(|a, b| a.cost.total_cmp(&b.cost));
        let arrivals: Vec<f64> = runs.iter().filter_map(|run| arrival(&run.course, least)).collect();
        Row {
            structure: self.name.clone(),
            searched: self.family.genes().len(),
            optimiser,
            evaluations: self.evaluations,
            best_cost_um: best.map(|run| run.cost).filter(|cost| cost.is_finite()),
            median_cost_um: median(runs.iter().map(|run| run.cost).collect()).filter(|cost| cost.is_finite()),
            best_held_out_um: best.and_then(|run| run.held_out),
            median_held_out_um: median(runs.iter().filter_map(|run| run.held_out).collect()),
            arrived: arrivals.len(),
            seeds: runs.len(),
            evaluations_to_arrive: median(arrivals),
        }
    }
}

/// Evaluations after which a search's least cost was near the least of all; `None` where it never was.
fn arrival(course: &[(usize, f64)], least: f64) -> Option<f64> {
    course.iter().find(|(_, cost)| *cost <= ARRIVED * least).map(|(made, _)| *made as f64)
}

/// The middle one in order; of an even number the mean of the two in the middle. `None` of nothing.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(if low == high { *low } else { (low + high) / 2.0 })
}

/// Which method a structure should be searched by, and how far the genetic algorithm is from it.
fn verdict(structure: &Structure<'_>, rows: &[Row]) -> Option<String> {
    let known = || rows.iter().filter_map(|row| Some((row.optimiser, row.median_cost_um?)));
    let (nearest, cost) = known().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let genetic = known().find(|(optimiser, _)| *optimiser == Optimiser::Genetic).map(|(_, genetic)| genetic);
    let beside = match genetic {
        _ if nearest == Optimiser::Genetic => "no other method does better".to_owned(),
        Some(genetic) => format!("the genetic algorithm's is {:.1} % above", 100.0 * (genetic / cost - 1.0)),
        None => "the genetic algorithm found nothing admissible with most seeds".to_owned(),
    };
    Some(format!("{}: the least median cost is {nearest}'s; {beside}.", structure.name))
}

#[cfg(test)]
mod tests {
    use super::super::bench::tests::small;
    use super::*;

    #[test]
    fn every_method_searches_every_structure_with_the_same_evaluations() {
        let section = section(&mut small(), &mut |_, _| ()).unwrap();
        let data = section.data().unwrap();
        let rows = data.as_array().unwrap();
        assert_eq!(rows.len(), 3 * Optimiser::ALL.len());
        for (structure, searched, evaluations) in [(0, 9, 9 * 30), (1, 6, 6 * 6), (2, 9, 9 * 6)] {
            let rows = &rows[structure * 5..structure * 5 + 5];
            for (row, optimiser) in rows.iter().zip(Optimiser::ALL) {
                assert_eq!(row["optimiser"], serde_json::to_value(optimiser).unwrap());
                assert_eq!(
                    (row["searched"].as_u64(), row["evaluations"].as_u64()),
                    (Some(searched), Some(evaluations))
                );
                let number = |name: &str| row[name].as_f64().unwrap_or_else(|| panic!("{name} of {row}"));
                assert!(number("best_cost_um") > 0.0 && number("best_held_out_um") > 0.0);
                // So short a search may find nothing admissible with most seeds.
                let median = row["median_cost_um"].as_f64();
                assert!(median.is_none_or(|median| median >= number("best_cost_um")), "{row}");
                assert!(row["evaluations_to_arrive"].as_f64().is_none_or(|made| made <= evaluations as f64), "{row}");
            }
            // Whoever has the least cost has arrived.
            assert!(rows.iter().any(|row| row["arrived"].as_u64() > Some(0)), "{rows:?}");
        }
        assert_eq!(section.notes.len(), 1 + 3);
    }

    #[test]
    fn arrival_is_the_first_cost_near_the_least() {
        let course = [(10, f64::INFINITY), (20, 1.2), (30, 1.04), (40, 1.0)];
        assert_eq!(arrival(&course, 1.0), Some(30.0));
        assert_eq!(arrival(&course, 0.9), None);
    }

    #[test]
    fn medians() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(median(vec![1.0, f64::INFINITY, f64::INFINITY]), Some(f64::INFINITY));
        assert_eq!(median(Vec::new()), None);
    }
}
