//! The thesis's binary genetic algorithm (4.1.2, Appendices C and D).
//!
//! A chromosome is one gene of `bits` bits a parameter, mapped linearly onto the gene's interval (Eq. 4.5). A
//! generation is: selection of as many parents as there are chromosomes, crossover of each pair at one point that the
//! whole generation shares, `ceil(mutation·bits·genes·(population − 1))` bit flips anywhere, evaluation. The best
//! chromosome ever seen is kept aside; with [`Elitism::Reinsert`] it also replaces the worst of each generation.
//!
//! A generation is evaluated at once, without random numbers: the same seed gives the same result on any number of
//! threads.

use super::gene::Gene;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

/// How parents are chosen.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// The better of two drawn at random (Appendix D).
    Tournament,
    /// With a probability inversely proportional to the cost (Appendix C).
    Roulette,
}

/// What becomes of the best chromosome.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Elitism {
    /// It is remembered and does not breed on (Appendix D).
    Aside,
    /// It replaces the worst of each generation.
    Reinsert,
}

/// Settings of one run.
#[derive(Clone, Copy, PartialEq, Debug, Serialize, Deserialize)]
pub struct Settings {
    /// Bits a gene, 1 … 31.
    pub bits: u32,
    /// Chromosomes, at least 2.
    pub population: usize,
    /// Generations at most.
    pub generations: u32,
    /// Stop after so many generations without a better chromosome; 0 never does.
    pub patience: u32,
    /// Flipped bits as a fraction of all bits.
    pub mutation: f64,
    /// How parents are chosen.
    pub selection: Selection,
    /// What becomes of the best.
    pub elitism: Elitism,
}

/// The state of a run after a generation.
#[derive(Clone, PartialEq, Debug)]
pub struct Best {
    /// Gene values of the best chromosome so far, in the genes' own units.
    pub genes: Vec<f64>,
    /// The cost of these genes.
    pub cost: f64,
}

/// Gene codes of one candidate.
type Chromosome = Vec<u32>;

/// Runs the algorithm. `costs_of` some candidates, one each in their order, are what is minimised (infinite for
/// what must not win); `seeds` are candidates in gene values that join the first population; `watch` sees the best
/// after every generation.
pub fn run(
    genes: &[Gene],
    settings: &Settings,
    seed: u64,
    seeds: &[Vec<f64>],
    costs_of: impl Fn(&[Vec<f64>]) -> Vec<f64>,
    mut watch: impl FnMut(u32, &Best),
) -> Best {
    let random = &mut ChaCha8Rng::seed_from_u64(seed);
    let levels = (1u32 << settings.bits) - 1;
    let decode = |chromosome: &Chromosome| -> Vec<f64> {
        genes.iter().zip(chromosome).map(|(gene, &code)| gene.value(f64::from(code) / f64::from(levels))).collect()
    };
    let evaluate = |population: &[Chromosome]| costs_of(&population.iter().map(decode).collect::<Vec<_>>());
    let mut population: Vec<Chromosome> = (0..settings.population.max(2))
        .map(|_| genes.iter().map(|_| random.random_range(0..=levels)).collect())
        .collect();
    for (chromosome, seed) in population.iter_mut().zip(seeds) {
        let code = |(gene, &value): (&Gene, &f64)| (gene.fraction(value) * f64::from(levels)).round() as u32;
        *chromosome = genes.iter().zip(seed).map(code).collect();
    }
    let mut costs = evaluate(&population);
    let mut best = fittest(&population, &costs);
    // Seeds count as they are, not only as their nearest chromosome.
    let mut best_genes = Best { genes: decode(&best.0), cost: best.1 };
    for (seed, cost) in seeds.iter().zip(costs_of(seeds)) {
        if cost < best_genes.cost {
            best_genes = Best { genes: seed.clone(), cost };
        }
    }
    watch(0, &best_genes);
    let mut idle = 0;
    for generation in 1..=settings.generations {
        population = select(&population, &costs, settings.selection, random);
        cross(&mut population, genes.len(), settings.bits, random);
        mutate(&mut population, genes.len(), settings, random);
        costs = evaluate(&population);
        let candidate = fittest(&population, &costs);
        if settings.elitism == Elitism::Reinsert && candidate.1 > best.1 {
            reinsert(&mut population, &mut costs, &best);
        }
        if candidate.1 < best.1 {
            best = candidate;
        }
        idle += 1;
        if best.1 < best_genes.cost {
            best_genes = Best { genes: decode(&best.0), cost: best.1 };
            idle = 0;
        }
        watch(generation, &best_genes);
        if settings.patience > 0 && idle >= settings.patience {
            break;
        }
    }
    best_genes
}

fn fittest(population: &[Chromosome], costs: &[f64]) -> (Chromosome, f64) {
    let (chromosome, cost) = population
        .iter()
        .zip(costs)
        .min_by(|a, b| a.1.total_cmp(b.1))
        // `run` makes at least two chromosomes.
        .expect("a population is never empty");
    (chromosome.clone(), *cost)
}

fn reinsert(population: &mut [Chromosome], costs: &mut [f64], best: &(Chromosome, f64)) {
    let worst = (0..costs.len()).max_by(|&a, &b| costs[a].total_cmp(&costs[b]));
    if let Some(worst) = worst {
        population[worst].clone_from(&best.0);
        costs[worst] = best.1;
    }
}

fn select(population: &[Chromosome], costs: &[f64], selection: Selection, random: &mut impl Rng) -> Vec<Chromosome> {
    let count = population.len();
    // An inadmissible candidate has an infinite cost and so no slice; when all are, any is as good.
    let slices: Vec<f64> = costs.iter().map(|cost| 1.0 / cost.max(f64::MIN_POSITIVE)).collect();
    let whole: f64 = slices.iter().sum();
    let parent = |_| {
        let (first, second) = (random.random_range(0..count), random.random_range(0..count));
        let chosen = match selection {
            Selection::Roulette if whole > 0.0 => {
                let mut rest = random.random_range(0.0..whole);
                let fallback = if costs[first] < costs[second] { first } else { second };
                slices
                    .iter()
                    .position(|slice| {
                        rest -= slice;
                        rest < 0.0
                    })
                    .unwrap_or(fallback)
            }
            _ if costs[first] < costs[second] => first,
            _ => second,
        };
        population[chosen].clone()
    };
    (0..count).map(parent).collect()
}

/// Exchanges the bits of each pair behind one point of the whole chromosome.
fn cross(population: &mut [Chromosome], genes: usize, bits: u32, random: &mut impl Rng) {
    let point = random.random_range(1..=genes * bits as usize);
    let (whole, part) = (point / bits as usize, point as u32 % bits);
    // The genes before `whole` stay, the one at `whole` keeps its first `part` bits.
    let behind = (1u32 << (bits - part)) - 1;
    for pair in population.chunks_exact_mut(2) {
        let [left, right] = pair else { continue };
        for gene in whole..genes {
            let mask = if gene == whole { behind } else { u32::MAX };
            let difference = (left[gene] ^ right[gene]) & mask;
            left[gene] ^= difference;
            right[gene] ^= difference;
        }
    }
}

fn mutate(population: &mut [Chromosome], genes: usize, settings: &Settings, random: &mut impl Rng) {
    let places = genes * settings.bits as usize;
    let flips = (settings.mutation * (places * (population.len() - 1)) as f64).ceil() as usize;
    for _ in 0..flips {
        let chromosome = random.random_range(0..population.len());
        let gene = random.random_range(0..genes);
        population[chromosome][gene] ^= 1 << random.random_range(0..settings.bits);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossover_keeps_every_bit_at_its_place() {
        let random = &mut ChaCha8Rng::seed_from_u64(3);
        for _ in 0..100 {
            let mut pair = vec![vec![0u32; 5], vec![1023u32; 5]];
            cross(&mut pair, 5, 10, random);
            let bits =
                |chromosome: &[u32]| -> String { chromosome.iter().map(|gene| format!("{gene:010b}")).collect() };
            let (left, right) = (bits(&pair[0]), bits(&pair[1]));
            let point = left.find('1').unwrap_or(50);
            assert!(point >= 1 && left[point..].bytes().all(|bit| bit == b'1'));
            assert!(right[..point].bytes().all(|bit| bit == b'1') && right[point..].bytes().all(|bit| bit == b'0'));
        }
    }

    #[test]
    fn mutation_flips_the_thesis_s_number_of_bits() {
        let settings = Settings {
            bits: 10,
            population: 64,
            generations: 400,
            patience: 0,
            mutation: 0.15,
            selection: Selection::Tournament,
            elitism: Elitism::Aside,
        };
        let mut population = vec![vec![0u32; 5]; 64];
        mutate(&mut population, 5, &settings, &mut ChaCha8Rng::seed_from_u64(3));
        let set: u32 = population.iter().flatten().map(|gene| gene.count_ones()).sum();
        // 473 draws with replacement over 3,200 places: some meet twice.
        assert!((380..=473).contains(&set), "{set}");
    }
}
